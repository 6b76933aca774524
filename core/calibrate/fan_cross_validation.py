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

from core.calibrate.fan_bundle import Bundle, BundlePose, solve
from core.calibrate.stripe_distances import Stripes
from core.model import Camera
from core.model.arrays import Array

FEWEST = 4
"""Poses; with fewer, those that are left say too little of a plane."""
ROUNDS = 2
"""Of new weights; they differ little from those of all poses."""


def prediction_errors(used: Bundle, poses: Sequence[BundlePose], camera: Camera) -> Array:
    """RMS distance (P,) in mm of each pose's stripes from the light planes that the other poses give.

    NaN for a pose without which a line is seen on fewer than two poses, and for all with fewer than four poses.

    Parameters
    ----------
    used
        The fit of all `poses`; the planes are fitted under the same constraint.
    poses
        Each where its own points put it.
    """
    errors = np.full(len(poses), np.nan)
    for index, left_out in enumerate(poses):
        others = [pose for number, pose in enumerate(poses) if number != index]
        if len(others) + 1 >= FEWEST and _seen_twice(others, len(used.planes.pis)):
            planes = solve(used.planes, others, camera, rounds=ROUNDS).planes
            distances = Stripes([left_out.stripes]).distances(planes, [left_out.pose], np.zeros(10)).mm
            errors[index] = np.sqrt((distances**2).mean())
    return errors


def _seen_twice(poses: Sequence[BundlePose], lines: int) -> bool:
    return all(sum(line in pose.stripes for pose in poses) >= 2 for line in range(lines))
