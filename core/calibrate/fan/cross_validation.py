"""How well the poses of the plane target foretell each other: each is left out once.

The residuals of a fit flatter it, for every pose has its say in the planes. Planes from all the other poses know
nothing of the one left out: how far its stripes, on the target where its own points put it, are off them is an error
as a measurement makes it, with the error of that one pose added. The planes without a pose come from the fit of all
by one Gauss–Newton step, trust and weights unchanged; fits anew give the same to a few per cent.

A pose is told where the others foretell it surely worse than it may be. How far that is differs: where a pose lies
beyond all others they say little of it, and a small target far away says little of where it is. The covariance is that
of the planes by the others, that of the pose by its own points, and that of its stripes; the three are independent. A
pose that is wrong makes all that is taken from residuals too large: so all is solved without it.

References
----------
Stone, M., J. Royal Statistical Society B 36 (1974) 111–147, doi:10.1111/j.2517-6161.1974.tb00994.x.
Cook, R. D. & Weisberg, S., Residuals and Influence in Regression (1982), 2.2 (externally studentized residuals).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import fdtrc

from core.calibrate.board_shape import BoardShape
from core.calibrate.camera import reprojection
from core.calibrate.fan.bundle import Bundle, solve
from core.calibrate.fan.observations import BundlePose, Plate
from core.calibrate.fan.pencil import PlaneSet
from core.calibrate.fan.pose_equations import inverse
from core.calibrate.fan.stripe_distances import BOWS, Distances, Stripes
from core.model import Camera, Pose
from core.model.arrays import Array

FEWEST = 4
"""Poses; with fewer, those that are left say too little of a plane."""
POSE_STEPS = 3
"""Of Gauss and Newton from the pose of a flat target to that of a bowed one."""
POORLY_PREDICTED = 4.0
"""A pose that the others predict this many times worse than the median pose is worth a note, if that is no chance."""
WORTH_A_NOTE_MM = 0.05
"""Errors of prediction below this are not noted."""
SURELY = 1e-3
"""Probability below which it is no chance that one of a fan's poses is predicted so badly."""
STEP_MM = 0.01
"""Of a plate's bow, to see how a pose's stripes follow it."""


@dataclass(frozen=True, eq=False, slots=True)
class Predictions:
    """Errors of the prediction of each of P poses by the other poses.

    Parameters
    ----------
    error_mm
        (P,) RMS distance of its stripes from the light planes that the others give. NaN for a pose without which a line
        is seen on fewer than two poses, and for all with fewer than four poses.
    poor
        Which poses are surely foretold worse than they may be.
    """

    error_mm: Array
    poor: tuple[int, ...]

    @property
    def usual_mm(self) -> float:
        """Median over the poses, in mm, of the error of the stripes that the other poses predict."""
        return float(np.nanmedian(self.error_mm))


def predict(used: Bundle, poses: Sequence[BundlePose], camera: Camera, plate: Plate | None = None) -> Predictions:
    """Compute for each pose how far its stripes lie from light planes fitted to all other poses.

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
        off = _distances(
            left_out, used.planes.moved(step[:unknowns]), _bent(used.shape, step[unknowns:]), camera, plate
        )[1]
        errors[index] = np.sqrt((off.mm[:, :2] ** 2).mean())
    known = np.flatnonzero(np.isfinite(errors))
    if not len(known):
        return Predictions(errors, ())
    suspect = known[errors[known] > max(POORLY_PREDICTED * np.median(errors[known]), WORTH_A_NOTE_MM)]
    surely = SURELY / len(known)  # of so many poses one is the worst (Bonferroni)
    return Predictions(errors, tuple(int(k) for k in suspect if _chance(used, int(k), poses, camera, plate) < surely))


def _chance(used: Bundle, index: int, poses: Sequence[BundlePose], camera: Camera, plate: Plate | None) -> float:
    """Probability that a pose with nothing wrong is off the planes of the others as far as that one."""
    left_out = poses[index]
    others = solve(used.planes, [*poses[:index], *poses[index + 1 :]], camera, plate=plate)
    if not others.converged:
        return 1.0  # planes that are no best ones prove nothing against a pose
    (pose, of_pose), here = _distances(left_out, others.planes, others.shape, camera, plate)
    off = here.mm[:, :2]
    bows = len(others.joint) - others.planes.jacobian.shape[1]
    bent = (
        _distances(left_out, others.planes, _bent(others.shape, STEP_MM * bow), camera, plate)[1]
        for bow in np.eye(bows)
    )
    by_bow = [(one.mm[:, :2] - off).ravel() / STEP_MM for one in bent]
    by_common = np.column_stack([here.by_planes[:, :2].reshape(off.size, -1), *by_bow])
    by_pose = others.corner_scale * here.by_pose[:, :2].reshape(off.size, -1)
    own = np.hypot(_stripes(left_out, plate).noise_mm(others.planes, [pose])[:, None], others.extra[:2])
    expected = by_common @ others.joint @ by_common.T + by_pose @ of_pose @ by_pose.T + np.diag(own.ravel() ** 2)
    squares = float(off.ravel() @ np.linalg.solve(expected, off.ravel()))
    return float(fdtrc(off.size, max(others.freedom, 1.0), squares / off.size))


def _stripes(pose: BundlePose, plate: Plate | None) -> Stripes:
    return Stripes([pose.stripes], [pose.pose], None if plate is None else plate.board)


def _distances(
    seen: BundlePose, planes: PlaneSet, shape: BoardShape, camera: Camera, plate: Plate | None
) -> tuple[tuple[Pose, Array], Distances]:
    """Where a target of this `shape` is by its points, with covariance, and how far its stripes are off `planes`."""
    placed = _posed(seen, shape, camera)
    return placed, _stripes(seen, plate).distances(planes, [placed[0]], np.zeros(10), shape.values[:BOWS])


def _bent(shape: BoardShape, bow: Array) -> BoardShape:
    """`shape` with `bow` (3 or 0,) in mm added."""
    values = shape.values.copy()
    values[: len(bow)] += bow
    return replace(shape, values=values)


def _posed(seen: BundlePose, shape: BoardShape, camera: Camera) -> tuple[Pose, Array]:
    """Where a target of this `shape` is by its own points, and its covariance (6, 6) as these state it."""
    pose, view = seen.pose, seen.view
    for _ in range(POSE_STEPS if shape.values.any() else 1):
        uv, _, by_pose = reprojection.linearise(camera, pose, shape.shaped(view.points))
        rows = view.whitened(by_pose)
        covariance = inverse(rows.T @ rows)
        if shape.values.any():
            pose = reprojection.moved(pose, covariance @ (rows.T @ view.whitened(view.uv - uv)))
    return pose, covariance
