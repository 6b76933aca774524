"""The sections of the report, in printing order."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from reportlab.lib.units import mm
from reportlab.lib.utils import ImageReader
from reportlab.platypus import Flowable, HRFlowable, KeepTogether, Paragraph, Spacer

from core.inspect.results import GaugeResult
from core.report import tables
from core.report.content import ReportContent
from core.report.result_box import result_box
from core.report.style import ACCENT, HAIRLINE, STYLES, TEXT_WIDTH, bullets, color, markup, text
from core.report.wording import count, fixed, grouped, limits_of_cloud, limits_of_thickness

TITLE = "Measurement report"


@dataclass(frozen=True, slots=True)
class Limits:
    """How many rows the long lists may have, the rest being 'and n more', and how large the pictures are."""

    inputs: int
    reasons: int
    names: int
    notes: int
    settings: int
    picture_scale: float


class Picture(Flowable):  # type: ignore[misc]
    """A picture of the text's width times `scale`, centred."""

    def __init__(self, reader: ImageReader, scale: float) -> None:
        super().__init__()
        columns, rows = reader.getSize()
        self.reader, self.inner = reader, TEXT_WIDTH * scale
        self.width, self.height = TEXT_WIDTH, TEXT_WIDTH * scale * rows / columns

    def draw(self) -> None:
        """Paint it (called by reportlab)."""
        left = (self.width - self.inner) / 2
        self.canv.drawImage(self.reader, left, 0, width=self.inner, height=self.height)


def story(content: ReportContent, pictures: Mapping[str, ImageReader], limits: Limits) -> list[Flowable]:
    """Everything from the title to the end mark."""
    return [
        *_title(content),
        Spacer(0, 4 * mm),
        result_box(content, TEXT_WIDTH),
        *_not_covered(content),
        *_surface(content, pictures, limits),
        *_frame(content, pictures, limits),
        *_maps(content, pictures, limits),
        *_budget(content),
        *_rig_and_calibrations(content, limits),
        *_frames(content, limits),
        *_notes(content, limits),
        *_evaluation(content, limits),
        *_inputs(content, limits),
        Paragraph(f"— End of report {content.report_id} —", STYLES["end"]),
    ]


def _section(heading: str, first: list[Flowable]) -> Flowable:
    """A heading that stays with what follows it."""
    return KeepTogether([text(heading, "section"), *first])


def _title(content: ReportContent) -> list[Flowable]:
    head = tables.plain_table(
        [[text(TITLE, "title"), text(content.laboratory, "laboratory")]], [0.5 * TEXT_WIDTH, 0.5 * TEXT_WIDTH]
    )
    head.setStyle([("VALIGN", (0, 0), (-1, -1), "BOTTOM"), ("BOTTOMPADDING", (0, 0), (-1, -1), 3)])
    left = {"Part": content.part or "not named", "Serial number": content.serial, "Operator": content.operator}
    right = {
        "Report": content.report_id,
        "Date and time": f"{content.timestamp:%Y-%m-%d %H:%M:%S %Z}".strip(),
        "Sweeps located by": content.method,
    }
    columns = [
        tables.pairs_table({label: value for label, value in pairs.items() if value}, 81 * mm, 27 * mm)
        for pairs in (left, right)
    ]
    rule = HRFlowable(width="100%", thickness=1.4, color=color(ACCENT), spaceBefore=0, spaceAfter=4)
    return [head, rule, tables.side_by_side([columns[0]], [columns[1]], TEXT_WIDTH)]


def _not_covered(content: ReportContent) -> list[Flowable]:
    sentences = (limits_of_thickness(content.gauge) if content.gauge else limits_of_cloud()) + content.limits
    return [_section("What this result does not cover", list(bullets(sentences)))]


def _surface(content: ReportContent, pictures: Mapping[str, ImageReader], limits: Limits) -> list[Flowable]:
    if "surface" not in pictures:
        return [_section("Measured surface", [text("No point was measured, so there is no surface to show.")])]
    drawn = len(content.mesh.triangles)
    what = f"Mesh of {grouped(drawn)} triangles" if drawn else f"Cloud of {grouped(len(content.cloud))} points"
    above = "the lower face" if content.gauge else "the farthest points, towards the camera"
    caption = (
        f"{what}, in parallel projection, shaded; colour: height above {above}. "
        "Dimensions are those of the measured area. Blank: not measured."
    )
    return [
        _section("Measured surface", [Picture(pictures["surface"], limits.picture_scale), text(caption, "caption")])
    ]


