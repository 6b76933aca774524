"""The sections on what a result rests on: calibrations, pictures, warnings, settings and inputs."""

from __future__ import annotations

from reportlab.lib.units import mm
from reportlab.platypus import Flowable, HRFlowable, KeepTogether, Paragraph, Spacer

from core.report import tables
from core.report.content import ReportContent
from core.report.layout import Limits, section
from core.report.style import HAIRLINE, STYLES, TEXT_WIDTH, bullets, color, lines_of, markup, text
from core.report.wording import count, grouped


def calibrations(content: ReportContent, limits: Limits) -> list[Flowable]:
    """Camera, fan and rig side by side."""
    half = (TEXT_WIDTH - 8 * mm) * 0.42
    other = TEXT_WIDTH - 8 * mm - half
    camera: list[Flowable] = [
        text("Camera", "small_strong"),
        tables.camera_table(content.camera, half),
        Spacer(0, 1 * mm),
        tables.pairs_table(tables.camera_facts(content.camera), half, 26 * mm),
    ]
    fan: list[Flowable] = [
        text("Fixed laser (fan), planes in the camera's frame", "small_strong"),
        tables.fan_table(content.fan, other),
        Spacer(0, 1 * mm),
        tables.pairs_table(tables.fan_facts(content.fan), other, 27 * mm),
        Spacer(0, 2 * mm),
        text("Rig", "small_strong"),
        tables.pairs_table(dict(list(content.rig.items())[: limits.settings]), other, 27 * mm),
        *tables.more_line(len(content.rig) - limits.settings),
    ]
    return [section("Calibrations and rig", [tables.side_by_side(camera, fan, TEXT_WIDTH, 0.42)])]


def pictures_used(content: ReportContent, limits: Limits) -> list[Flowable]:
    """Frames and calibration pictures used, and why others were not."""
    used = [frame.name for frame in content.frames if frame.used]
    if not content.frames:
        words = "No frame was given"
    else:
        words = f"{grouped(len(used))} of {count(len(content.frames), 'frame')} used"
    if used:
        words += f", {used[0]} to {used[-1]}"
    if used and len(used) == len(content.frames):
        words += "; none left out"
    parts: list[Flowable] = [text(f"{words}.", "small")]
    left_out = content.frames_left_out + tables.left_out_of_calibration(content)
    if left_out:
        parts += [Spacer(0, 1.5 * mm), *tables.left_out_table(left_out, TEXT_WIDTH, limits.reasons, limits.names)]
    return [section("Frames and calibration pictures", parts)]


def warnings(content: ReportContent, limits: Limits) -> list[Flowable]:
    """Warnings and remarks of the software, which nobody can switch off."""
    notes = content.all_notes
    if not notes:
        return []
    return [
        section(
            "Notes and warnings",
            [*bullets(notes[: limits.notes]), *tables.more_line(len(notes) - limits.notes)],
        )
    ]


def remarks(content: ReportContent) -> list[Flowable]:
    """The operator's own words."""
    lines = lines_of(content.remarks) if content.remarks.strip() else []
    return [section("Remarks of the operator", list(lines[:3])), *lines[3:]] if lines else []


def settings(content: ReportContent, limits: Limits) -> list[Flowable]:
    """Software and settings."""
    pairs = {"Software": f"Trisect {content.version}"} | dict(content.settings)
    shown = list(pairs.items())[: limits.settings]
    middle = (len(shown) + 1) // 2
    columns: list[list[Flowable]] = [
        [tables.pairs_table(dict(part), 81 * mm, 27 * mm)] if part else [] for part in (shown[:middle], shown[middle:])
    ]
    return [
        section("Software and settings", [tables.side_by_side(columns[0], columns[1], TEXT_WIDTH)]),
        *tables.more_line(len(pairs) - limits.settings),
    ]


def inputs(content: ReportContent, limits: Limits) -> list[Flowable]:
    """The hash over all inputs, and, unless hidden, that of each."""
    if not content.hashes:
        return [section("Inputs", [text("No hashes of the inputs were given.", "small")])]
    note = (
        f"SHA-256 of {count(len(content.hashes), 'input')}, its first {tables.SHORT_HASH} characters; all of them in "
        "full are in run.json. Over all inputs together:"
    )
    digest = Paragraph(markup(content.inputs_digest), STYLES["mono"])
    if "inputs" in content.hidden:
        note = f"SHA-256 over {count(len(content.hashes), 'input')} together; those of each are in run.json."
        return [section("Inputs", [text(note, "small"), digest])]
    listed = tables.hash_table(content.hashes, TEXT_WIDTH, limits.inputs)
    rule = HRFlowable(width="100%", thickness=0.25, color=color(HAIRLINE), spaceBefore=2, spaceAfter=2)
    return [section("Inputs", [text(note, "small"), digest, rule]), *listed]


def end(content: ReportContent) -> list[Flowable]:
    """The end mark, and with it what the reader does not get to see."""
    mark = Paragraph(f"— End of report {content.report_id} —", STYLES["end"])
    left_out = [heading for name, heading in content.printable.items() if name in content.hidden]
    if not left_out:
        return [mark]
    words = f"Left out of this report by choice: {'; '.join(left_out)}."
    return [KeepTogether([Spacer(0, 3 * mm), text(words, "small"), mark])]
