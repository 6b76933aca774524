"""The fan's planes and the target's poses solved together, with the camera known or corrected along with them.

A pose of a small target is known less well than the stripes on it, and its error is common to all of them; but
stripes of the same light planes on other poses know something of it. So the poses are unknowns beside the planes,
held by the residuals of the target's points, and the stripes by their distances from the light planes. How much to
trust each is taken from the data: target points get a common factor on their stated uncertainty, stripes an additional
standard deviation in mm for their offset and another for their slope (a plate not quite flat, a lens not quite
modelled), all such that residuals are as large as they should be.

A plate whose flatness is only known to a tolerance is a second-degree surface (`core.calibrate.board_shape`), the same
in all poses, its three bows unknowns with that tolerance as prior. The bend of the stripes tells them, and how stripes
and target points of differently held plates agree.

The poses are views of a flat target too. With the camera's covariance its parameters are unknowns as well, held by
what its own views know of them: a calibration with its covariance is the normal equations of all its views with their
poses eliminated, so this is, to first order, the adjustment of all pictures in one.

References
----------
Förstner, W., Ein Verfahren zur Schätzung von Varianz- und Kovarianzkomponenten, AVN 86 (1979) 446.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from core.calibrate import reprojection
from core.calibrate.board_shape import SHAPE_PARAMETERS, Board, BoardShape
from core.calibrate.levenberg import Solution, minimise
from core.calibrate.pencil import PlaneSet, huber_weights
from core.calibrate.stripe_distances import BOWS, Distances, Stripes
from core.calibrate.stripe_lines import StripeLine
from core.image.target_view import TargetView
from core.model import Camera, Pose
from core.model.arrays import Array

PRIOR_FREEDOM = 6.0
"""Belief in the stated uncertainties, counted in residuals: few residuals cannot overthrow them."""
ROUNDS = 12
CORNER_SCALE_RANGE = (0.3, 30.0)
PARAMETERS = 10
_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False, slots=True)
class BundlePose:
    """One pose of the target: its points seen in `view`, where `pose` is believed, and the fan lines' stripes."""

    view: TargetView
    pose: Pose
    stripes: dict[int, StripeLine]


@dataclass(frozen=True, eq=False, slots=True)
class Plate:
    """A plate that may be bowed: its extent, and the standard deviation of how far its edges are off its plane."""

    board: Board
    flatness_mm: float


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
    return _Problem(poses, camera, camera_covariance, plate).solve(planes, rounds)


@dataclass(frozen=True, eq=False, slots=True)
class _State:
    """`bow` (3 or 0,) in mm of the plate; `camera` (10,) is the change of the camera's parameters."""

    planes: PlaneSet
    poses: tuple[Pose, ...]
    bow: Array
    camera: Array


