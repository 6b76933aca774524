"""The sections on what a result rests on: calibrations, pictures, warnings, settings and inputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from reportlab.lib.units import mm
from reportlab.pdfbase.pdfmetrics import stringWidth
from reportlab.platypus import Flowable, HRFlowable, KeepTogether, Spacer, TableStyle

from core.checks.artefact_check import KINDS
from core.findings.table import is_grave
from core.messages import label, plural_message
from core.model.certificate import Certificate
from core.report.content import BroughtSection, ReportContent
from core.report.facts.of_camera import camera_facts
from core.report.facts.of_checks import artefact_facts, check_facts
from core.report.facts.of_planes import planes_sentences, rest_of_planes
from core.report.facts.pictures import LeftOut, left_out
from core.report.layout.blocks import (
    GAP,
    Cell,
    Limits,
    fact_tables,
    figures,
    heads,
    more_line,
    pairs_table,
    plain_table,
    ruled_table,
    section,
    side_by_side,
    texts_by_name,
)
from core.report.layout.paragraph import Paragraph
from core.report.layout.style import HAIRLINE, MONO, MUTED, SANS, TEXT_WIDTH, ReportLook, color, markup
from core.report.sections.calibration_tables import camera_table, fan_table, marks_table
from core.report.wording import grouped, short_hash


def brought(look: ReportLook, content: ReportContent) -> list[Flowable]:
    """Make the report sections that wings bring; one from another package names that package."""
    parts: list[Flowable] = []
    for number, one in enumerate(content.brought):
        if one.name in content.hidden:
            continue
        parts += [section(look, f"brought-{number}", one.title, _brought(look, one))]
    return parts


def below_results(look: ReportLook, content: ReportContent) -> list[Flowable]:
    """Make what wings put below the results on the first page; what is from another package names that package."""
    parts: list[Flowable] = []
    for one in (one for one in content.below_results.values() if one.name not in content.hidden):
        parts += [Spacer(0, 3 * mm), look.fixed_text(one.title, "label"), *_brought(look, one)]
    return parts


def _brought(look: ReportLook, one: BroughtSection) -> list[Flowable]:
    body: list[Flowable] = [figures(look, one.facts, columns=4)]
    if one.origin is not None:
        package = {"package": one.origin.package, "version": one.origin.version}
        said = look.words("From the package {package} {version}, which is no part of Trisect.", **package)
        body += [look.text(said, "caption")]
    return body


def artefacts(look: ReportLook, content: ReportContent) -> list[Flowable]:
    """Make the section on known artefacts that were measured with these calibrations, against their certificates."""
    if not content.artefacts:
        return []
    words = look.words
    tables = [artefact_facts(one) for one in content.artefacts]
    columns = [fact.column(words) for fact in tables[0]]
    rows: list[list[Flowable]] = [heads(look, "Artefact", *columns, numbers=(2, 3, 4, 5))]
    for one, facts in zip(content.artefacts, tables, strict=True):
        shown = [replace(fact, unit="").text(words) for fact in facts]
        cells = [look.text(text, "number" if 1 <= place <= 4 else "small") for place, text in enumerate(shown)]
        title = f"{one.artefact.id} ({words(KINDS[one.artefact.kind])})"
        rows.append([look.text(title, "small"), *cells])
    shares = (0.115, 0.08, 0.13, 0.135, 0.17, 0.05, 0.11, 0.105, 0.105)
    note = look.fixed_text(
        "Measured like a part with the calibrations of this result. ± is U, of the certificate with its own k, of what "
        "was measured and of the error with k = 2. E_n is the error over the U of both together; above 1 nothing is "
        "conforming.",
        "caption",
    )
    return [
        section(
            look,
            "artefacts",
            "Checks by known artefacts",
            [ruled_table(rows, [TEXT_WIDTH * share for share in shares]), note],
        )
    ]


def calibrations(look: ReportLook, content: ReportContent, limits: Limits) -> list[Flowable]:
    """Make the section on the calibrations of camera and fan, the rig, and since when each calibration holds."""
    half = (TEXT_WIDTH - GAP) * 0.42
    other = TEXT_WIDTH - GAP - half
    camera: list[Flowable] = [
        look.fixed_text("Camera", "small_strong"),
        camera_table(look, content.camera, half),
        Spacer(0, 1 * mm),
        pairs_table(look, texts_by_name(look, camera_facts(content.camera)), half, 26 * mm),
    ]
    rig = {look.words.known(name): value for name, value in list(content.rig.items())[: limits.settings]}
    fan: list[Flowable] = [
        *(_fan(look, content, other) if content.has_fan else ()),
        look.text(f"{look.words('Rig')} {content.rig_id}".strip(), "small_strong"),
        pairs_table(look, rig, other, 27 * mm),
        *more_line(look, len(content.rig) - limits.settings),
    ]
    marks = [Spacer(0, 2 * mm), marks_table(look, content, TEXT_WIDTH)] if content.calibrations else []
    body = [side_by_side(camera, fan, TEXT_WIDTH, 0.42), *marks, *_check(look, content)]
    return [section(look, "calibrations", "Calibrations and rig", body)]


def _fan(look: ReportLook, content: ReportContent, width: float) -> list[Flowable]:
    return [
        look.fixed_text("Laser planes, as the camera sees them", "small_strong"),
        fan_table(look, content.fan, width),
        Spacer(0, 1 * mm),
        pairs_table(look, texts_by_name(look, rest_of_planes(content.fan)), width, 27 * mm),
        *(look.text(look.words(sentence), "small") for sentence in planes_sentences(content.fan)),
        Spacer(0, 2 * mm),
    ]


def _check(look: ReportLook, content: ReportContent) -> list[Flowable]:
    """The interim check of these calibrations."""
    if content.check is None:
        return []
    return [
        Spacer(0, 2 * mm),
        look.fixed_text("Check of camera and laser", "small_strong"),
        look.text(look.words(content.check.sentence), "small"),
        figures(look, check_facts(content.check), 5),
    ]


TARGETS = {
    "camera_target": label("Camera target"),
    "plane_target": label("Plane target"),
    "reference_target": label("Reference target"),
}
ALWAYS_TOLD = ("camera_target", "plane_target")
"""Targets that every length rests on: the report says of these as well that nothing is stated.
Without a fan, lengths rest on the plane target only where the rig states one."""


def traceability(look: ReportLook, content: ReportContent) -> list[Flowable]:
    """Make the section on the certificates that make lengths traceable to the metre; it is always printed."""
    words, day = look.words, content.timestamp.date()
    traced = {
        words(title): content.certificates.get(name, Certificate())
        for name, title in TARGETS.items()
        if name in content.certificates or (name in ALWAYS_TOLD and (content.has_fan or title in content.rig))
    }
    boards = {name.partition(".")[2]: one for name, one in content.certificates.items() if name not in TARGETS}
    traced |= {words("Board {name}", name=name): one for name, one in boards.items()}
    artefacts = {one.artefact.id: one.artefact.of_certificate for one in content.artefacts}
    traced |= {words("Artefact {name}", name=name): one for name, one in artefacts.items()} or {
        words("Artefact"): Certificate()
    }
    rows: list[list[Flowable]] = [heads(look, "Standard", "certificate", "laboratory", "due")]
    for title, one in traced.items():
        due = words("not stated") if one.due is None else words.day(one.due)
        until = words("{day}, lapsed", day=due) if one.lapsed(day) else due
        said = (one.number, one.laboratory, until) if one.stated else (words("none stated"), "–", "–")
        rows.append([look.text(title, "small"), *(look.text(text or words("not stated"), "small") for text in said)])
    table = ruled_table(rows, [TEXT_WIDTH * share for share in (0.3, 0.28, 0.27, 0.15)])
    return [section(look, "traceability", "Traceability", [table])]


def pictures_used(look: ReportLook, content: ReportContent, limits: Limits) -> list[Flowable]:
    """Make the section on how many frames and calibration pictures were used, and why others were left out."""
    used = [frame.name for frame in content.frames if frame.used]
    parts: list[Flowable] = [figures(look, content.scan_facts), *fact_tables(look, content.plane_tables)]
    if not content.frames:
        parts.append(look.fixed_text("No frame was given.", "small"))
    if used:
        parts.append(look.fixed_text("From {first} to {last}.", "small", first=used[0], last=used[-1]))
    out = [*left_out(content.frames), *left_out((*content.camera.views, *content.fan.poses))]
    if out:
        parts += [Spacer(0, 1.5 * mm), *left_out_table(look, out, TEXT_WIDTH, limits.reasons, limits.names)]
    return [section(look, "frames", "Frames and calibration pictures", parts)]


def warnings(look: ReportLook, content: ReportContent, limits: Limits) -> list[Flowable]:
    """Make the section of the program's warnings and notes; it is always printed."""
    notes = content.all_notes
    if not notes:
        return []
    grave = sum(map(is_grave, notes))
    shown = tuple(look.words.known(note) for note in notes[: max(grave, limits.notes)])
    body = [
        *look.bullets(shown[:grave], "alarm"),
        *look.bullets(shown[grave:]),
        *more_line(look, len(notes) - len(shown)),
    ]
    return [section(look, "notes", "Notes and warnings", body)]


