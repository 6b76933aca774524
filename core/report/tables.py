"""The report's tables. Thin rules, no boxes; numbers to the right; every cell wraps, so nothing is cut."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from reportlab.lib.units import mm
from reportlab.pdfbase.pdfmetrics import stringWidth
from reportlab.platypus import Flowable, Paragraph, Table, TableStyle

from core.calibrate.results import CAMERA_PARAMETERS, CameraCalibration, FanCalibration
from core.inspect.results import GaugeResult
from core.report.content import ReportContent
from core.report.style import ACCENT, HAIRLINE, MONO, MUTED, SANS, STYLES, TINT, color, markup, text
from core.report.wording import count, decimals_of, fixed, grouped

SYMBOLS = {"alpha": "α", "beta": "β", "gamma": "γ (skew)", "u0": "u₀", "v0": "v₀"}
UNITS = {"alpha": "px", "beta": "px", "gamma": "px", "u0": "px", "v0": "px"}

SHORT_HASH = 10
"""Characters printed of an input's SHA-256; the whole of it is in run.json."""

_PLAIN = [
    ("FONTNAME", (0, 0), (-1, -1), SANS),
    ("LEFTPADDING", (0, 0), (-1, -1), 0),
    ("RIGHTPADDING", (0, 0), (-1, -1), 6),
    ("RIGHTPADDING", (-1, 0), (-1, -1), 0),
    ("TOPPADDING", (0, 0), (-1, -1), 1.6),
    ("BOTTOMPADDING", (0, 0), (-1, -1), 1.6),
    ("VALIGN", (0, 0), (-1, -1), "TOP"),
]


def plain_table(rows: Sequence[Sequence[Flowable | list[Flowable] | str]], widths: Sequence[float]) -> Table:
    """Cells without any rule."""
    return Table(rows, colWidths=widths, style=TableStyle(_PLAIN), hAlign="LEFT")


def ruled_table(rows: Sequence[Sequence[Flowable | str]], widths: Sequence[float]) -> Table:
    """A head row under which a rule runs, a hairline below each further row."""
    style = [
        *_PLAIN,
        ("LINEBELOW", (0, 0), (-1, 0), 0.6, color(MUTED)),
        ("LINEBELOW", (0, 1), (-1, -1), 0.25, color(HAIRLINE)),
    ]
    return Table(rows, colWidths=widths, style=TableStyle(style), hAlign="LEFT", repeatRows=1)


def pairs_table(pairs: Mapping[str, str], width: float, label_width: float) -> Table:
    """Label and value, one pair a row."""
    rows = [[text(label, "label"), text(value, "small")] for label, value in pairs.items()]
    return plain_table(rows or [[text("none", "small"), text("", "small")]], [label_width, width - label_width])


def side_by_side(left: list[Flowable], right: list[Flowable], width: float, share: float = 0.5) -> Table:
    """Two columns with a gap of 8 mm; `share` of the rest is the left one's."""
    gap = 8 * mm
    inner = (width - gap) * share
    style = TableStyle([*_PLAIN, ("RIGHTPADDING", (0, 0), (-1, -1), 0), ("TOPPADDING", (0, 0), (-1, -1), 0)])
    return Table(
        [[left, "", right]], colWidths=[inner, gap, width - gap - inner], style=style, hAlign="LEFT", splitInRow=1
    )


class ShareBar(Flowable):  # type: ignore[misc]
    """A small bar whose length is a share 0…1 of `width`."""

    def __init__(self, share: float, width: float) -> None:
        super().__init__()
        self.share, self.width, self.height = share, width, 9.4

    def draw(self) -> None:
        """Paint it (called by reportlab)."""
        self.canv.setFillColor(color(TINT))
        self.canv.rect(0, 1.5, self.width, 5, stroke=0, fill=1)
        self.canv.setFillColor(color(ACCENT))
        self.canv.rect(0, 1.5, self.width * min(max(self.share, 0.0), 1.0), 5, stroke=0, fill=1)


