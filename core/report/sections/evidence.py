"""The sections on what a result rests on: calibrations, pictures, warnings, settings and inputs."""

from __future__ import annotations

from reportlab.lib.units import mm
from reportlab.platypus import Flowable, HRFlowable, KeepTogether, Paragraph, Spacer

from core.report.calibration_tables import camera_facts, camera_table, fan_facts, fan_table, marks_table
from core.report.content import ReportContent
from core.report.input_tables import SHORT_HASH, hash_table, left_out_of_calibration, left_out_table
from core.report.language import grouped
from core.report.layout import Limits, section
from core.report.look import Look
from core.report.style import HAIRLINE, TEXT_WIDTH, color, lines_of, markup
from core.report.tables import GAP, more_line, pairs_table, side_by_side


def calibrations(look: Look, content: ReportContent, limits: Limits) -> list[Flowable]:
    """Camera, fan and rig side by side, and below since when which calibration holds."""
    half = (TEXT_WIDTH - GAP) * 0.42
    other = TEXT_WIDTH - GAP - half
    camera: list[Flowable] = [
        look.say("Camera", "small_strong"),
        camera_table(look, content.camera, half),
        Spacer(0, 1 * mm),
        pairs_table(look, camera_facts(look, content.camera), half, 26 * mm),
    ]
    rig = {look.words.known(name): value for name, value in list(content.rig.items())[: limits.settings]}
    fan: list[Flowable] = [
        look.say("Fixed laser (fan), planes in the camera's frame", "small_strong"),
        fan_table(look, content.fan, other),
        Spacer(0, 1 * mm),
        pairs_table(look, fan_facts(look, content.fan), other, 27 * mm),
        Spacer(0, 2 * mm),
        look.text(f"{look.words('Rig')} {content.rig_id}".strip(), "small_strong"),
        pairs_table(look, rig, other, 27 * mm),
        *more_line(look, len(content.rig) - limits.settings),
    ]
    marks = [Spacer(0, 2 * mm), marks_table(look, content, TEXT_WIDTH)] if content.calibrations else []
    body = [side_by_side(camera, fan, TEXT_WIDTH, 0.42), *marks]
    return [section(look, "calibrations", "Calibrations and rig", body)]


def pictures_used(look: Look, content: ReportContent, limits: Limits) -> list[Flowable]:
    """Frames and calibration pictures used, and why others were not."""
    words = look.words
    used = [frame.name for frame in content.frames if frame.used]
    if not content.frames:
        said = words("No frame was given")
    else:
        frames = words.count(len(content.frames), "frame")
        said = words("{n} of {all} used", n=grouped(len(used)), all=frames)
    if used:
        said += words(", {first} to {last}", first=used[0], last=used[-1])
    if used and len(used) == len(content.frames):
        said += words("; none left out")
    parts: list[Flowable] = [look.text(f"{said}.", "small")]
    left_out = content.frames_left_out + left_out_of_calibration(content)
    if left_out:
        parts += [Spacer(0, 1.5 * mm), *left_out_table(look, left_out, TEXT_WIDTH, limits.reasons, limits.names)]
    return [section(look, "frames", "Frames and calibration pictures", parts)]


def warnings(look: Look, content: ReportContent, limits: Limits) -> list[Flowable]:
    """Warnings and remarks of the software, which nobody can switch off."""
    notes = tuple(look.words.known(note) for note in content.all_notes)
    if not notes:
        return []
    body = [*look.bullets(notes[: limits.notes]), *more_line(look, len(notes) - limits.notes)]
    return [section(look, "notes", "Notes and warnings", body)]


def remarks(look: Look, content: ReportContent) -> list[Flowable]:
    """The operator's own words."""
    lines = lines_of(content.remarks) if content.remarks.strip() else []
    return [section(look, "remarks", "Remarks of the operator", list(lines[:3])), *lines[3:]] if lines else []


def settings(look: Look, content: ReportContent, limits: Limits) -> list[Flowable]:
    """Software and settings, and the hash over them."""
    known = {look.words.known(name): look.words.known(value) for name, value in content.settings.items()}
    pairs = {look.words("Software"): f"Trisect {content.version}"} | known
    shown = list(pairs.items())[: limits.settings]
    middle, column = (len(shown) + 1) // 2, (TEXT_WIDTH - GAP) / 2
    columns: list[list[Flowable]] = [
        [pairs_table(look, dict(part), column, 27 * mm)] if part else [] for part in (shown[:middle], shown[middle:])
    ]
    over_all = look.say("SHA-256 over version, method and settings:", "small")
    digest = Paragraph(markup(content.settings_digest), look.style("mono"))
    body = [side_by_side(columns[0], columns[1], TEXT_WIDTH), over_all, digest]
    return [
        section(look, "settings", "Software and settings", body),
        *more_line(look, len(pairs) - limits.settings),
    ]


def inputs(look: Look, content: ReportContent, limits: Limits) -> list[Flowable]:
    """The hash over all inputs, and, unless hidden, that of each."""
    if not content.hashes:
        return [section(look, "inputs", "Inputs", [look.say("No hashes of the inputs were given.", "small")])]
    listed = "inputs" not in content.hidden
    if listed:
        note = look.words(
            "SHA-256 of {inputs}, its first {n} characters; all of them in full are in run.json. Over all inputs "
            "together:",
            inputs=look.words.count(len(content.hashes), "input"),
            n=SHORT_HASH,
        )
    else:
        inputs_said = look.words.count(len(content.hashes), "input")
        note = look.words("SHA-256 over all {inputs}; those of each are in run.json:", inputs=inputs_said)
    digest = Paragraph(markup(content.inputs_digest), look.style("mono"))
    body: list[Flowable] = [look.text(note, "small"), digest]
    if not listed:
        return [section(look, "inputs", "Inputs", body)]
    rule = HRFlowable(width="100%", thickness=0.25, color=color(HAIRLINE), spaceBefore=2, spaceAfter=2)
    head = section(look, "inputs", "Inputs", [*body, rule])
    return [head, *hash_table(look, content.hashes, TEXT_WIDTH, limits.inputs)]


def end(look: Look, content: ReportContent) -> list[Flowable]:
    """The end mark, and with it what the reader does not get to see."""
    said = look.words("End of report {report}", report=content.report_id)
    mark = Paragraph(f"— {markup(said)} —", look.style("end"))
    left_out = [look.words(heading) for name, heading in content.printable.items() if name in content.hidden]
    if not left_out:
        return [mark]
    words = look.words("Left out of this report by choice: {sections}.", sections="; ".join(left_out))
    return [KeepTogether([Spacer(0, 3 * mm), look.text(words, "small"), mark])]