def remarks(look: ReportLook, content: ReportContent) -> list[Flowable]:
    """Make the section of the operator's remarks; [] if there are none."""
    lines = look.lines(content.remarks) if content.remarks.strip() else []
    return [section(look, "remarks", "Remarks of the operator", list(lines[:3])), *lines[3:]] if lines else []


def settings(look: ReportLook, content: ReportContent, limits: Limits) -> list[Flowable]:
    """Make the section on software version and settings, with the hash over them and those that wings bring."""
    known = {look.words.known(name): look.words.known(value) for name, value in content.settings.items()}
    pairs = {look.words("Software"): f"Trisect {content.version}"} | known
    shown = list(pairs.items())[: limits.settings]
    middle, column = (len(shown) + 1) // 2, (TEXT_WIDTH - GAP) / 2
    columns: list[list[Flowable]] = [
        [pairs_table(look, dict(part), column, 27 * mm)] if part else [] for part in (shown[:middle], shown[middle:])
    ]
    over_all = look.words("SHA-256 over version, method and settings: {hash}", hash=short_hash(content.settings_digest))
    body = [side_by_side(columns[0], columns[1], TEXT_WIDTH), look.text(over_all, "small")]
    for one in content.evidence:
        body += [look.text(look.words(one.text), "small"), Paragraph(markup(one.sha256), look.style("mono"))]
    return [
        section(look, "settings", "Software and settings", body),
        *more_line(look, len(pairs) - limits.settings),
    ]


