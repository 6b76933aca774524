"""Bundle adjustment of camera and poses: Levenberg–Marquardt on the reprojection residuals of all views.

Every residual depends on the camera and on one pose only, so each view's six pose unknowns are eliminated
(Schur complement) and the system solved has as many unknowns as the camera has free parameters.

References
----------
Triggs, B. et al., Bundle adjustment: a modern synthesis (2000), §6, doi:10.1007/3-540-44480-7_21.
Zhang, Z., IEEE Trans. PAMI 22 (2000) 1330–1334, §3.2, doi:10.1109/34.888718.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.calibrate.camera.reprojection import all_moved, camera_of, linearise_turned, parameters_of
from core.model import Camera, Pose
from core.model.arrays import Array
from core.model.robust import Schedule, Weigh, irls

RAYLEIGH_MEDIAN = 1.1774100225154747
"""Median length of a residual vector whose two components have standard deviation 1: √(2 ln 2)."""

NO_PARAMETERS = np.zeros(0, dtype=np.intp)
"""For `refine`: the camera is known and only the poses are estimated."""

# Levenberg–Marquardt: damping relative to the normal matrix's diagonal, Marquardt's factor 10 up and down.
_FIRST_DAMPING, _DAMPING_FACTOR = 1e-3, 10  # starts are rough
_LEAST_DAMPING, _MOST_DAMPING = 1e-12, 1e10  # beyond the largest no step lowers the cost any more
_MOST_ITERATIONS = 60  # mostly ten

# The robust start among outliers; tests/calibrate/camera/test_calibration.py (misfound corners, wrong views) holds it.
_HUBER = Schedule(6, huber_at=2.5)  # standard deviations by the median residual
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
        """Select the corners of the view for which `keep` (N,) is true."""
        return Observed(self.points[keep], self.uv[keep], self.weights[keep])


@dataclass(frozen=True, eq=False, slots=True)
class Bundle:
    """A camera, and one pose for each view."""

    camera: Camera
    poses: tuple[Pose, ...]

    def of_views(self, numbers: Sequence[int]) -> Bundle:
        """Select the poses of the views with these indices, beside the same camera."""
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
class _StackedViews:
    """All views' corners behind one another: NumPy is quicker on all of them at once than on each view in turn.

    `view` (N,): the view that each corner is of; `parts`: each view's corners.
    """

    corners: Observed
    view: NDArray[np.intp]
    parts: tuple[slice, ...]

    @classmethod
    def of(cls, views: Sequence[Observed]) -> _StackedViews:
        corners = Observed(
            np.concatenate([view.points for view in views]),
            np.concatenate([view.uv for view in views]),
            np.concatenate([view.weights for view in views]),
        )
        counts = [len(view.uv) for view in views]
        ends = np.cumsum(counts).tolist()
        parts = tuple(slice(end - count, end) for end, count in zip(ends, counts, strict=True))
        return cls(corners, np.repeat(np.arange(len(views)), counts), parts)

    def turned(self, poses: Sequence[Pose]) -> tuple[Array, Array]:
        """The points (N, 3) turned by their view's pose, and shifted by it as well, in mm."""
        points = self.corners.points
        turned = np.concatenate([points[part] @ pose.rotation.T for part, pose in zip(self.parts, poses, strict=True)])
        return turned, turned + np.array([pose.translation for pose in poses])[self.view]

    def residuals(self, bundle: Bundle) -> Array:
        """Observed − predicted (N, 2) in pixels; infinite in views of which a point is not in front of the camera."""
        _, position = self.turned(bundle.poses)
        with np.errstate(all="ignore"):
            missing = self.corners.uv - bundle.camera.project(position)
        missing[np.isin(self.view, self.view[position[:, 2] < _NEAREST_MM])] = np.inf
        return missing

    def cost(self, bundle: Bundle) -> float:
        """The weighted sum of squared residuals; not finite where a point is not in front of the camera."""
        with np.errstate(over="ignore", invalid="ignore"):
            squares = np.sum(self.residuals(bundle) ** 2, axis=1)
            return sum(float(self.corners.weights[part] @ squares[part]) for part in self.parts)

    def weighted(self, bundle: Bundle, free: NDArray[np.intp]) -> Iterator[tuple[Array, Array, Array]]:
        """Of each view, derivatives (2N, F) and (2N, 6) and residuals (2N,), each row times the root of its weight."""
        uv, by_camera, by_pose = linearise_turned(bundle.camera, *self.turned(bundle.poses))
        root = np.sqrt(np.repeat(self.corners.weights, 2))
        by_camera = by_camera.reshape(-1, 10)[:, free] * root[:, None]
        by_pose = by_pose.reshape(-1, 6) * root[:, None]
        missing = (self.corners.uv - uv).ravel() * root
        for part in self.parts:
            rows = slice(2 * part.start, 2 * part.stop)
            yield by_camera[rows], by_pose[rows], missing[rows]


@dataclass(frozen=True, eq=False, slots=True)
class _Blocks:
    """The V views' shares of the normal equations: camera (V, F, F), camera–pose (V, F, 6) and pose (V, 6, 6).

    With the gradients (V, F) and (V, 6).
    """

    camera: Array
    mixed: Array
    pose: Array
    camera_gradient: Array
    pose_gradient: Array

    def damped(self, damping: float) -> _Blocks:
        """With Marquardt's multiple of their diagonals added."""
        return replace(
            self, camera=_with_more_diagonal(self.camera, damping), pose=_with_more_diagonal(self.pose, damping)
        )

    def reduced(self) -> tuple[Array, Array]:
        """Information (F, F) and gradient (F,) of the camera alone."""
        right = np.concatenate([self.mixed.transpose(0, 2, 1), self.pose_gradient[:, :, None]], axis=2)
        eliminated = np.linalg.solve(self.pose, right)
        information = self.camera - self.mixed @ eliminated[:, :, :-1]
        gradient = self.camera_gradient - (self.mixed @ eliminated[:, :, -1:])[:, :, 0]
        return information.sum(axis=0), gradient.sum(axis=0)


