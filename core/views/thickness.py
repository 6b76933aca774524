"""Thickness of a part from a face of one view to a face of another."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.inspect.faces import FacePair
from core.inspect.fit.plane_search import find_planes
from core.inspect.gauge import measure_gauge
from core.inspect.results import GaugeResult
from core.messages import Message
from core.progress import Progress, silent
from core.views.joined_cloud import JoinedCloud
from core.views.joint import Joint

ABOVE_MM = 1.0
"""A face of the part stands at least so far above its carrier."""
TILT = np.cos(np.radians(20.0))
"""Of the angle between a face of the part and the carrier, at most."""


def upper_face(joined: JoinedCloud, view: int, progress: Progress = silent) -> NDArray[np.int64]:
    """Find the part's face that a view shows, the largest plane above its carrier: indices into the joined cloud.

    Raises
    ------
    InputError
        If the view shows none.
    """
    mine = np.flatnonzero(joined.cloud.view == view)
    cloud = joined.errors.views[view].own(joined.cloud.select(mine))
    pose = joined.joint.poses[view]
    side = -np.sign(pose.rotation[2, 2])
    to_carrier, up = pose.inverse(), pose.rotation[:, 2] * side
    marks = float(joined.joint.carrier.positions[joined.joint.carrier.on(int(side < 0)), 2].mean()) * side
    for plane in find_planes(cloud, progress=progress):
        indices = plane.region.indices
        height = float(np.median(to_carrier.apply(cloud.points[indices])[:, 2])) * side
        if abs(plane.normal @ up) > TILT and height > marks + ABOVE_MM:
            return np.asarray(mine[indices], dtype=np.int64)
    raise InputError(
        Message("views.no_face", "no plane face of the part is seen above the carrier"),
        where=joined.joint.views[view],
        todo=Message("views.advice_face", "scan the face with more sweeps"),
    )


def require_turned(joint: Joint) -> None:
    """Raise InputError if the first and the last view show the same side of the carrier."""
    sides = [bool(pose.rotation[2, 2] < 0) for pose in (joint.poses[0], joint.poses[-1])]
    if sides[0] == sides[1]:
        raise InputError(
            Message("views.same_side", "it shows side {side} of the carrier, as the first view does: no thickness lies "
                    "between the two", side="A" if sides[1] else "B"),
            where=joint.views[-1],
            todo=Message("views.advice_turn_over", "turn the part over with its carrier, and take the view again"),
        )  # fmt: skip


def faces_across(joined: JoinedCloud, progress: Progress = silent) -> FacePair:
    """Find the largest plane above the carrier in the first and in the last view; InputError if one shows none."""
    return FacePair(upper_face(joined, 0, progress), upper_face(joined, len(joined.joint.views) - 1, progress))


def thickness_across(
    joined: JoinedCloud,
    *,
    faces: FacePair | None = None,
    nominal_mm: float | None = None,
    tolerance_mm: float | None = None,
    progress: Progress = silent,
) -> GaugeResult:
    """Measure the thickness from the face that the first view shows to that of the last one, turned over.

    Parameters
    ----------
    joined
        The views in one frame.
    faces
        The points of both faces; None: the largest plane above the carrier in the first and in the last view.
    nominal_mm, tolerance_mm
        What the part should be, ±; without both of them there is no verdict.
    progress
        Called with how far it is.

    Raises
    ------
    InputError
        If a face is not found, or the first view's lies behind the other's.
    """
    return measure_gauge(
        joined.cloud,
        errors=joined.errors,
        regions=faces or faces_across(joined, progress),
        nominal_mm=nominal_mm,
        tolerance_mm=tolerance_mm,
        progress=progress,
    )