def budget_table(gauge: GaugeResult, width: float) -> Table:
    """Where the uncertainty comes from: each contribution, its share of the variance, the combination, k and U.

    With what the same cause does to a typical point, and how much of that arrives in the thickness.
    """
    decimals = decimals_of(gauge.u_mm) + 1
    variance = sum(row.u_mm**2 for row in gauge.budget if math.isfinite(row.u_mm)) or 1.0
    widths = [width - 104 * mm, 24 * mm, 20 * mm, 18 * mm, 20 * mm, 22 * mm]
    blank = text("", "small")
    rows: list[list[Flowable]] = [
        [
            text("Contribution", "head"),
            text("of one point, mm", "head_number"),
            text("sensitivity", "head_number"),
            text("u, mm", "head_number"),
            text("share of u², %", "head_number"),
            text("", "head"),
        ]
    ]
    for row in gauge.budget:
        share = row.u_mm**2 / variance
        tiny = math.isfinite(row.u_mm) and 0 < row.u_mm < 0.5 * 10.0**-decimals
        shown = f"< {fixed(10.0**-decimals, decimals)}" if tiny else fixed(row.u_mm, decimals)
        bar: Flowable = ShareBar(share, 20 * mm) if math.isfinite(share) else blank
        rows.append(
            [
                text(row.source[:1].upper() + row.source[1:], "small"),
                blank if row.point_mm is None else text(fixed(row.point_mm, decimals), "number"),
                blank if row.sensitivity is None else text(fixed(row.sensitivity, 2), "number"),
                text(shown, "number"),
                text(fixed(100 * share, 0), "number"),
                bar,
            ]
        )
    U_row = f"Expanded uncertainty U = k·u, k = {gauge.k:g}"
    combined = text(fixed(gauge.u_mm, decimals), "number")
    rows.append([text("Combined standard uncertainty u", "small"), blank, blank, combined, blank, blank])
    U_shown = fixed(gauge.U_mm, decimals_of(gauge.U_mm))
    rows.append([text(U_row, "small_strong"), blank, blank, text(U_shown, "number_strong"), blank, blank])
    table = ruled_table(rows, widths)
    table.setStyle(
        TableStyle([("LINEBELOW", (0, -3), (-1, -3), 0.6, color(MUTED)), ("LEFTPADDING", (5, 0), (5, -1), 4)])
    )
    return table


def camera_table(calibration: CameraCalibration, width: float) -> Table:
    """The camera's parameters with their standard deviations."""
    camera = calibration.camera
    A = camera.matrix
    values = dict(
        zip(CAMERA_PARAMETERS, [A[0, 0], A[1, 1], A[0, 1], A[0, 2], A[1, 2], *camera.distortion], strict=True)
    )
    rows: list[list[Flowable]] = [
        [text("Parameter", "head"), text("value", "head_number"), text("standard deviation", "head_number")]
    ]
    for name in CAMERA_PARAMETERS:
        value, sd = values[name], calibration.sd[name]
        if sd <= 0 and value == 0:
            continue  # a coefficient the model leaves out
        decimals = decimals_of(sd) if sd > 0 else 6
        unit = UNITS.get(name, "")
        label = SYMBOLS.get(name, name) + (f", {unit}" if unit else "")
        spread = fixed(sd, decimals) if sd > 0 else "fixed"
        rows.append([text(label, "small"), text(fixed(value, decimals), "number"), text(spread, "number")])
    return ruled_table(rows, [0.3 * width, 0.35 * width, 0.35 * width])


def camera_facts(calibration: CameraCalibration) -> dict[str, str]:
    """How good the camera's calibration is."""
    used = sum(view.used for view in calibration.views)
    apart = calibration.cross_validation_mm
    tilts = math.degrees(calibration.tilt_range)
    return {
        "Views": f"{used} of {count(len(calibration.views), 'view')} used",
        "Corner error": f"mean {calibration.mean_px:.3f} px, rms {calibration.rms_px:.3f} px",
        "Coverage": f"{100 * calibration.coverage:.0f} % of the picture, tilts {tilts:.0f}°",
        "Odd/even views": f"{fixed(apart, 3)} mm apart over the work volume"
        if math.isfinite(apart)
        else "too few views",
    }


def fan_table(calibration: FanCalibration, width: float) -> Table:
    """The fan's planes: normal, distance from the camera, fit, and the angle to the next one."""
    rows: list[list[Flowable]] = [
        [
            text("Line", "head"),
            text("normal (x, y, z)", "head"),
            text("d, mm", "head_number"),
            text("rms, mm", "head_number"),
            text("to the next, ° (free fit)", "head_number"),
        ]
    ]
    for index, plane in enumerate(calibration.fan.planes):
        normal = ", ".join(fixed(float(value), 4) for value in plane.normal)
        angle = ""
        if index < len(calibration.angles):
            angle = (
                f"{math.degrees(calibration.angles[index]):.3f} ({math.degrees(calibration.free_angles[index]):.3f})"
            )
        rms = calibration.rms_mm[index] if index < len(calibration.rms_mm) else math.nan
        rows.append(
            [
                text(f"{index + 1}", "small"),
                text(normal, "small"),
                text(fixed(plane.d_mm, 2), "number"),
                text(fixed(rms, 3), "number"),
                text(angle, "number"),
            ]
        )
    return ruled_table(rows, [width * share for share in (0.085, 0.395, 0.13, 0.15, 0.24)])


