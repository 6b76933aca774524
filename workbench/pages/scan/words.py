"""What the scan page says of frames, runs and results."""

from __future__ import annotations

import math

import numpy as np

from core.messages import Message, label
from core.report.facts.fact import Fact
from core.report.facts.of_scan import scan_facts
from core.scan.features.frames import NO_REASON, FrameRecord
from core.scan.preview.shown import FrameStages, ShownScan
from workbench.language import named, sentence, text_of, tr
from workbench.pages.words import count, percent, sigma

NO_LIVE_SCAN = label(
    "There is neither a fan nor a board that is stated: state boards in rig.toml ([known_planes]), or choose the "
    "folder of a recording with them."
)
"""What to do where nothing is stated by which a sweep could be located."""
SWEEP_BEFORE_BOARDS = label("Sweep the part before its boards with a live source, or choose the folder of a recording.")
"""How to begin where boards stand in for a fan."""


def facts(look: ShownScan | None) -> tuple[Fact, ...]:
    """Make the facts (name, value, unit) on the measured scan; () without one."""
    if look is None:
        return ()
    extent = np.ptp(look.points, axis=0) if len(look) else None
    sigma = (look.median_sigma_mm, look.sigma_95_mm) if len(look) else None
    return scan_facts(look.frames, len(look), look.triangles, sigma, look.share, extent)


def frame_line(record: FrameRecord | None, seen: tuple[int, Message | None] | None, *, marked: bool = False) -> str:
    """Write the line below a frame's name in the list: its points, or why it has none, and whether it is marked."""
    return " · ".join(filter(None, (tr("marked") if marked else "", _what_became(record, seen))))


def _what_became(record: FrameRecord | None, seen: tuple[int, Message | None] | None) -> str:
    if record is not None:
        if not record.used:
            return text_of(record.reason or NO_REASON)
        return tr("{count} points", count=count(record.points))
    if seen is not None:
        points, reason = seen
        if reason:
            return text_of(reason)
        if points:
            return tr("{count} points in the preview", count=count(points))
    return ""


def frame_sentence(
    place: int, total: int, name: str, record: FrameRecord | None, stages: FrameStages | None, *, has_fan: bool = True
) -> str:
    """Write the sentence on the current frame: its number, its points, or why it gives none."""
    start = tr("Frame {number} of {total} ({name})", number=place + 1, total=total, name=name)
    if stages is not None and stages.left_out and (record is None or record.used):
        start = tr("{frame}, left out by hand", frame=start)
    if record is not None and record.used and not has_fan:
        return tr(
            "{frame}: {points} points, median σ {sigma}; {sweeps} crossings with other sweeps, {left_out} left out.",
            frame=start,
            points=count(record.points),
            sigma=sigma(record.sigma_mm),
            sweeps=record.sweep_crossings,
            left_out=record.left_out,
        )
    if record is not None and record.used:
        return tr(
            "{frame}: {points} points, median σ {sigma}; {crossings} crossings with {lines} fan lines, {sweeps} with "
            "other sweeps, {left_out} left out.",
            frame=start,
            points=count(record.points),
            sigma=sigma(record.sigma_mm),
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
    """Write which share of the lit surface is covered by points, in percent."""
    return tr("covered {share} of what was lit", share=percent(share))


def speed_text(speed_px: float) -> str:
    """Write how many pixels the stripe moves from frame to frame."""
    return "" if math.isnan(speed_px) else tr("{speed:.0f} px/frame", speed=speed_px)
