"""What became of each frame of a scan, and why."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from core.model import Camera
from core.scan.cloud import Cloud
from core.scan.crossings import CrossingTable, Index
from core.scan.features import ScanFeatures
from core.scan.frame_record import FrameRecord
from core.scan.left_out import MOVED, REASONS
from core.scan.sweep_plane import plane_condition

MOVED_FRAME = "object or camera moved between this frame and those that are used"


def frame_records(
    features: ScanFeatures,
    crossings: CrossingTable,
    line: Index,
    reasons: Index,
    solved: Index,
    cloud: Cloud,
    camera: Camera,
) -> tuple[FrameRecord, ...]:
    """One record a frame; `line` and `reasons` (M,) of each crossing, `solved` the frames with a light plane."""
    rays = camera.rays(crossings.uv)
    count: Callable[[NDArray[np.bool_]], int] = np.count_nonzero
    records = []
    for frame in features.frames:
        mine = (crossings.a == frame.index) | (crossings.b == frame.index)
        with_fan = mine & crossings.with_fan
        points = cloud.frame == frame.index
        number = count(points)
        why = Counter(reasons[mine & (reasons > 0)].tolist())
        records.append(
            FrameRecord(
                index=frame.index,
                name=frame.name,
                used=number > 0,
                reason="" if number else frame.reason or _why_no_points(reasons[mine], frame.index in solved),
                stripes=len(frame.centrelines),
                stripe_px=sum(len(piece) for piece in frame.centrelines),
                fan_crossings=count(with_fan),
                fan_lines_met=len(np.unique(line[with_fan])),
                sweep_crossings=count(mine & ~crossings.with_fan),
                left_out=sum(why.values()),
                condition=plane_condition(rays[with_fan]),
                points=number,
                sigma_mm=float(np.median(cloud.sigma[points])) if number else float("nan"),
                left_out_reasons=tuple((REASONS[reason], why[reason]) for reason in sorted(why)),
            )
        )
    return tuple(records)


def _why_no_points(reasons: Index, solved: bool) -> str:
    if not len(reasons):
        return "its stripe crosses neither the fan nor another sweep"
    if not solved:
        return MOVED_FRAME if np.any(reasons == MOVED) else "fewer than three crossings with the fan"
    return "its light plane is too uncertain for any point to pass the σ cut"
