"""The fan's planes and the target's poses solved together.

A pose of a small target is known less well than the stripes on it, and its error is common to all of them; but
stripes of the same light planes on other poses know something of it. So the poses are unknowns beside the planes,
held by the residuals of the target's points, and the stripes by their distances from the light planes. How much to
trust each is taken from the data: target points get a common factor on their stated uncertainty, stripes an additional
standard deviation in mm for their offset and another for their slope (a plate not quite flat, a lens not quite
modelled), all such that residuals are as large as they should be.

References
----------
Förstner, W., Ein Verfahren zur Schätzung von Varianz- und Kovarianzkomponenten, AVN 86 (1979) 446.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.calibrate import reprojection
from core.calibrate.levenberg import Solution, minimise
from core.calibrate.pencil import PlaneSet, huber_weights, plane_distances
from core.calibrate.stripe_lines import StripeLine
from core.image.target_view import TargetView
from core.model import Camera, Pose
from core.model.arrays import Array

PRIOR_FREEDOM = 6.0
"""Belief in the stated uncertainties, counted in residuals: few residuals cannot overthrow them."""
ROUNDS = 12
CORNER_SCALE_RANGE = (0.3, 30.0)
OFFSET_AND_SLOPE = np.array([[1.0, 1.0], [1.0, -1.0]]) / np.sqrt(2)
"""Turns the errors of a stripe's two pivots into two that a bent plate does not mix."""


@dataclass(frozen=True, eq=False, slots=True)
class BundlePose:
    """One pose of the target: its points seen in `view`, where `pose` is believed, and the fan lines' stripes."""

    view: TargetView
    pose: Pose
    stripes: dict[int, StripeLine]