def fan_facts(calibration: FanCalibration) -> dict[str, str]:
    """How good the fan's calibration is."""
    used = sum(pose.used for pose in calibration.poses)
    facts = {"Poses": f"{used} of {count(len(calibration.poses), 'pose')} of the plane target used"}
    if calibration.constraint_suits is not None:
        facts["Free planes from one pencil"] = f"at most {fixed(calibration.pencil_gap_mm, 3)} mm in the work volume"
    if calibration.verdict:
        facts["Check of the constraint"] = calibration.verdict
    return facts


def left_out_table(left_out: list[tuple[str, list[str]]], width: float, most: int, most_names: int) -> list[Flowable]:
    """Reasons, how often, and which: at most `most` reasons, and of each at most `most_names` names."""
    if not left_out:
        return []
    rows: list[list[Flowable]] = [
        [text("Left out because", "head"), text("how many", "head_number"), text("which", "head")]
    ]
    for reason, names in left_out[:most]:
        which = ", ".join(names[:most_names])
        if len(names) > most_names:
            which += f" and {grouped(len(names) - most_names)} more"
        rows.append([text(reason, "small"), text(grouped(len(names)), "number"), text(which, "small")])
    table = ruled_table(rows, [0.4 * width, 0.12 * width, 0.48 * width])
    table.setStyle(TableStyle([("LEFTPADDING", (2, 0), (2, -1), 6)]))
    return [table, *more_line(len(left_out) - most)]


def left_out_of_calibration(content: ReportContent) -> list[tuple[str, list[str]]]:
    """Views and poses the calibrations did without, by reason."""
    reasons: dict[str, list[str]] = {}
    for view in content.camera.views:
        if not view.used:
            reasons.setdefault(view.reason or "no reason recorded", []).append(view.view.name or "view without a name")
    for pose in content.fan.poses:
        if not pose.used:
            reasons.setdefault(pose.reason or "no reason recorded", []).append(pose.name)
    return sorted(reasons.items(), key=lambda item: -len(item[1]))


def hash_table(hashes: Mapping[str, str], width: float, most: int) -> list[Flowable]:
    """Every input by folder, with the beginning of its SHA-256; at most `most` of them.

    As many columns as the longest name leaves room for.
    """
    shown = sorted(hashes, key=lambda path: ("/" in path, path))[:most]
    folders: dict[str, list[str]] = {}
    for path in shown:
        folders.setdefault(path.rpartition("/")[0], []).append(path)
    longest = max((stringWidth(path.rpartition("/")[2], SANS, 6) for path in shown), default=0.0)
    room = longest + stringWidth("0" * (SHORT_HASH + 2), MONO, 5.6) + 6
    columns = int(min(max(width // room, 1), 6))
    rows: list[list[Flowable | str]] = []
    heads = []
    for folder, paths in folders.items():
        if folder:
            heads.append(len(rows))
            rows.append([text(f"{folder}/", "hash_folder"), *[""] * (columns - 1)])
        depth = -(-len(paths) // columns)
        cells = [_hash_cell(path, hashes[path]) for path in paths]
        rows += [[*cells[row::depth], *[""] * (columns - len(cells[row::depth]))] for row in range(depth)]
    parts: list[Flowable] = []
    if rows:
        table = plain_table(rows, [width / columns] * columns)
        style: list[tuple[object, ...]] = [(side, (0, 0), (-1, -1), 0.3) for side in ("TOPPADDING", "BOTTOMPADDING")]
        style += [("FONTSIZE", (0, 0), (-1, -1), 1), ("LEADING", (0, 0), (-1, -1), 1)]  # of the empty cells
        style += [("SPAN", (0, row), (-1, row)) for row in heads] + [
            ("TOPPADDING", (0, row), (-1, row), 2) for row in heads
        ]
        table.setStyle(TableStyle(style))
        parts.append(table)
    return [*parts, *more_line(len(hashes) - most)]


def _hash_cell(path: str, digest: str) -> Paragraph:
    name = markup(path.rpartition("/")[2])
    code = f'<font name="{MONO}" size="5.6" color="{MUTED}">{markup(digest[:SHORT_HASH])}</font>'
    return Paragraph(f"{name} {code}", STYLES["hash"])


def more_line(left: int, where: str = "run.json") -> list[Flowable]:
    """'and 12 more, listed in run.json', or nothing."""
    return [text(f"and {grouped(left)} more, listed in {where}", "label")] if left > 0 else []
