"""The sections of the report, in printing order."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from reportlab.lib.units import mm
from reportlab.lib.utils import ImageReader
from reportlab.platypus import Flowable, HRFlowable, Spacer

from core.inspect.results import GaugeResult
from core.report import evidence, tables
from core.report.content import ReportContent
from core.report.layout import Limits, Picture, section
from core.report.repeats import repeats_head, repeats_table
from core.report.result_box import result_box
from core.report.style import ACCENT, TEXT_WIDTH, bullets, color, text
from core.report.wording import count, fixed, grouped, limits_of_cloud, limits_of_thickness, temperatures_line

TITLE = "Measurement report"


def story(content: ReportContent, pictures: Mapping[str, ImageReader], limits: Limits) -> list[Flowable]:
    """Everything from the title to the end mark, without what is hidden."""
    parts: list[tuple[str, Callable[[], list[Flowable]]]] = [
        ("surface", lambda: _surface(content, pictures, limits)),
        ("frame", lambda: _frame(content, pictures, limits)),
        ("maps", lambda: _maps(content, pictures, limits)),
        ("budget", lambda: _budget(content)),
        ("repeats", lambda: _repeats(content, pictures, limits)),
        ("calibrations", lambda: evidence.calibrations(content, limits)),
        ("frames", lambda: evidence.pictures_used(content, limits)),
        ("", lambda: evidence.warnings(content, limits)),
        ("remarks", lambda: evidence.remarks(content)),
        ("settings", lambda: evidence.settings(content, limits)),
        ("", lambda: evidence.inputs(content, limits)),
    ]
    chosen = [flowable for name, part in parts if name not in content.hidden for flowable in part()]
    return [
        *_title(content),
        Spacer(0, 4 * mm),
        result_box(content, TEXT_WIDTH),
        *_not_covered(content),
        *chosen,
        *evidence.end(content),
    ]


def _title(content: ReportContent) -> list[Flowable]:
    head = tables.plain_table(
        [[text(TITLE, "title"), text(content.laboratory, "laboratory")]], [0.5 * TEXT_WIDTH, 0.5 * TEXT_WIDTH]
    )
    head.setStyle([("VALIGN", (0, 0), (-1, -1), "BOTTOM"), ("BOTTOMPADDING", (0, 0), (-1, -1), 3)])
    left = {
        "Part": content.part or "not named",
        "Serial number": content.serial,
        "Customer": content.customer,
        "Operator": content.operator,
        "Temperatures": temperatures_line(content.air_celsius, content.part_celsius),
    }
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
    stated = content.air_celsius is not None or content.part_celsius is not None
    gauge = content.gauge
    general = limits_of_thickness(gauge, temperatures=stated) if gauge else limits_of_cloud(temperatures=stated)
    sentences = general + content.limits
    return [section("What this result does not cover", list(bullets(sentences)))]


def _surface(content: ReportContent, pictures: Mapping[str, ImageReader], limits: Limits) -> list[Flowable]:
    if "surface" not in pictures:
        return [section("Measured surface", [text("No point was measured, so there is no surface to show.")])]
    drawn = len(content.mesh.triangles)
    what = f"Mesh of {grouped(drawn)} triangles" if drawn else f"Cloud of {grouped(len(content.cloud))} points"
    above = "the lower face" if content.gauge else "the farthest points, towards the camera"
    caption = (
        f"{what}, in parallel projection, shaded; colour: height above {above}. "
        "Dimensions are those of the measured area. Blank: not measured."
    )
    return [section("Measured surface", [Picture(pictures["surface"], limits.picture_scale), text(caption, "caption")])]


def _frame(content: ReportContent, pictures: Mapping[str, ImageReader], limits: Limits) -> list[Flowable]:
    overlay = content.overlay
    if overlay is None:
        return []
    caption = (
        f"Frame {overlay.name}, brightened, with {count(len(overlay.crossings), 'crossing')} of the hand-moved line "
        "and the fan. σ is the standard uncertainty of the depth of the points on the hand-moved line."
    )
    body = [Picture(pictures["frame"], limits.picture_scale), text(caption, "caption")]
    return [section("One frame of the scan", body)]


def _maps(content: ReportContent, pictures: Mapping[str, ImageReader], limits: Limits) -> list[Flowable]:
    if "maps" not in pictures:
        return []
    picture = Picture(pictures["maps"], limits.picture_scale)
    if content.gauge is None:
        caption = "Mean of the points in each cell of the picture; grey: no point."
        return [section("Depth and its uncertainty over the picture", [picture, text(caption, "caption")])]
    caption = (
        "Distance of the points from the fitted plane, mean per cell, towards the camera positive (orange); grey: no "
        "point. Along: to the right in the picture; across: upwards in the picture. Spread: share of the points per "
        "bin, what lies beyond counted in the last one."
    )
    return [
        section(
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
    return [section("Uncertainty budget of the thickness", [tables.budget_table(content.gauge, TEXT_WIDTH)])]


def _repeats(content: ReportContent, pictures: Mapping[str, ImageReader], limits: Limits) -> list[Flowable]:
    head = repeats_head(content)
    if not head:
        return []
    if "repeats" in pictures:
        caption = "Thickness with ±U of each scan, in the order of measuring."
        head += [Spacer(0, 2 * mm), Picture(pictures["repeats"], limits.picture_scale), text(caption, "caption")]
    return [section("Repeated scans", head), Spacer(0, 2 * mm), *repeats_table(content, limits.repeats)]
