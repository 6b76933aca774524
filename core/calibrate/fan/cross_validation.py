"""How well the poses of the plane target foretell each other: each is left out once.

The residuals of a fit flatter it, for every pose has its say in the planes. Planes from all the other poses know
nothing of the one left out: how far its stripes, on the target where its own points put it, are off them is an error
as a measurement makes it, with the error of that one pose added. The planes without a pose come from the fit of all
by one Gauss–Newton step, trust and weights unchanged; fits anew give the same to a few per cent.

References
----------
Stone, M., J. Royal Statistical Society B 36 (1974) 111–147, doi:10.1111/j.2517-6161.1974.tb00994.x.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from core.calibrate.board_shape import BoardShape
from core.calibrate.camera import reprojection
from core.calibrate.fan.bundle import Bundle
from core.calibrate.fan.observations import BundlePose, Plate
from core.calibrate.fan.stripe_distances import BOWS, Stripes
from core.model import Camera, Pose
from core.model.arrays import Array

FEWEST = 4
"""Poses; with fewer, those that are left say too little of a plane."""
POSE_STEPS = 3
"""Of Gauss and Newton from the pose of a flat target to that of a bowed one."""


def prediction_errors(used: Bundle, poses: Sequence[BundlePose], camera: Camera, plate: Plate | None = None) -> Array:
    """RMS distance (P,) in mm of each pose's stripes from the light planes that the other poses give.

    NaN for a pose without which a line is seen on fewer than two poses, and for all with fewer than four poses.

    Parameters
    ----------
    used
        The fit of all `poses`; the planes are fitted under the same constraint.
    poses
        Each where its own points put it.
    plate
        As of the fit.
    """
    errors = np.full(len(poses), np.nan)
    unknowns = used.planes.jacobian.shape[1]
    seen = np.array([[line in pose.stripes for line in range(len(used.planes.pis))] for pose in poses])
    for index, left_out in enumerate(poses):
        if len(poses) < FEWEST or (seen.sum(axis=0) - seen[index]).min() < 2:
            continue
        step = used.without_each[index]
        planes, shape = used.planes.moved(step[:unknowns]), _bent(used.shape, step[unknowns:])
        pose = _posed(left_out, shape, camera)
        stripes = Stripes([left_out.stripes], [pose], None if plate is None else plate.board)
        distances = stripes.distances(planes, [pose], np.zeros(10), shape.values[:BOWS]).mm[:, :2]
        errors[index] = np.sqrt((distances**2).mean())
    return errors


def _bent(shape: BoardShape, bow: Array) -> BoardShape:
    """`shape` with `bow` (3 or 0,) in mm added."""
    values = shape.values.copy()
    values[: len(bow)] += bow
    return replace(shape, values=values)


def _posed(seen: BundlePose, shape: BoardShape, camera: Camera) -> Pose:
    """Where a target of this `shape` is by its own points."""
    pose, view = seen.pose, seen.view
    if not shape.values.any():
        return pose
    for _ in range(POSE_STEPS):
        uv, _, by_pose = reprojection.linearise(camera, pose, shape.shaped(view.points))
        step = np.linalg.lstsq(view.whitened(by_pose), view.whitened(view.uv - uv), rcond=None)[0]
        pose = reprojection.moved(pose, np.asarray(step, dtype=np.float64))
    return pose