@dataclass(frozen=True, eq=False, slots=True)
class Bundle:
    """The solution.

    Parameters
    ----------
    planes
        The light planes.
    covariance
        (3N, 3N) of the stacked π in 1/mm².
    poses
        The poses, improved.
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
    poses: tuple[Pose, ...]
    freedom: float
    corner_scale: float
    extra_mm: float
    pose_errors: Array


def solve(planes: PlaneSet, poses: Sequence[BundlePose], camera: Camera) -> Bundle:
    """Solve planes and poses together, from `planes` near the answer, robustly (Huber per stripe)."""
    return _Problem(poses, camera).solve(planes)


@dataclass(frozen=True, eq=False, slots=True)
class _State:
    planes: PlaneSet
    poses: tuple[Pose, ...]


class _Problem:
    """Observations stacked once; standard deviations improve from round to round."""

    def __init__(self, poses: Sequence[BundlePose], camera: Camera) -> None:
        self.camera = camera
        self.poses = poses
        stripes = [(p, line, stripe) for p, pose in enumerate(poses) for line, stripe in pose.stripes.items()]
        self.pose_of = np.array([p for p, _, _ in stripes], dtype=np.intp)
        self.line_of = np.array([line for _, line, _ in stripes], dtype=np.intp)
        self.rays = np.array([stripe.pivots for *_, stripe in stripes])
        self.sigma = np.array([stripe.sigma for *_, stripe in stripes])
        self.across = np.array([stripe.across for *_, stripe in stripes])
        self.corner_scale = 1.0
        self.extra = np.zeros(2)
        self.noise = np.ones(len(stripes))
        self.weight = np.ones(len(stripes))

    def solve(self, planes: PlaneSet) -> Bundle:
        state = _State(planes, tuple(pose.pose for pose in self.poses))
        self.noise = self._noise_mm(state)
        self.extra = np.median(np.abs(self._distances(state)[0]), axis=0)
        solution = minimise(state, self._linearise, _move)
        for _ in range(ROUNDS):
            before = np.array([self.corner_scale, *self.extra])
            self._reweight(solution)
            solution = minimise(solution.state, self._linearise, _move)
            after = np.array([self.corner_scale, *self.extra])
            if np.all(np.abs(after - before) < 0.02 * before + 1e-6):
                break
        return self._result(solution)

    def _sd(self) -> Array:
        """Standard deviations (S, 2) in mm of the stripes' offsets and slopes."""
        return np.asarray(np.hypot(self.noise[:, None], self.extra), dtype=np.float64)

    def _linearise(self, state: _State) -> tuple[Array, Array]:
        unknowns = state.planes.jacobian.shape[1]
        width = unknowns + 6 * len(state.poses)
        residuals, blocks = [], []
        for index, (known, pose) in enumerate(zip(self.poses, state.poses, strict=True)):
            uv, _, by_pose = reprojection.linearise(self.camera, pose, known.view.points)
            sd = known.view.sigma[:, None] * self.corner_scale
            residuals.append(((uv - known.view.uv) / sd).ravel())
            block = np.zeros((2 * len(uv), width))
            block[:, unknowns + 6 * index : unknowns + 6 * index + 6] = (by_pose / sd[..., None]).reshape(-1, 6)
            blocks.append(block)
        distances, by_planes, by_pose = self._distances(state)
        weight = np.sqrt(self.weight)[:, None] / self._sd()
        block = np.zeros((*distances.shape, width))
        block[..., :unknowns] = by_planes
        columns = unknowns + 6 * self.pose_of[:, None] + np.arange(6)
        np.put_along_axis(block, np.repeat(columns[:, None], 2, axis=1), by_pose, axis=2)
        residuals.append((distances * weight).ravel())
        blocks.append((block * weight[..., None]).reshape(-1, width))
        return np.concatenate(residuals), np.vstack(blocks)

    def _distances(self, state: _State) -> tuple[Array, Array, Array]:
        """How far stripes are off their light planes, offset and slope, as distances in mm of their pivots (S, 2).

        With the derivatives by the planes' unknowns (S, 2, P) and by the pose (S, 2, 6).
        """
        targets, by_step = (np.array(a) for a in zip(*(_target_plane(pose) for pose in state.poses), strict=True))
        target, by_step = targets[self.pose_of], by_step[self.pose_of]
        pis = state.planes.pis[self.line_of]
        depth = 1 / np.einsum("sij,sj->si", self.rays, target)
        points = self.rays * depth[..., None]
        flat, by_pi = plane_distances(np.repeat(pis, 2, axis=0), points.reshape(-1, 3))
        jacobian = state.planes.jacobian.reshape(len(state.planes.pis), 3, -1)[self.line_of]
        by_planes = np.einsum("sij,sjp->sip", by_pi.reshape(-1, 2, 3), jacobian)
        reach = np.einsum("sij,sj->si", self.rays, pis) * depth**2 / np.linalg.norm(pis, axis=1)[:, None]
        by_pose = -reach[..., None] * np.einsum("sij,sjp->sip", self.rays, by_step)
        turn = OFFSET_AND_SLOPE
        return flat.reshape(-1, 2) @ turn, turn @ by_planes, turn @ by_pose

    def _noise_mm(self, state: _State) -> Array:
        """A stripe's own noise (S,) across its line of rays, seen as a distance in mm from the light plane."""
        target = np.array([_target_plane(pose)[0] for pose in state.poses])[self.pose_of]
        pis = state.planes.pis[self.line_of]
        middle = self.rays.mean(axis=1)
        depth = 1 / np.einsum("si,si->s", middle, target)
        ahead = np.einsum("si,si->s", pis, middle) * depth
        by_ray = (pis - ahead[:, None] * target) * (depth / np.linalg.norm(pis, axis=1))[:, None]
        return np.asarray(np.abs(np.einsum("si,si->s", by_ray[:, :2], self.across)) * self.sigma, dtype=np.float64)

    def _reweight(self, solution: Solution[_State]) -> None:
        """Improve the standard deviations and the stripes' weights from residuals and redundancies."""
        share = ((solution.jacobian @ solution.covariance) * solution.jacobian).sum(axis=1)
        first = len(share) - 2 * len(self.noise)
        corner = _variance_factor(solution.residuals[:first], share[:first])
        self.corner_scale = float(np.clip(self.corner_scale * np.sqrt(corner), *CORNER_SCALE_RANGE))
        own = float(np.median(self.noise) ** 2)
        for part in range(2):
            rows = slice(first + part, None, 2)
            factor = _variance_factor(solution.residuals[rows], share[rows])
            self.extra[part] = np.sqrt(max(factor * self.extra[part] ** 2 + (factor - 1) * own, 0.0))
        self.weight = huber_weights(self._errors(solution))

    def _errors(self, solution: Solution[_State]) -> Array:
        """RMS (S,) of each stripe's two residuals in their standard deviations."""
        distances = self._distances(solution.state)[0] / self._sd()
        return np.asarray(np.sqrt((distances**2).mean(axis=1)), dtype=np.float64)

    def _result(self, solution: Solution[_State]) -> Bundle:
        planes = solution.state.planes
        unknowns = planes.jacobian.shape[1]
        local = solution.covariance
        stripes = solution.jacobian[-2 * len(self.noise) :]
        freedom = len(stripes) - float(((stripes @ local) * stripes).sum())
        covariance = planes.jacobian @ local[:unknowns, :unknowns] @ planes.jacobian.T
        return Bundle(
            planes,
            covariance,
            solution.state.poses,
            freedom,
            self.corner_scale,
            float(self.extra[0] / np.sqrt(2)),
            self._pose_errors(solution),
        )

    def _pose_errors(self, solution: Solution[_State]) -> Array:
        count = len(self.poses)
        summed = np.bincount(self.pose_of, self._errors(solution) ** 2, minlength=count)
        stripes = summed / np.maximum(np.bincount(self.pose_of, minlength=count), 1)
        corners = np.empty(count)
        first = 0
        for index, pose in enumerate(self.poses):
            own = solution.residuals[first : first + 2 * len(pose.view.points)]
            corners[index] = (own**2).mean()
            first += len(own)
        return np.asarray(np.sqrt(np.maximum(stripes, corners)), dtype=np.float64)