def _frame(content: ReportContent, pictures: Mapping[str, ImageReader], limits: Limits) -> list[Flowable]:
    overlay = content.overlay
    if overlay is None:
        return []
    caption = (
        f"Frame {overlay.name}, brightened, with {count(len(overlay.crossings), 'crossing')} of the hand-moved line "
        "and the fan. σ is the standard uncertainty of the depth of the points on the hand-moved line."
    )
    body = [Picture(pictures["overlay"], limits.picture_scale), text(caption, "caption")]
    return [_section("One frame of the scan", body)]


def _maps(content: ReportContent, pictures: Mapping[str, ImageReader], limits: Limits) -> list[Flowable]:
    if "maps" not in pictures:
        return []
    picture = Picture(pictures["maps"], limits.picture_scale)
    if content.gauge is None:
        caption = "Mean of the points in each cell of the picture; grey: no point."
        return [_section("Depth and its uncertainty over the picture", [picture, text(caption, "caption")])]
    caption = (
        "Distance of the points from the fitted plane, mean per cell, towards the camera positive (orange); grey: no "
        "point. Along: to the right in the picture; across: upwards in the picture. Spread: share of the points per "
        "bin, what lies beyond counted in the last one."
    )
    return [
        _section(
            "Residuals of both faces", [_faces(content.gauge), Spacer(0, 2 * mm), picture, text(caption, "caption")]
        )
    ]


def _faces(gauge: GaugeResult) -> Flowable:
    heads = [("Face", "head"), ("points", "head_number"), ("rms of the residuals, mm", "head_number")]
    heads += [
        ("flatness (95 % of the points), mm", "head_number"),
        ("angle between the faces, fitted freely", "head_number"),
    ]
    rows: list[list[Flowable]] = [[text(words, style) for words, style in heads]]
    for name, face, angle in (
        ("Upper", gauge.upper, f"{fixed(math.degrees(gauge.parallelism), 3)}°"),
        ("Lower", gauge.lower, ""),
    ):
        numbers = (grouped(len(face.indices)), fixed(face.rms_mm, 3), fixed(face.flatness_mm, 3), angle)
        rows.append([text(name, "small"), *(text(number, "number") for number in numbers)])
    return tables.ruled_table(rows, [TEXT_WIDTH * share for share in (0.1, 0.12, 0.22, 0.28, 0.28)])


def _budget(content: ReportContent) -> list[Flowable]:
    if content.gauge is None:
        return []
    return [_section("Uncertainty budget of the thickness", [tables.budget_table(content.gauge, TEXT_WIDTH)])]


def _rig_and_calibrations(content: ReportContent, limits: Limits) -> list[Flowable]:
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
    return [_section("Calibrations and rig", [tables.side_by_side(camera, fan, TEXT_WIDTH, 0.42)])]


def _frames(content: ReportContent, limits: Limits) -> list[Flowable]:
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
    return [_section("Frames and calibration pictures", parts)]


def _notes(content: ReportContent, limits: Limits) -> list[Flowable]:
    notes = content.all_notes
    if not notes:
        return []
    return [
        _section(
            "Notes and warnings",
            [*bullets(notes[: limits.notes]), *tables.more_line(len(notes) - limits.notes)],
        )
    ]


def _evaluation(content: ReportContent, limits: Limits) -> list[Flowable]:
    pairs = {"Software": f"Trisect {content.version}"} | dict(content.settings)
    shown = list(pairs.items())[: limits.settings]
    middle = (len(shown) + 1) // 2
    columns: list[list[Flowable]] = [
        [tables.pairs_table(dict(part), 81 * mm, 27 * mm)] if part else [] for part in (shown[:middle], shown[middle:])
    ]
    return [
        _section("Software and settings", [tables.side_by_side(columns[0], columns[1], TEXT_WIDTH)]),
        *tables.more_line(len(pairs) - limits.settings),
    ]


def _inputs(content: ReportContent, limits: Limits) -> list[Flowable]:
    if not content.hashes:
        return [_section("Inputs", [text("No hashes of the inputs were given.", "small")])]
    note = (
        f"SHA-256 of {count(len(content.hashes), 'input')}, its first {tables.SHORT_HASH} characters; all of them in "
        "full are in run.json. Over all inputs together:"
    )
    digest = Paragraph(markup(content.inputs_digest), STYLES["mono"])
    listed = tables.hash_table(content.hashes, TEXT_WIDTH, limits.inputs)
    rule = HRFlowable(width="100%", thickness=0.25, color=color(HAIRLINE), spaceBefore=2, spaceAfter=2)
    return [_section("Inputs", [text(note, "small"), digest, rule]), *listed]
