"""Records of the frames of a scan and of their crossings: what was used, what was left out, and why."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from core.messages import Message
from core.model import Camera
from core.model.arrays import Array
from core.scan.features.crossings import CrossingTable, Index
from core.scan.features.extraction import ScanFeatures
from core.scan.features.frames import FEW_CROSSINGS, CrossingUse, FrameRecord
from core.scan.network.adjustment import SILENCED
from core.scan.network.sweep_plane import plane_condition
from core.scan.surface.cloud import Cloud

MOVED_FRAME = Message("scan.frame_moved_between", "object or camera moved between this frame and those that are used")


def frame_records(
    features: ScanFeatures,
    crossings: CrossingTable,
    line: Index,
    reasons: Index,
    solved: Index,
    cloud: Cloud,
    camera: Camera,
) -> tuple[FrameRecord, ...]:
    """Make the record of each frame: its stripe, crossings and points, and the reason if it gave no points.

    `line` and `reasons` (M,) are the fan's line of each crossing and whether it counts, `solved` the frames with a
    light plane.
    """
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
                reason=None if number else frame.reason or _why_no_points(reasons[mine], frame.index in solved),
                stripes=len(frame.centrelines),
                stripe_px=sum(len(piece) for piece in frame.centrelines),
                fan_crossings=count(with_fan),
                fan_lines_met=len(np.unique(line[with_fan])),
                sweep_crossings=count(mine & ~crossings.with_fan),
                left_out=sum(why.values()),
                condition=plane_condition(rays[with_fan]),
                points=number,
                sigma_mm=float(np.median(cloud.sigma[points])) if number else float("nan"),
                left_out_reasons=tuple((CrossingUse(reason), why[reason]) for reason in sorted(why)),
            )
        )
    return tuple(records)


def _why_no_points(reasons: Index, solved: bool) -> Message:
    reasons = reasons[reasons != CrossingUse.SECOND_BOUNCE]
    if not len(reasons):
        return Message("scan.frame_without_crossing", "its stripe crosses neither the fan nor another sweep")
    if not solved:
        if np.any(reasons == CrossingUse.MOVED):
            return MOVED_FRAME
        return FEW_CROSSINGS
    return Message("scan.frame_uncertain", "its light plane is too uncertain for any point to pass the σ cut")


def reasons_of(
    with_fan: NDArray[np.bool_], weights: Array, still: NDArray[np.bool_], located: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """Decide for each of M crossings whether it counts or why not, as `CrossingUse` values (M,).

    `weights` (M,) are the adjustment's; `still` (M,) is False for what a movement separates, `located` (M,) for frames
    without a plane.
    """
    disagrees = np.where(with_fan, CrossingUse.NOT_THE_FAN, CrossingUse.NOT_THE_SWEEPS)
    reasons = np.where(weights < SILENCED, disagrees, CrossingUse.COUNTS)
    reasons = np.where(located, reasons, CrossingUse.NOT_LOCATED)
    return np.where(still, reasons, CrossingUse.MOVED).astype(np.int64)
