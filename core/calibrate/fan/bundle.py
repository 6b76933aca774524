"""The fan's planes and the target's poses solved together, with the camera known or corrected along with them.

How much to trust each observation (`core.calibrate.fan.observations`) is taken from the data: target points get a
common factor on their stated uncertainty, stripes an additional standard deviation in mm for their offset and another
for their slope (a plate not quite flat, a lens not quite modelled), all such that residuals are as large as they should
be. Where poses disagree by more than noise (a curled sheet, a pose that is off), the stripes of one pose err together,
and more on some poses than on others: so the covariance is never less than what leaving out single poses moves the
planes by. Poses 0.02 mm from where their points say, less than the noise of a stripe, made errors 1.6 times σ without
that (tests/calibrate/fan/test_disagreeing_poses.py).

References
----------
Förstner, W., Ein Verfahren zur Schätzung von Varianz- und Kovarianzkomponenten, AVN 86 (1979) 446.
Efron, B., Bootstrap methods: another look at the jackknife, Ann. Statist. 7 (1979) 1–26, doi:10.1214/aos/1176344552.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeAlias

import numpy as np

from core.calibrate.board_shape import BoardShape
from core.calibrate.fan.observations import PARAMETERS, BundlePose, Observations, ObservationWeights, Plate, State
from core.calibrate.fan.pencil import PlaneSet
from core.calibrate.fan.pose_equations import PoseEquations, inverse
from core.calibrate.levenberg import Solution, minimise
from core.model import Camera, Pose
from core.model.arrays import Array
from core.model.robust import Schedule, Weigh, irls

PRIOR_FREEDOM = 6.0
"""Belief in the stated uncertainties, counted in residuals: few residuals cannot overthrow them."""
ROUNDS = 12
"""How often at most the standard deviations are improved and all is solved again; it mostly settles earlier."""
HUBER = 2.0
"""Stripes further than this many standard deviations from their plane lose weight."""
CORNER_SCALE_RANGE = (0.3, 30.0)
"""How far the stated σ of the target's corners may be scaled down or up by what the residuals say."""


@dataclass(frozen=True, eq=False, slots=True)
class Bundle:
    """Solution for planes and poses together.

    Parameters
    ----------
    planes
        The light planes.
    joint
        (U + B, U + B) covariance of the planes' own unknowns and the plate's bows, the camera taken as known.
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
    extra
        (K,) standard deviations in mm of what stripes' offsets, slopes and bends have beyond their own noise.
    pose_errors
        For each pose (P,), RMS of the residuals of its stripes or, if that is larger, of its target points, in
        standard deviations.
    expected_mm
        RMS distance in mm that stripes on poses where the target's points alone put them would have from the true
        planes, by the stated uncertainty of points and stripes.
    without_each
        (P, U + B): the step of the planes' own unknowns and the plate's bows that leaving out each pose makes, to first
        order, the camera taken as known.
    converged
        Whether it is a minimum; else it is where the steps ended.
    """

    planes: PlaneSet
    joint: Array
    by_camera: Array
    camera: Camera
    camera_covariance: Array | None
    poses: tuple[Pose, ...]
    shape: BoardShape
    freedom: float
    corner_scale: float
    extra: Array
    pose_errors: Array
    expected_mm: float
    without_each: Array
    converged: bool

    @property
    def covariance(self) -> Array:
        """Covariance (3N, 3N) in 1/mm² of the π of all N light planes, with the camera taken as known."""
        to_pis = self.planes.jacobian
        unknowns = to_pis.shape[1]
        return np.asarray(to_pis @ self.joint[:unknowns, :unknowns] @ to_pis.T)

    @property
    def extra_mm(self) -> float:
        """Standard deviation in mm of a stripe's offset from its light plane, beyond its own noise."""
        return float(self.extra[0] / np.sqrt(2))


_Found: TypeAlias = tuple[ObservationWeights, Solution[State, PoseEquations]]
"""A solution, and what it was weighted by."""