def target_plane(pose: Pose) -> Array:
    """τ (3,) in 1/mm of the target's plane z = 0: τ·X = 1 on it."""
    return _target_plane(pose)[0]


def target_plane_covariance(view: TargetView, pose: Pose, camera: Camera) -> Array:
    """(3, 3) of τ, from the stated uncertainty of the target's points."""
    _, _, by_pose = reprojection.linearise(camera, pose, view.points)
    scaled = (by_pose / view.sigma[:, None, None]).reshape(-1, 6)
    by_step = _target_plane(pose)[1]
    covariance: Array = by_step @ np.linalg.pinv(scaled.T @ scaled, hermitian=True, rcond=1e-14) @ by_step.T
    return covariance


def _target_plane(pose: Pose) -> tuple[Array, Array]:
    """τ (3,) and its derivative (3, 6) by a small turn in front of the pose and a shift."""
    normal = pose.rotation[:, 2]
    distance = float(normal @ pose.translation)
    # column i is e_i × normal: what a small turn about axis i adds to the normal
    turned = np.array([[0.0, normal[2], -normal[1]], [-normal[2], 0.0, normal[0]], [normal[1], -normal[0], 0.0]])
    normal_step = np.hstack([turned, np.zeros((3, 3))])
    distance_step = pose.translation @ normal_step
    distance_step[3:] += normal
    return normal / distance, normal_step / distance - np.outer(normal, distance_step) / distance**2


def _variance_factor(residuals: Array, share: Array) -> float:
    """Sum of squares over redundancy, held to 1 by PRIOR_FREEDOM further residuals of expected size."""
    freedom = max(len(residuals) - float(share.sum()), 0.0)
    return (float(residuals @ residuals) + PRIOR_FREEDOM) / (freedom + PRIOR_FREEDOM)


def _move(state: _State, step: Array) -> _State:
    first = len(step) - 6 * len(state.poses)
    steps: list[NDArray[np.float64]] = list(step[first:].reshape(-1, 6))
    poses = tuple(reprojection.moved(pose, own) for pose, own in zip(state.poses, steps, strict=True))
    return _State(state.planes.moved(step[:first]), poses)
