"""How well the poses of the plane target foretell each other: each is left out once.

The residuals of a fit flatter it, for every pose has its say in the planes. Planes from all the other poses know
nothing of the one left out: how far its stripes, on the target where its own points put it, are off them is an error
as a measurement makes it, with the error of that one pose added.

References
----------
Stone, M., J. Royal Statistical Society B 36 (1974) 111–147, doi:10.1111/j.2517-6161.1974.tb00994.x.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.calibrate import reprojection
from core.calibrate.board_shape import BoardShape
from core.calibrate.fan_bundle import Bundle, solve
from core.calibrate.fan_observations import BundlePose, Plate
from core.calibrate.stripe_distances import BOWS, Stripes
from core.model import Camera, Pose
from core.model.arrays import Array

FEWEST = 4
"""Poses; with fewer, those that are left say too little of a plane."""
ROUNDS = 2
"""Of new weights; they differ little from those of all poses."""
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
    for index, left_out in enumerate(poses):
        others = [pose for number, pose in enumerate(poses) if number != index]
        if len(others) + 1 >= FEWEST and _seen_twice(others, len(used.planes.pis)):
            fit = solve(used.planes, others, camera, plate=plate, rounds=ROUNDS)
            pose = _posed(left_out, fit.shape, camera)
            stripes = Stripes([left_out.stripes], [pose], None if plate is None else plate.board)
            distances = stripes.distances(fit.planes, [pose], np.zeros(10), fit.shape.values[:BOWS]).mm[:, :2]
            errors[index] = np.sqrt((distances**2).mean())
    return errors


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


def _seen_twice(poses: Sequence[BundlePose], lines: int) -> bool:
    return all(sum(line in pose.stripes for pose in poses) >= 2 for line in range(lines))