def inputs(look: ReportLook, content: ReportContent, limits: Limits) -> list[Flowable]:
    """Make the section with the hash over all input files and, unless hidden, the hash of each file."""
    if not content.hashes:
        return [section(look, "inputs", "Inputs", [look.fixed_text("No hashes of the inputs were given.", "small")])]
    listed = "inputs" not in content.hidden
    counted = look.words(plural_message("report.inputs", "{n:,} input", "{n:,} inputs", n=len(content.hashes)))
    if listed:
        note = look.words(
            "SHA-256 of {inputs}, its first {n} characters; all of them in full are in run.json. Over all inputs "
            "together:",
            inputs=counted,
            n=SHORT_HASH,
        )
    else:
        note = look.words("SHA-256 over all {inputs}; those of each are in run.json:", inputs=counted)
    digest = Paragraph(markup(content.inputs_digest), look.style("mono"))
    body: list[Flowable] = [look.text(note, "small"), digest]
    if not listed:
        return [section(look, "inputs", "Inputs", body)]
    rule = HRFlowable(width="100%", thickness=0.25, color=color(HAIRLINE), spaceBefore=2, spaceAfter=2)
    head = section(look, "inputs", "Inputs", [*body, rule])
    return [head, *hash_table(look, content.hashes, TEXT_WIDTH, limits.inputs)]


