"""Sizes of two targets against each other, from pictures that show both, fixed to each other, at once.

No picture tells how large a target is, but two in one picture must agree: with the size stated for one, the other
stands where it does only with its true size. All pictures are adjusted together: the pose of the first target in each,
where the second one is on it, the same in all, and its size over the one stated, the first one's taken as true.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.special import chdtrc, ndtr

from core.calibrate.camera.reprojection import moved
from core.findings.table import note_of
from core.image.targets import estimate_pose
from core.image.targets.target_view import TargetView
from core.messages import Message
from core.model import Camera
from core.model.arrays import Array

P_TOLD = 0.01
"""Sizes as far apart by chance alone are told of with a smaller probability."""
NOT_FIXED = 0.001
"""Targets that are not fixed to each other by a larger probability than that say nothing."""
_POSE = 6
"""Unknowns of a pose: a rotation vector and a translation."""


@dataclass(frozen=True, slots=True)
class TargetRatio:
    """Ratio of the size of the second target to the first, over the stated ratio.

    Parameters
    ----------
    ratio, u
        1 where both sizes are stated truly against each other; its standard uncertainty by the pictures.
    pictures
        How many show both.
    fit_p
        Probability that noise alone makes them fit one place of the second on the first as badly: fixed to each other?
    """

    ratio: float
    u: float
    pictures: int
    fit_p: float

    def p(self, scale_sd: float) -> float:
        """Compute the probability that the ratio is by chance as far from 1, sizes stated within `scale_sd`."""
        return float(2 * ndtr(-abs(self.ratio - 1) / np.hypot(self.u, scale_sd)))

    def note(self, scale_sd: float, other: Message) -> Message:
        """Note whether the targets' size ratio agrees with that stated; `other` names the target compared with."""
        if self.fit_p < NOT_FIXED:
            return note_of("target.not_fixed", n=self.pictures, other=other, p=self.fit_p)
        if self.p(scale_sd) >= P_TOLD:
            return note_of(
                "target.sizes_agree", other=other, percent=100 * (self.ratio - 1), U=200 * self.u, n=self.pictures
            )
        return note_of(
            "target.sizes_disagree",
            other=other,
            percent=100 * (self.ratio - 1),
            U=200 * self.u,
            n=self.pictures,
            p=self.p(scale_sd),
        )


def target_ratio(shown: Sequence[tuple[TargetView, TargetView]], camera: Camera) -> TargetRatio:
    """Compute the ratio of the sizes of two targets, measured over stated, from N ≥ 1 pictures that show both.

    With several the plate is to be tilted or moved between them.

    Raises
    ------
    TargetNotFound
        If a target has no pose before the camera.
    """
    first = [estimate_pose(one, camera).pose for one, _ in shown]
    second = estimate_pose(shown[0][1], camera).pose
    beside = first[0].inverse() @ second

    def residuals(x: Array) -> Array:
        size, on_first = 1 + x[0], moved(beside, x[1 : 1 + _POSE])
        rows = []
        for number, (one, other) in enumerate(shown):
            at = 1 + _POSE * (number + 1)
            pose = moved(first[number], x[at : at + _POSE])
            there = pose @ on_first
            rows += [
                one.whitened(camera.project_pose(pose, one.points) - one.uv),
                other.whitened(camera.project_pose(there, size * other.points) - other.uv),
            ]
        return np.concatenate(rows)

    solution = least_squares(residuals, np.zeros(1 + _POSE * (len(shown) + 1)), x_scale="jac", method="lm")
    values, vectors = np.linalg.svd(np.asarray(solution.jac), full_matrices=False)[1:]
    covariance = (vectors.T / values**2) @ vectors
    freedom = len(solution.fun) - len(solution.x)
    squares = float(solution.fun @ solution.fun)
    worse = max(1.0, squares / freedom) if freedom > 0 else 1.0
    p = float(chdtrc(freedom, squares)) if freedom > 0 else 1.0
    return TargetRatio(1 + float(solution.x[0]), float(np.sqrt(worse * covariance[0, 0])), len(shown), p)
