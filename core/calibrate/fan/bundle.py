"""The fan's planes and the target's poses solved together, with the camera known or corrected along with them.

How much to trust each observation (`core.calibrate.fan_observations`) is taken from the data: target points get a
common factor on their stated uncertainty, stripes an additional standard deviation in mm for their offset and another
for their slope (a plate not quite flat, a lens not quite modelled), all such that residuals are as large as they should
be.

References
----------
Förstner, W., Ein Verfahren zur Schätzung von Varianz- und Kovarianzkomponenten, AVN 86 (1979) 446.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from core.calibrate.board_shape import BoardShape
from core.calibrate.fan_observations import PARAMETERS, BundlePose, Observations, Plate, State, Trust
from core.calibrate.levenberg import Solution, minimise
from core.calibrate.pencil import PlaneSet, huber_weights
from core.model import Camera, Pose
from core.model.arrays import Array

PRIOR_FREEDOM = 6.0
"""Belief in the stated uncertainties, counted in residuals: few residuals cannot overthrow them."""
ROUNDS = 12
CORNER_SCALE_RANGE = (0.3, 30.0)


@dataclass(frozen=True, eq=False, slots=True)
class Bundle:
    """The solution.

    Parameters
    ----------
    planes
        The light planes.
    covariance
        (3N, 3N) of the stacked π in 1/mm², the camera taken as known.
    by_camera
        (3N, 10) how the stacked π follow a change of the camera's parameters, the pictures the same.
    camera
        The camera: as given, or corrected.
    camera_covariance
        (10, 10) of the corrected camera; None where it was given.
    poses
        The poses, improved.
    shape
        Of the plate; flat where it was said to be.
    freedom
        Redundancy of the stripes' residuals (a real number).
    corner_scale
        Factor on the stated uncertainty of the target's points.
    extra_mm
        Standard deviation in mm of a stripe's offset beyond its own noise.
    pose_errors
        For each pose (P,), RMS of the residuals of its stripes or, if that is larger, of its target points, in
        standard deviations.
    """

    planes: PlaneSet
    covariance: Array
    by_camera: Array
    camera: Camera
    camera_covariance: Array | None
    poses: tuple[Pose, ...]
    shape: BoardShape
    freedom: float
    corner_scale: float
    extra_mm: float
    pose_errors: Array


def solve(
    planes: PlaneSet,
    poses: Sequence[BundlePose],
    camera: Camera,
    camera_covariance: Array | None = None,
    *,
    plate: Plate | None = None,
    rounds: int = ROUNDS,
) -> Bundle:
    """Solve planes and poses together, from `planes` near the answer, robustly (Huber per stripe).

    Parameters
    ----------
    planes, poses
        Where to start, and what was seen.
    camera
        The calibrated camera, with which the stripes were found.
    camera_covariance
        (10, 10) of its parameters: then the camera is corrected, too. None: it stays as it is.
    plate
        None: the target is flat.
    rounds
        How often the standard deviations are improved, at most.
    """
    seen = Observations(poses, camera, camera_covariance, plate)
    state = State(planes, tuple(pose.pose for pose in poses), np.zeros(seen.bows), np.zeros(PARAMETERS))
    trust = _at_first(seen, state)
    solution = minimise(state, partial(seen.linearise, trust=trust), seen.move)
    for _ in range(rounds):
        before, trust = trust, _improved(trust, seen, solution)
        solution = minimise(solution.state, partial(seen.linearise, trust=trust), seen.move)
        if _settled(before, trust):
            break
    return _result(seen, solution, trust)


def _at_first(seen: Observations, state: State) -> Trust:
    count = len(seen.stripes)
    extra = np.median(np.abs(seen.distances(state).mm), axis=0)
    return Trust(1.0, seen.stripes.noise_mm(state.planes, state.poses), extra, np.ones(count))


def _improved(trust: Trust, seen: Observations, solution: Solution[State]) -> Trust:
    """The standard deviations and the stripes' weights again, from residuals and redundancies."""
    share = ((solution.jacobian @ solution.covariance) * solution.jacobian).sum(axis=1)
    first = len(seen.free) + seen.bows
    end = first + seen.corners
    of_corners = slice(first, end)
    corner = _variance_factor(solution.residuals[of_corners], share[of_corners])
    scale = float(np.clip(trust.corner_scale * np.sqrt(corner), *CORNER_SCALE_RANGE))
    own = float(np.median(trust.noise) ** 2)
    extra = trust.extra.copy()
    for part in range(seen.stripes.parts):
        rows = slice(end + part, None, seen.stripes.parts)
        factor = _variance_factor(solution.residuals[rows], share[rows])
        extra[part] = np.sqrt(max(factor * extra[part] ** 2 + (factor - 1) * own, 0.0))
    trust = replace(trust, corner_scale=scale, extra=extra)
    return replace(trust, weight=huber_weights(_errors(seen, solution.state, trust)))