class _Problem:
    """Observations stacked once; standard deviations improve from round to round.

    Columns of all Jacobians are the planes' unknowns, six for each pose, the plate's bows if it may have any, and the
    camera's ten parameters. What is known of camera and bows stands in the first rows.
    """

    def __init__(
        self, poses: Sequence[BundlePose], camera: Camera, camera_covariance: Array | None, plate: Plate | None
    ) -> None:
        self.given = camera
        self.known = poses
        self.plate = plate
        self.bows = 0 if plate is None else BOWS
        self.stripes = Stripes(
            [pose.stripes for pose in poses], [pose.pose for pose in poses], None if plate is None else plate.board
        )
        self.heights = [np.zeros((len(pose.view.points), self.bows)) for pose in poses]
        if plate is not None:
            self.heights = [plate.board.changes(pose.view.points)[:, 2, :BOWS] for pose in poses]
        ends = np.cumsum([0, *(2 * len(pose.view.points) for pose in poses)])
        self.rows = [slice(int(first), int(last)) for first, last in pairwise(ends)]
        self.corners = int(ends[-1])
        self.free, self.whiten = _whitening(camera_covariance)
        self.corner_scale = 1.0
        self.extra = np.zeros(self.stripes.parts)
        self.noise = np.ones(len(self.stripes))
        self.weight = np.ones(len(self.stripes))

    def solve(self, planes: PlaneSet, rounds: int) -> Bundle:
        state = _State(planes, tuple(pose.pose for pose in self.known), np.zeros(self.bows), np.zeros(PARAMETERS))
        self.noise = self.stripes.noise_mm(state.planes, state.poses)
        self.extra = np.median(np.abs(self._distances(state).mm), axis=0)
        solution = minimise(state, self._linearise, self._move)
        for _ in range(rounds):
            before = np.array([self.corner_scale, *self.extra])
            self._reweight(solution)
            solution = minimise(solution.state, self._linearise, self._move)
            after = np.array([self.corner_scale, *self.extra])
            if np.all(np.abs(after - before) < 0.02 * before + 1e-6):
                break
        return self._result(solution)

    def _camera(self, state: _State) -> Camera:
        if not state.camera.any():
            return self.given
        return reprojection.camera_of(reprojection.parameters_of(self.given) + state.camera, self.given.image_size)

    def _distances(self, state: _State) -> Distances:
        return self.stripes.distances(state.planes, state.poses, state.camera, state.bow)

    def _sd(self) -> Array:
        """Standard deviations (S, K) in mm of the stripes' offsets, slopes and bends."""
        return np.asarray(np.hypot(self.noise[:, None], self.extra), dtype=np.float64)

    def _linearise(self, state: _State) -> tuple[Array, Array]:
        """Residuals and Jacobian by the unknowns, what is known of the camera included."""
        residuals, jacobian = self._observed(state)
        known = jacobian.shape[1] - PARAMETERS
        if not len(self.free):
            return residuals, jacobian[:, :known]
        columns = np.concatenate([np.arange(known), known + self.free])
        prior = np.hstack([np.zeros((len(self.free), known)), self.whiten])
        return (
            np.concatenate([self.whiten @ state.camera[self.free], residuals]),
            np.vstack([prior, jacobian[:, columns]]),
        )

    def _observed(self, state: _State) -> tuple[Array, Array]:
        """Residuals of the bows, target points and stripes in standard deviations, and their Jacobian, all columns."""
        unknowns = state.planes.jacobian.shape[1]
        width = unknowns + 6 * len(state.poses) + self.bows + PARAMETERS
        bows = slice(width - PARAMETERS - self.bows, width - PARAMETERS)
        residuals, blocks = self._known_of_bows(state, width, bows)
        points = self._target_points(state)
        block = np.zeros((self.corners, width))
        block[:, -PARAMETERS - self.bows :] = points[:, 7:]
        for index, rows in enumerate(self.rows):
            block[rows, unknowns + 6 * index : unknowns + 6 * index + 6] = points[rows, 1:7]
        residuals.append(points[:, 0])
        blocks.append(block)
        distances = self._distances(state)
        weight = np.sqrt(self.weight)[:, None] / self._sd()
        block = np.zeros((*distances.mm.shape, width))
        block[..., :unknowns] = distances.by_planes
        block[..., bows] = distances.by_bow
        block[..., -PARAMETERS:] = distances.by_camera
        columns = unknowns + 6 * self.stripes.pose_of[:, None] + np.arange(6)
        np.put_along_axis(block, np.repeat(columns[:, None], self.stripes.parts, axis=1), distances.by_pose, axis=2)
        residuals.append((distances.mm * weight).ravel())
        blocks.append((block * weight[..., None]).reshape(-1, width))
        return np.concatenate(residuals), np.vstack(blocks)

    def _target_points(self, state: _State) -> Array:
        """Residuals of all target points in standard deviations and their derivatives by pose, bows and camera.

        (2N, 1 + 6 + B + 10). All poses are seen at once: most of the time of a fit goes here.
        """
        heights = np.concatenate(self.heights)
        turned = np.concatenate(
            [
                (known.view.points + np.outer(own @ state.bow, _UP)) @ pose.rotation.T
                for known, own, pose in zip(self.known, self.heights, state.poses, strict=True)
            ]
        )
        count = [len(own) for own in self.heights]
        places = turned + np.repeat([pose.translation for pose in state.poses], count, axis=0)
        uv, by_camera, by_pose = reprojection.linearise(self._camera(state), Pose.identity(), places)
        by_place = by_pose[:, :, 3:]
        up = np.repeat([pose.rotation[:, 2] for pose in state.poses], count, axis=0)
        by_bow = np.einsum("nij,nj->ni", by_place, up)[:, :, None] * heights[:, None]
        off = (uv - np.concatenate([known.view.uv for known in self.known]))[..., None]
        every = np.concatenate([off, np.cross(turned[:, None], by_place), by_place, by_bow, by_camera], axis=2)
        whitened = [
            known.view.whitened(every[rows.start // 2 : rows.stop // 2])
            for known, rows in zip(self.known, self.rows, strict=True)
        ]
        return np.concatenate(whitened) / self.corner_scale

    def _known_of_bows(self, state: _State, width: int, columns: slice) -> tuple[list[Array], list[Array]]:
        """Residuals and rows of the Jacobian that hold the plate to its flatness."""
        if self.plate is None:
            return [], []
        rows = np.zeros((self.bows, width))
        rows[:, columns] = np.eye(self.bows) / self.plate.flatness_mm
        return [state.bow / self.plate.flatness_mm], [rows]

    def _move(self, state: _State, step: Array) -> _State:
        first = state.planes.jacobian.shape[1]
        last = first + 6 * len(state.poses)
        bow = state.bow + step[last : last + self.bows]
        steps: list[NDArray[np.float64]] = list(step[first:last].reshape(-1, 6))
        poses = tuple(reprojection.moved(pose, own) for pose, own in zip(state.poses, steps, strict=True))
        camera = state.camera.copy()
        camera[self.free] += step[last + self.bows :]
        return _State(state.planes.moved(step[:first]), poses, bow, camera)

    def _reweight(self, solution: Solution[_State]) -> None:
        """Improve the standard deviations and the stripes' weights from residuals and redundancies."""
        share = ((solution.jacobian @ solution.covariance) * solution.jacobian).sum(axis=1)
        first = len(self.free) + self.bows
        end = first + self.corners
        of_corners = slice(first, end)
        corner = _variance_factor(solution.residuals[of_corners], share[of_corners])
        self.corner_scale = float(np.clip(self.corner_scale * np.sqrt(corner), *CORNER_SCALE_RANGE))
        own = float(np.median(self.noise) ** 2)
        for part in range(self.stripes.parts):
            rows = slice(end + part, None, self.stripes.parts)
            factor = _variance_factor(solution.residuals[rows], share[rows])
            self.extra[part] = np.sqrt(max(factor * self.extra[part] ** 2 + (factor - 1) * own, 0.0))
        self.weight = huber_weights(self._errors(solution))

    def _errors(self, solution: Solution[_State]) -> Array:
        """RMS (S,) of each stripe's residuals in their standard deviations."""
        distances = self._distances(solution.state).mm / self._sd()
        return np.asarray(np.sqrt((distances**2).mean(axis=1)), dtype=np.float64)

    def _result(self, solution: Solution[_State]) -> Bundle:
        state = solution.state
        unknowns = state.planes.jacobian.shape[1]
        residuals, jacobian = self._observed(state)
        alone, by_camera = jacobian[:, :-PARAMETERS], jacobian[:, -PARAMETERS:]
        local = Solution(state, residuals, alone, solution.converged).covariance
        stripes = alone[-self.stripes.parts * len(self.stripes) :]
        to_pis = state.planes.jacobian
        corrected = None
        if len(self.free):
            corrected = np.zeros((PARAMETERS, PARAMETERS))
            last = len(self.free)
            corrected[np.ix_(self.free, self.free)] = solution.covariance[-last:, -last:]
        return Bundle(
            planes=state.planes,
            covariance=to_pis @ local[:unknowns, :unknowns] @ to_pis.T,
            by_camera=-to_pis @ (local[:unknowns] @ (alone.T @ by_camera)),
            camera=self._camera(state),
            camera_covariance=corrected,
            poses=state.poses,
            shape=self._shape(state.bow, local[len(local) - self.bows :, len(local) - self.bows :]),
            freedom=len(stripes) - float(((stripes @ local) * stripes).sum()),
            corner_scale=self.corner_scale,
            extra_mm=float(self.extra[0] / np.sqrt(2)),
            pose_errors=self._pose_errors(solution, residuals),
        )

    def _shape(self, bow: Array, covariance: Array) -> BoardShape:
        if self.plate is None:
            return BoardShape()
        values, own = np.zeros(len(SHAPE_PARAMETERS)), np.zeros((len(SHAPE_PARAMETERS), len(SHAPE_PARAMETERS)))
        values[:BOWS], own[:BOWS, :BOWS] = bow, covariance
        return BoardShape(self.plate.board, values, own)

    def _pose_errors(self, solution: Solution[_State], residuals: Array) -> Array:
        count = len(self.known)
        pose_of = self.stripes.pose_of
        summed = np.bincount(pose_of, self._errors(solution) ** 2, minlength=count)
        stripes = summed / np.maximum(np.bincount(pose_of, minlength=count), 1)
        of_corners = residuals[self.bows : self.bows + self.corners]
        corners = [float((of_corners[rows] ** 2).mean()) for rows in self.rows]
        return np.asarray(np.sqrt(np.maximum(stripes, corners)), dtype=np.float64)


def _whitening(covariance: Array | None) -> tuple[NDArray[np.intp], Array]:
    """Indices (F,) of the parameters with a variance, and the matrix (F, F) that whitens them; none without any."""
    variance = np.zeros(PARAMETERS) if covariance is None else np.diag(covariance)
    free = np.flatnonzero(variance > 0)
    if covariance is None or not len(free):
        return free, np.zeros((0, 0))
    sd = np.sqrt(variance[free])
    values, vectors = np.linalg.eigh(covariance[np.ix_(free, free)] / np.outer(sd, sd))
    whiten: Array = (vectors / np.sqrt(np.maximum(values, 1e-12 * values[-1]))).T / sd
    return free, whiten


def _variance_factor(residuals: Array, share: Array) -> float:
    """Sum of squares over redundancy, held to 1 by PRIOR_FREEDOM further residuals of expected size."""
    freedom = max(len(residuals) - float(share.sum()), 0.0)
    return (float(residuals @ residuals) + PRIOR_FREEDOM) / (freedom + PRIOR_FREEDOM)
