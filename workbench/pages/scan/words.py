"""What the scan page says of frames, runs and results."""

from __future__ import annotations

import math

from core.messages import Message, capital
from core.scan.features.frames import NO_REASON, FrameRecord
from core.scan.preview.shown import FrameStages, ShownScan
from workbench.language import named, sentence, text_of, tr
from workbench.pages.words import count, mm, percent
from workbench.views.lists.value_rows import ValueRow


def quality_rows(look: ShownScan | None) -> list[ValueRow]:
    """How good the result is: label, value with unit, tip, level."""
    if look is None:
        return []
    return [
        (tr("Points"), count(len(look)), tr("Measured points, each with its own σ"), ""),
        (tr("Triangles"), count(look.triangles), tr("Of the mesh made from the points"), ""),
        (
            tr("Frames used"),
            tr("{used} of {total}", used=look.frames_used, total=len(look.frames)),
            tr("Frames that gave points, and all there are"),
            "",
        ),
        (
            tr("Median σ"),
            mm(look.median_sigma_mm),
            tr("Half of the points have a smaller standard uncertainty of depth; without what is common to the scan"),
            "",
        ),
        (tr("95 % of σ"), mm(look.sigma_95_mm), tr("95 % of the points have a smaller σ"), ""),
        (
            tr("Covered"),
            tr("{share} of what was lit", share=percent(look.share)),
            tr("Share of the picture between all laser light in which there are points"),
            "",
        ),
    ]


def reason_rows(look: ShownScan | None) -> list[ValueRow]:
    """Why frames gave no points, and how many."""
    if look is None:
        return []
    return [
        (capital(text_of(reason)), str(frames), tr("Frames left out for this reason"), "")
        for reason, frames in look.left_out
    ]


def frame_line(record: FrameRecord | None, seen: tuple[int, Message | None] | None, *, marked: bool = False) -> str:
    """The second line of a frame in the list; `seen`: points in the preview, and why there are none."""
    return " · ".join(filter(None, (tr("marked") if marked else "", _what_became(record, seen))))


def _what_became(record: FrameRecord | None, seen: tuple[int, Message | None] | None) -> str:
    if record is not None:
        if not record.used:
            return text_of(record.reason or NO_REASON)
        return tr("{count} points", count=count(record.points))
    if seen is not None:
        points, reason = seen
        return text_of(reason) if reason else tr("{count} points in the preview", count=count(points))
    return ""


def frame_sentence(place: int, total: int, name: str, record: FrameRecord | None, stages: FrameStages | None) -> str:
    """What is to be said of one frame."""
    start = tr("Frame {number} of {total} ({name})", number=place + 1, total=total, name=name)
    if stages is not None and stages.left_out and (record is None or record.used):
        start = tr("{frame}, left out by hand", frame=start)
    if record is not None and record.used:
        return tr(
            "{frame}: {points} points, median σ {sigma}; {crossings} crossings with {lines} fan lines, {sweeps} with "
            "other sweeps, {left_out} left out.",
            frame=start,
            points=count(record.points),
            sigma=mm(record.sigma_mm),
            crossings=record.fan_crossings,
            lines=record.fan_lines_met,
            sweeps=record.sweep_crossings,
            left_out=record.left_out,
        )
    if record is not None:
        return tr("{frame}: no points; {reason}.", frame=start, reason=text_of(record.reason or NO_REASON))
    if stages is not None and stages.reason:
        return named(start, sentence(text_of(stages.reason)))
    if stages is not None and stages.seen is not None:
        return tr(
            "{frame}: {count} crossings by itself; not measured yet.", frame=start, count=len(stages.seen.crossing_uv)
        )
    return tr("{frame}: not measured yet.", frame=start)


def covered_sentence(share: float) -> str:
    """How much of the surface there is."""
    return tr("covered {share} of what was lit", share=percent(share))


def speed_text(speed_px: float) -> str:
    """How far the stripe moves from frame to frame."""
    return "" if math.isnan(speed_px) else tr("{speed:.0f} px/frame", speed=speed_px)