def _with_more_diagonal(matrices: Array, damping: float) -> Array:
    """Square matrices (V, K, K) with their diagonals 1 + `damping` times as large."""
    more = matrices.copy()
    index = np.arange(matrices.shape[1])
    more[:, index, index] += damping * matrices[:, index, index]
    return more


def refine(start: Bundle, views: Sequence[Observed], free: NDArray[np.intp], tolerance: float = 1e-12) -> Bundle:
    """Solve for camera and poses by least squares on weighted residuals, from `start`, to a relative `tolerance`.

    `free` are the indices (F,) of the camera's free parameters in CAMERA_PARAMETERS; none means that only the poses
    are found. Stops when a step gains less than `tolerance` of the cost.
    """
    stacked = _StackedViews.of(views)
    current, cost = start, stacked.cost(start)
    damping: float = _FIRST_DAMPING
    blocks = _blocks(current, stacked, free)
    for _ in range(_MOST_ITERATIONS):
        proposal = _step(current, blocks.damped(damping), free)
        proposed = np.inf if proposal is None else stacked.cost(proposal)
        if proposal is None or not proposed <= cost:
            damping *= _DAMPING_FACTOR
            if damping > _MOST_DAMPING:
                break
            continue
        gain, cost, current = cost - proposed, proposed, proposal
        damping = max(damping / _DAMPING_FACTOR, _LEAST_DAMPING)
        if gain <= tolerance * cost:
            break
        blocks = _blocks(current, stacked, free)
    return current


def refine_robustly(start: Bundle, views: Sequence[Observed], free: NDArray[np.intp]) -> Bundle:
    """Solve for camera and poses with Huber's weights, which outliers do not spoil: a start for `refine`."""

    def improve(current: Bundle, weigh: Weigh) -> Bundle:
        lengths = residual_lengths(current, views)
        scale = max(float(np.median(np.concatenate(lengths))) / RAYLEIGH_MEDIAN, _LEAST_SCALE_PX)
        weighted = [
            replace(view, weights=view.weights * weigh(length, scale))
            for view, length in zip(views, lengths, strict=True)
        ]
        return refine(current, weighted, free, tolerance=_HUBER_TOLERANCE)

    return irls(start, improve, _HUBER)


def residuals(camera: Camera, pose: Pose, view: Observed) -> Array:
    """Compute observed − projected corners (N, 2) of a view in px; infinite for a point behind the camera."""
    return _StackedViews.of([view]).residuals(Bundle(camera, (pose,)))


def residual_lengths(bundle: Bundle, observed: Sequence[Observed]) -> list[Array]:
    """Compute for each view the lengths (N,) of its corners' residuals, times the root of their weights, in px."""
    return [
        np.linalg.norm(residuals(bundle.camera, pose, view), axis=1) * np.sqrt(view.weights)
        for pose, view in zip(bundle.poses, observed, strict=True)
    ]


def normal_equations(
    bundle: Bundle, views: Sequence[Observed], free: NDArray[np.intp], target_changes: Sequence[Array] | None = None
) -> Normal:
    """Compute the normal equations of the camera's `free` parameters at `bundle`, the poses eliminated.

    `target_changes`, (N, 3, B) for each view, are the derivatives of its target points by B further unknowns common to
    all views, which stand behind the camera's.
    """
    stacked = _StackedViews.of(views)
    information, gradients = [], []
    for index, (unknowns, by_pose, missing) in enumerate(stacked.weighted(bundle, free)):
        if target_changes is not None:
            by_target = by_pose.reshape(-1, 2, 6)[..., 3:] @ bundle.poses[index].rotation @ target_changes[index]
            unknowns = np.hstack([unknowns, by_target.reshape(len(unknowns), -1)])
        alone = unknowns - by_pose @ np.linalg.lstsq(by_pose, unknowns, rcond=None)[0]
        information.append(alone.T @ alone)
        gradients.append((alone * missing[:, None]).reshape(-1, 2, alone.shape[1]).sum(axis=1))
    return Normal(np.array(information), tuple(gradients), stacked.cost(bundle))


def _blocks(bundle: Bundle, views: _StackedViews, free: NDArray[np.intp]) -> _Blocks:
    blocks = [
        (camera.T @ camera, camera.T @ posing, posing.T @ posing, camera.T @ missing, posing.T @ missing)
        for camera, posing, missing in views.weighted(bundle, free)
    ]
    return _Blocks(*(np.array(each) for each in zip(*blocks, strict=True)))


def _step(current: Bundle, blocks: _Blocks, free: NDArray[np.intp]) -> Bundle | None:
    """The bundle one Gauss–Newton step further, or None where there is no such step."""
    parameters = parameters_of(current.camera)
    change = np.zeros(len(free))
    try:
        if len(free):
            information, gradient = blocks.reduced()
            scale = 1 / np.sqrt(np.maximum(np.diag(information), 1e-300))
            change = scale * np.linalg.solve(information * np.outer(scale, scale), scale * gradient)
        parameters[free] += change
        steps = np.linalg.solve(blocks.pose, (blocks.pose_gradient - change @ blocks.mixed)[:, :, None])
        poses = all_moved(current.poses, np.asarray(steps[:, :, 0], dtype=np.float64))
        return Bundle(camera_of(parameters, current.camera.image_size), poses)
    except (np.linalg.LinAlgError, ValueError):
        return None  # singular, or a focal length below zero: the caller damps more