def end(look: ReportLook, content: ReportContent) -> list[Flowable]:
    """Make the line that ends the report, after a list of the sections that were left out by choice."""
    said = look.words("End of report {report}", report=content.report_id)
    mark = Paragraph(f"— {markup(said)} —", look.style("end"))
    left_out = [look.words(heading) for name, heading in content.printable.items() if name in content.hidden]
    if not left_out:
        return [mark]
    words = look.words("Left out of this report by choice: {sections}.", sections=look.words.joined(left_out, ";"))
    return [KeepTogether([Spacer(0, 3 * mm), look.text(words, "small"), mark])]


SHORT_HASH = 10
"""Characters printed of an input's SHA-256; the whole of it is in run.json."""


def left_out_table(
    look: ReportLook, reasons: list[LeftOut], width: float, most: int, most_names: int
) -> list[Flowable]:
    """Make the table of why pictures were left out: each reason, how often, and which pictures."""
    if not reasons:
        return []
    rows: list[list[Flowable]] = [heads(look, "Left out because", "how many", "which", numbers=(1,))]
    for reason, names in reasons[:most]:
        which = look.words.joined(names[:most_names])
        if len(names) > most_names:
            which += look.words(" and {n} more", n=grouped(len(names) - most_names))
        rows.append(
            [
                look.text(look.words.known(reason), "small"),
                look.text(grouped(len(names)), "number"),
                look.text(which, "small"),
            ]
        )
    table = ruled_table(rows, [0.4 * width, 0.12 * width, 0.48 * width])
    table.setStyle(TableStyle([("LEFTPADDING", (2, 0), (2, -1), 6)]))
    return [table, *more_line(look, len(reasons) - most)]


def hash_table(look: ReportLook, hashes: Mapping[str, str], width: float, most: int) -> list[Flowable]:
    """Make the table of input files by folder with the first characters of their SHA-256, at most `most` files.

    As many columns as the longest name leaves room for.
    """
    shown = sorted(hashes, key=lambda path: ("/" in path, path))[:most]
    folders: dict[str, list[str]] = {}
    for path in shown:
        folders.setdefault(path.rpartition("/")[0], []).append(path)
    longest = max((stringWidth(path.rpartition("/")[2], SANS, 6) for path in shown), default=0.0)
    room = longest + stringWidth("0" * (SHORT_HASH + 2), MONO, 5.6) + 6
    columns = int(min(max(width // room, 1), 6))
    rows: list[list[Cell]] = []
    head_rows = []
    for folder, paths in folders.items():
        if folder:
            head_rows.append(len(rows))
            rows.append([look.text(f"{folder}/", "hash_folder"), *[""] * (columns - 1)])
        depth = -(-len(paths) // columns)
        cells = [_hash_cell(look, path, hashes[path]) for path in paths]
        rows += [[*cells[row::depth], *[""] * (columns - len(cells[row::depth]))] for row in range(depth)]
    parts: list[Flowable] = []
    if rows:
        table = plain_table(rows, [width / columns] * columns)
        style: list[tuple[object, ...]] = [(side, (0, 0), (-1, -1), 0.3) for side in ("TOPPADDING", "BOTTOMPADDING")]
        style += [("FONTSIZE", (0, 0), (-1, -1), 1), ("LEADING", (0, 0), (-1, -1), 1)]  # of the empty cells
        style += [("SPAN", (0, row), (-1, row)) for row in head_rows]
        style += [("TOPPADDING", (0, row), (-1, row), 2) for row in head_rows]
        table.setStyle(TableStyle(style))
        parts.append(table)
    return [*parts, *more_line(look, len(hashes) - most)]


def _hash_cell(look: ReportLook, path: str, digest: str) -> Paragraph:
    name = markup(path.rpartition("/")[2])
    code = f'<font name="{MONO}" size="5.6" color="{MUTED}">{markup(digest[:SHORT_HASH])}</font>'
    return Paragraph(f"{name} {code}", look.style("hash"))
