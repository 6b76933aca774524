"""What the scan page says of frames, runs and results."""

from __future__ import annotations

import math

from PySide6.QtCore import QCoreApplication

from core.scan.frame_record import FrameRecord
from core.scan.scan_look import ScanLook
from core.scan.stages import FrameStages
from workbench.views.colours import Level

Row = tuple[str, str, str, Level]

_RAISED = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")


def quality_rows(look: ScanLook | None) -> list[Row]:
    """How good the result is: label, value with unit, tip, level."""
    if look is None:
        return []
    return [
        (_tr("Points"), count(len(look)), _tr("Measured points, each with its own σ"), ""),
        (_tr("Triangles"), count(look.triangles), _tr("Of the mesh made from the points"), ""),
        (
            _tr("Frames used"),
            _tr("{0} of {1}").format(look.frames_used, len(look.frames)),
            _tr("Frames that gave points, and all there are"),
            "",
        ),
        (
            _tr("Median σ"),
            mm(look.median_sigma_mm),
            _tr("Half of the points have a smaller standard uncertainty of depth; without what is common to the scan"),
            "",
        ),
        (_tr("95 % of σ"), mm(look.sigma_95_mm), _tr("95 % of the points have a smaller σ"), ""),
        (
            _tr("Covered"),
            _tr("{0} of what was lit").format(percent(look.share)),
            _tr("Share of the picture between all laser light in which there are points"),
            "",
        ),
    ]


def reason_rows(look: ScanLook | None) -> list[Row]:
    """Why frames gave no points, and how many."""
    if look is None:
        return []
    return [
        (sentence(reason), str(frames), _tr("Frames left out for this reason"), "") for reason, frames in look.left_out
    ]


def frame_line(record: FrameRecord | None, seen: tuple[int, str] | None) -> str:
    """The second line of a frame in the list; `seen`: points in the preview, and why there are none."""
    if record is not None:
        if not record.used:
            return record.reason
        return _tr("{0} points").format(count(record.points))
    if seen is not None:
        points, reason = seen
        return reason or _tr("{0} points in the preview").format(count(points))
    return ""


def frame_sentence(place: int, total: int, name: str, record: FrameRecord | None, stages: FrameStages | None) -> str:
    """What is to be said of one frame."""
    start = _tr("Frame {0} of {1} ({2})").format(place + 1, total, name)
    if stages is not None and stages.left_out and (record is None or record.used):
        start = _tr("{0}, left out by hand").format(start)
    if record is not None and record.used:
        return _tr(
            "{0}: {1} points, median σ {2}; {3} crossings with {4} fan lines, {5} with other sweeps, {6} left out."
        ).format(
            start, count(record.points), mm(record.sigma_mm), record.fan_crossings, record.fan_lines_met,
            record.sweep_crossings, record.left_out,
        )  # fmt: skip
    if record is not None:
        return _tr("{0}: no points; {1}.").format(start, record.reason)
    if stages is not None and stages.reason:
        return _tr("{0}: {1}.").format(start, stages.reason)
    if stages is not None and stages.seen is not None:
        return _tr("{0}: {1} crossings by itself; not measured yet.").format(start, len(stages.seen.crossing_uv))
    return _tr("{0}: not measured yet.").format(start)


def covered_sentence(share: float) -> str:
    """How much of the surface there is."""
    return _tr("covered {0} of what was lit").format(percent(share))


def condition_text(condition: float) -> str:
    """The condition of a frame's crossings."""
    if math.isinf(condition):
        return _tr("∞")
    if condition < 10_000:
        return f"{condition:.0f}"
    exponent = math.floor(math.log10(condition))
    return f"{condition / 10**exponent:.0f}·10" + str(exponent).translate(_RAISED)


def speed_text(speed_px: float) -> str:
    """How far the stripe moves from frame to frame."""
    return "" if math.isnan(speed_px) else _tr("{0} px/frame").format(f"{speed_px:.0f}")


def sentence(reason: str) -> str:
    """A reason as it stands by itself."""
    return reason[:1].upper() + reason[1:]


def count(number: int) -> str:
    """A count with thin spaces between thousands."""
    return f"{number:,}".replace(",", "\u2009")


def percent(share: float) -> str:
    """A share of one."""
    return f"{100 * share:.0f} %"


def mm(value: float) -> str:
    """A length in millimetres."""
    return "–" if math.isnan(value) else f"{value:.3f} mm"


def _tr(text: str) -> str:
    return QCoreApplication.translate("Scan", text)