def _settled(before: Trust, after: Trust) -> bool:
    old, new = (np.array([trust.corner_scale, *trust.extra]) for trust in (before, after))
    return bool(np.all(np.abs(new - old) < 0.02 * old + 1e-6))


def _errors(seen: Observations, state: State, trust: Trust) -> Array:
    """RMS (S,) of each stripe's residuals in their standard deviations."""
    distances = seen.distances(state).mm / trust.sd
    return np.asarray(np.sqrt((distances**2).mean(axis=1)), dtype=np.float64)


def _result(seen: Observations, solution: Solution[State], trust: Trust) -> Bundle:
    state = solution.state
    unknowns = state.planes.jacobian.shape[1]
    residuals, jacobian = seen.observed(state, trust)
    alone, by_camera = jacobian[:, :-PARAMETERS], jacobian[:, -PARAMETERS:]
    local = Solution(state, residuals, alone, solution.converged).covariance
    stripes = alone[-seen.stripes.parts * len(seen.stripes) :]
    to_pis = state.planes.jacobian
    corrected = None
    if len(seen.free):
        corrected = np.zeros((PARAMETERS, PARAMETERS))
        last = len(seen.free)
        corrected[np.ix_(seen.free, seen.free)] = solution.covariance[-last:, -last:]
    return Bundle(
        planes=state.planes,
        covariance=to_pis @ local[:unknowns, :unknowns] @ to_pis.T,
        by_camera=-to_pis @ (local[:unknowns] @ (alone.T @ by_camera)),
        camera=seen.camera(state),
        camera_covariance=corrected,
        poses=state.poses,
        shape=seen.shape(state.bow, local[len(local) - seen.bows :, len(local) - seen.bows :]),
        freedom=len(stripes) - float(((stripes @ local) * stripes).sum()),
        corner_scale=trust.corner_scale,
        extra_mm=float(trust.extra[0] / np.sqrt(2)),
        pose_errors=_pose_errors(seen, residuals, _errors(seen, state, trust)),
    )


def _pose_errors(seen: Observations, residuals: Array, of_stripes: Array) -> Array:
    """(P,) RMS of each pose's stripes or, if larger, of its target points, in standard deviations."""
    count, pose_of = len(seen.known), seen.stripes.pose_of
    summed = np.bincount(pose_of, of_stripes**2, minlength=count)
    stripes = summed / np.maximum(np.bincount(pose_of, minlength=count), 1)
    of_corners = residuals[seen.bows : seen.bows + seen.corners]
    corners = [float((of_corners[rows] ** 2).mean()) for rows in seen.rows]
    return np.asarray(np.sqrt(np.maximum(stripes, corners)), dtype=np.float64)


def _variance_factor(residuals: Array, share: Array) -> float:
    """Sum of squares over redundancy, held to 1 by PRIOR_FREEDOM further residuals of expected size."""
    freedom = max(len(residuals) - float(share.sum()), 0.0)
    return (float(residuals @ residuals) + PRIOR_FREEDOM) / (freedom + PRIOR_FREEDOM)
