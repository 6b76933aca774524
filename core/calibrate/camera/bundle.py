"""Bundle adjustment of camera and poses: Levenberg–Marquardt on the reprojection residuals of all views.

Every residual depends on the camera and on one pose only, so each view's six pose unknowns are eliminated
(Schur complement) and the system solved has as many unknowns as the camera has free parameters.

References
----------
Triggs, B. et al., Bundle adjustment: a modern synthesis (2000), §6, doi:10.1007/3-540-44480-7_21.
Zhang, Z., IEEE Trans. PAMI 22 (2000) 1330–1334, §3.2, doi:10.1109/34.888718.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.calibrate.camera.reprojection import camera_of, linearise, moved, parameters_of
from core.model import Camera, Pose
from core.model.arrays import Array
from core.model.robust import huber_weights

RAYLEIGH_MEDIAN = 1.1774100225154747
"""Median length of a residual vector whose two components have standard deviation 1: √(2 ln 2)."""

NO_PARAMETERS = np.zeros(0, dtype=np.intp)
"""For `refine`: the camera is known and only the poses are estimated."""

# Levenberg–Marquardt: damping relative to the normal matrix's diagonal, Marquardt's factor 10 up and down.
_FIRST_DAMPING, _DAMPING_FACTOR = 1e-3, 10  # starts are rough
_LEAST_DAMPING, _MOST_DAMPING = 1e-12, 1e10  # beyond the largest no step lowers the cost any more
_MOST_ITERATIONS = 60  # mostly ten

# The robust start among outliers; tests/calibrate/camera/test_calibration.py (misfound corners, wrong views) holds it.
_HUBER_LIMIT = 2.5  # standard deviations by the median residual
_HUBER_ROUNDS = 6  # of reweighting
_HUBER_TOLERANCE = 1e-6  # gain as a share of the cost at which a round ends: the next one has other weights
_LEAST_SCALE_PX = 1e-9  # of the residuals: exact views have none

_NEAREST_MM = 1e-6
"""Depth below which a point is not in front of the camera."""


@dataclass(frozen=True, eq=False, slots=True)
class Observed:
    """Corners of one view: target points (N, 3) in mm, image points (N, 2) in pixels, weights (N,) ∝ 1/σ²."""

    points: Array
    uv: Array
    weights: Array

    def select(self, keep: NDArray[np.bool_]) -> Observed:
        """Select the corners for which `keep` (N,) is true."""
        return Observed(self.points[keep], self.uv[keep], self.weights[keep])


@dataclass(frozen=True, eq=False, slots=True)
class Bundle:
    """A camera, and one pose for each view."""

    camera: Camera
    poses: tuple[Pose, ...]

    def of_views(self, numbers: Sequence[int]) -> Bundle:
        """The camera with the poses of these views alone."""
        return Bundle(self.camera, tuple(self.poses[i] for i in numbers))


@dataclass(frozen=True, eq=False, slots=True)
class Normal:
    """Normal equations of a bundle for the camera's F free parameters, the poses eliminated.

    `information` (V, F, F) of the views with their poses eliminated, in units of the weights; `gradients` the (N, F)
    shares of each view's corners in the gradient; `cost` the weighted sum of squared residuals.
    """

    information: Array
    gradients: tuple[Array, ...]
    cost: float


@dataclass(frozen=True, eq=False, slots=True)
class _Block:
    """One view's share of the normal equations: camera, camera–pose and pose."""

    camera: Array
    mixed: Array
    pose: Array
    camera_gradient: Array
    pose_gradient: Array

    def damped(self, damping: float) -> _Block:
        """With Marquardt's multiple of its diagonal added."""
        return replace(
            self,
            camera=self.camera + damping * np.diag(np.diag(self.camera)),
            pose=self.pose + damping * np.diag(np.diag(self.pose)),
        )

    def reduced(self) -> tuple[Array, Array]:
        """Information and gradient of the camera alone."""
        eliminated = np.linalg.solve(self.pose, np.column_stack([self.mixed.T, self.pose_gradient]))
        information = self.camera - self.mixed @ eliminated[:, :-1]
        return information, self.camera_gradient - self.mixed @ eliminated[:, -1]


def refine(start: Bundle, views: Sequence[Observed], free: NDArray[np.intp], tolerance: float = 1e-12) -> Bundle:
    """Minimise the weighted sum of squared residuals from `start`.

    `free` are the indices (F,) of the camera's free parameters in CAMERA_PARAMETERS; none means that only the poses
    are found. Stops when a step gains less than `tolerance` of the cost.
    """
    current, cost = start, _cost(start, views)
    damping: float = _FIRST_DAMPING
    blocks = _blocks(current, views, free)
    for _ in range(_MOST_ITERATIONS):
        proposal = _step(current, [block.damped(damping) for block in blocks], free)
        proposed = np.inf if proposal is None else _cost(proposal, views)
        if proposal is None or not proposed <= cost:
            damping *= _DAMPING_FACTOR
            if damping > _MOST_DAMPING:
                break
            continue
        gain, cost, current = cost - proposed, proposed, proposal
        damping = max(damping / _DAMPING_FACTOR, _LEAST_DAMPING)
        if gain <= tolerance * cost:
            break
        blocks = _blocks(current, views, free)
    return current