def solve(
    planes: PlaneSet,
    poses: Sequence[BundlePose],
    camera: Camera,
    camera_covariance: Array | None = None,
    *,
    plate: Plate | None = None,
    rounds: int = ROUNDS,
) -> Bundle:
    """Solve light planes and target poses together by robust least squares (Huber per stripe), from `planes`.

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
    bow = np.zeros(0) if plate is None else plate.bow
    state = State(planes, tuple(pose.pose for pose in poses), bow, np.zeros(PARAMETERS))
    trust = _at_first(seen, state)

    def improve(found: _Found, weigh: Weigh) -> _Found:
        trust, solution = found
        trust = _improved(trust, seen, solution, weigh)
        return trust, minimise(solution.state, partial(seen.linearise, trust=trust), seen.move)

    start = trust, minimise(state, partial(seen.linearise, trust=trust), seen.move)
    trust, solution = irls(
        start, improve, Schedule(rounds, huber_at=HUBER), lambda before, now: _settled(before[0], now[0])
    )
    return _result(seen, solution, trust)


def _at_first(seen: Observations, state: State) -> ObservationWeights:
    count = len(seen.stripes)
    extra = np.median(np.abs(seen.distances(state).mm), axis=0)
    return ObservationWeights(1.0, seen.stripes.noise_mm(state.planes, state.poses), extra, np.ones(count))


def _improved(
    trust: ObservationWeights, seen: Observations, solution: Solution[State, PoseEquations], weigh: Weigh
) -> ObservationWeights:
    """The standard deviations and the stripes' weights again, from residuals and redundancies."""
    residuals, share = solution.linear.residuals, solution.linear.leverages()
    corner = _variance_factor(residuals[: seen.corners], share[: seen.corners])
    scale = float(np.clip(trust.corner_scale * np.sqrt(corner), *CORNER_SCALE_RANGE))
    own = float(np.median(trust.noise) ** 2)
    extra = trust.extra.copy()
    for part in range(seen.stripes.parts):
        rows = slice(seen.corners + part, None, seen.stripes.parts)
        factor = _variance_factor(residuals[rows], share[rows])
        extra[part] = np.sqrt(max(factor * extra[part] ** 2 + (factor - 1) * own, 0.0))
    trust = replace(trust, corner_scale=scale, extra=extra)
    return replace(trust, weight=weigh(_errors(seen, solution.state, trust)))


def _settled(before: ObservationWeights, after: ObservationWeights) -> bool:
    old, new = (np.array([trust.corner_scale, *trust.extra]) for trust in (before, after))
    return bool(np.all(np.abs(new - old) < 0.02 * old + 1e-6))


def _errors(seen: Observations, state: State, trust: ObservationWeights) -> Array:
    """RMS (S,) of each stripe's residuals in their standard deviations."""
    distances = seen.distances(state).mm / trust.sd
    return np.asarray(np.sqrt((distances**2).mean(axis=1)), dtype=np.float64)


def _result(seen: Observations, solution: Solution[State, PoseEquations], trust: ObservationWeights) -> Bundle:
    state = solution.state
    unknowns = state.planes.jacobian.shape[1]
    known = unknowns + seen.bows
    every = seen.with_every_camera_parameter(state, trust)
    alone = every.by_first(known)
    covariance = alone.covariance
    expected_mm = seen.expected_mm(state, trust)
    without_each = alone.steps_without_each()
    covariance = covariance * _widening(covariance[:unknowns, :unknowns], without_each[:, :unknowns])
    corrected = None
    if len(seen.free):
        corrected = np.zeros((PARAMETERS, PARAMETERS))
        corrected[np.ix_(seen.free, seen.free)] = solution.linear.covariance[known:, known:]
    return Bundle(
        planes=state.planes,
        joint=covariance,
        by_camera=state.planes.jacobian @ every.followed_by(known)[:unknowns],
        camera=seen.camera(state),
        camera_covariance=corrected,
        poses=state.poses,
        shape=seen.shape(state.bow, covariance[unknowns:, unknowns:]),
        freedom=float((1 - alone.leverages()[seen.corners :]).sum()),
        corner_scale=trust.corner_scale,
        extra=trust.extra,
        pose_errors=_pose_errors(seen, alone.residuals, _errors(seen, state, trust)),
        expected_mm=expected_mm,
        without_each=without_each,
        converged=solution.converged,
    )


def _widening(covariance: Array, without_each: Array) -> float:
    """Factor ≥ 1 on a covariance (U, U): the jackknife's variance over it, the mean of all directions."""
    count, unknowns = without_each.shape
    if count <= unknowns:
        return 1.0
    off = without_each - without_each.mean(axis=0)
    variance = (count - 1) / count * float(np.einsum("pi,ij,pj->", off, inverse(covariance), off)) / unknowns
    return float(max(variance, 1.0))


def _pose_errors(seen: Observations, residuals: Array, of_stripes: Array) -> Array:
    """(P,) RMS of each pose's stripes or, if larger, of its target points, in standard deviations."""
    count, pose_of = len(seen.known), seen.stripes.pose_of
    summed = np.bincount(pose_of, of_stripes**2, minlength=count)
    stripes = summed / np.maximum(np.bincount(pose_of, minlength=count), 1)
    of_corners = residuals[: seen.corners]
    corners = [float((of_corners[rows] ** 2).mean()) for rows in seen.rows]
    return np.asarray(np.sqrt(np.maximum(stripes, corners)), dtype=np.float64)


def _variance_factor(residuals: Array, share: Array) -> float:
    """Sum of squares over redundancy, held to 1 by PRIOR_FREEDOM further residuals of expected size."""
    freedom = max(len(residuals) - float(share.sum()), 0.0)
    return (float(residuals @ residuals) + PRIOR_FREEDOM) / (freedom + PRIOR_FREEDOM)