def refine_robustly(start: Bundle, views: Sequence[Observed], free: NDArray[np.intp]) -> Bundle:
    """Minimise with Huber's weights about a scale from the median residual: a start among outliers for `refine`."""
    current = start
    for _ in range(_HUBER_ROUNDS):
        lengths = [
            np.linalg.norm(residuals(current.camera, pose, view), axis=1) * np.sqrt(view.weights)
            for pose, view in zip(current.poses, views, strict=True)
        ]
        limit = _HUBER_LIMIT * max(float(np.median(np.concatenate(lengths))) / RAYLEIGH_MEDIAN, _LEAST_SCALE_PX)
        weighted = [
            replace(view, weights=view.weights * huber_weights(length, limit))
            for view, length in zip(views, lengths, strict=True)
        ]
        current = refine(current, weighted, free, tolerance=_HUBER_TOLERANCE)
    return current


def residuals(camera: Camera, pose: Pose, view: Observed) -> Array:
    """Observed − predicted (N, 2) in pixels; infinite for points that are not in front of the camera."""
    position = pose.apply(view.points)
    if np.any(position[:, 2] < _NEAREST_MM):
        return np.full(view.uv.shape, np.inf)
    return np.asarray(view.uv - camera.project(position), dtype=np.float64)


def residual_lengths(bundle: Bundle, observed: Sequence[Observed]) -> list[Array]:
    """Lengths (N,) of the weighted residual vectors of every view, in pixels."""
    return [
        np.linalg.norm(residuals(bundle.camera, pose, view), axis=1) * np.sqrt(view.weights)
        for pose, view in zip(bundle.poses, observed, strict=True)
    ]


def normal_equations(
    bundle: Bundle, views: Sequence[Observed], free: NDArray[np.intp], target_changes: Sequence[Array] | None = None
) -> Normal:
    """Compute the reduced normal equations at `bundle`.

    `target_changes`, (N, 3, B) for each view, are the derivatives of its target points by B further unknowns common to
    all views, which stand behind the camera's.
    """
    information, gradients = [], []
    for index, (pose, view) in enumerate(zip(bundle.poses, views, strict=True)):
        unknowns, by_pose, missing = _weighted(bundle.camera, pose, view, free)
        if target_changes is not None:
            by_target = by_pose.reshape(-1, 2, 6)[..., 3:] @ pose.rotation @ target_changes[index]
            unknowns = np.hstack([unknowns, by_target.reshape(len(unknowns), -1)])
        alone = unknowns - by_pose @ np.linalg.lstsq(by_pose, unknowns, rcond=None)[0]
        information.append(alone.T @ alone)
        gradients.append((alone * missing[:, None]).reshape(-1, 2, alone.shape[1]).sum(axis=1))
    return Normal(np.array(information), tuple(gradients), _cost(bundle, views))


def _cost(bundle: Bundle, views: Sequence[Observed]) -> float:
    total = 0.0
    for pose, view in zip(bundle.poses, views, strict=True):
        with np.errstate(over="ignore", invalid="ignore"):
            total += float(view.weights @ np.sum(residuals(bundle.camera, pose, view) ** 2, axis=1))
    return total


def _weighted(camera: Camera, pose: Pose, view: Observed, free: NDArray[np.intp]) -> tuple[Array, Array, Array]:
    """Derivatives (2N, F) and (2N, 6) and residuals (2N,), each row times the root of its weight."""
    uv, by_camera, by_pose = linearise(camera, pose, view.points)
    root = np.sqrt(np.repeat(view.weights, 2))
    columns = root[:, None]
    return (
        by_camera.reshape(-1, 10)[:, free] * columns,
        by_pose.reshape(-1, 6) * columns,
        (view.uv - uv).ravel() * root,
    )


def _blocks(bundle: Bundle, views: Sequence[Observed], free: NDArray[np.intp]) -> list[_Block]:
    blocks = []
    for pose, view in zip(bundle.poses, views, strict=True):
        camera, posing, missing = _weighted(bundle.camera, pose, view, free)
        blocks.append(
            _Block(camera.T @ camera, camera.T @ posing, posing.T @ posing, camera.T @ missing, posing.T @ missing)
        )
    return blocks


def _step(current: Bundle, blocks: Sequence[_Block], free: NDArray[np.intp]) -> Bundle | None:
    """The bundle one Gauss–Newton step further, or None where there is no such step."""
    parameters = parameters_of(current.camera)
    change = np.zeros(len(free))
    try:
        if len(free):
            reduced = [block.reduced() for block in blocks]
            information = np.sum([part for part, _ in reduced], axis=0)
            scale = 1 / np.sqrt(np.maximum(np.diag(information), 1e-300))
            gradient = np.sum([part for _, part in reduced], axis=0)
            change = scale * np.linalg.solve(information * np.outer(scale, scale), scale * gradient)
        parameters[free] += change
        steps = [np.linalg.solve(block.pose, block.pose_gradient - block.mixed.T @ change) for block in blocks]
        poses = tuple(moved(pose, np.asarray(step)) for pose, step in zip(current.poses, steps, strict=True))
        return Bundle(camera_of(parameters, current.camera.image_size), poses)
    except (np.linalg.LinAlgError, ValueError):
        return None  # singular, or a focal length below zero: the caller damps more
