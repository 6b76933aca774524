"""What the poses of a fan's calibration show, as residuals of all unknowns and their derivatives.

The unknowns are the planes, the target's poses, the plate's bow if it may have one, and the camera's ten parameters. A
pose of a small target is known less well than the stripes on it, and its error is common to all of them; but stripes of
the same light planes on other poses know something of it. So the poses are held by the residuals of the target's
points, and the stripes by their distances from the light planes.

A plate whose flatness is only known to a tolerance is a second-degree surface (`core.calibrate.board_shape`), the same
in all poses, its three bows unknowns with that tolerance as prior. The bend of the stripes tells them, and how stripes
and target points of differently held plates agree.

The poses are views of a flat target too. With the camera's covariance its parameters are unknowns as well, held by
what its own views know of them: a calibration with its covariance is the normal equations of all its views with their
poses eliminated, so this is, to first order, the adjustment of all pictures in one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from core.calibrate.board_shape import SHAPE_PARAMETERS, Board, BoardShape
from core.calibrate.camera import reprojection
from core.calibrate.fan.pencil import PlaneSet
from core.calibrate.fan.pose_equations import PoseEquations, inverse
from core.calibrate.fan.poses.stripe_lines import StripeLine
from core.calibrate.fan.stripe_distances import BOWS, Distances, Stripes
from core.image.targets.target_view import TargetView
from core.model import Camera, Pose
from core.model.arrays import Array

PARAMETERS = 10
"""Of the camera."""
_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False, slots=True)
class BundlePose:
    """Pose of the target in a bundle: its points in `view`, the `pose` to start from, and the fan lines' stripes."""

    view: TargetView
    pose: Pose
    stripes: dict[int, StripeLine]


@dataclass(frozen=True, eq=False, slots=True)
class Plate:
    """Plate that may be bowed: its extent, and the prior of its bow, values (3,) and covariance (3, 3) in mm."""

    board: Board
    bow: Array
    covariance: Array

    @classmethod
    def flat_within(cls, board: Board, flatness_mm: float) -> Plate:
        """Make a plate that may be bowed: its edges are off its plane by a standard deviation of `flatness_mm`."""
        return cls(board, np.zeros(BOWS), flatness_mm**2 * np.eye(BOWS))

    @property
    def whiten(self) -> Array:
        """Matrix (3, 3) that turns the plate's bow parameters into independent numbers of unit variance."""
        return np.asarray(np.linalg.inv(np.linalg.cholesky(self.covariance)), dtype=np.float64)


@dataclass(frozen=True, eq=False, slots=True)
class State:
    """Unknowns of the bundle.

    `bow` (3 or 0,) in mm is the plate's, `camera` (10,) the change of the camera's parameters.
    """

    planes: PlaneSet
    poses: tuple[Pose, ...]
    bow: Array
    camera: Array


@dataclass(frozen=True, eq=False, slots=True)
class ObservationWeights:
    """Weights of the target points and stripes.

    `corner_scale` is a factor on the stated uncertainty of the target's points, `noise` (S,) in mm the stripes' own,
    `extra` (K,) in mm what their offsets, slopes and bends have beyond it, `weight` (S,) of each stripe.
    """

    corner_scale: float
    noise: Array
    extra: Array
    weight: Array

    @property
    def sd(self) -> Array:
        """Standard deviations (S, K) in mm of the offsets, slopes and bends of S stripes."""
        return np.asarray(np.hypot(self.noise[:, None], self.extra), dtype=np.float64)


class Observations:
    """Target points and stripes of all poses, stacked once.

    The unknowns that all poses have in common are the planes', the plate's bows if it may have any, and the camera's
    ten parameters, in this order; each pose has six of its own.
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
        of_pose = np.concatenate(
            [
                np.repeat(np.arange(len(poses)), [rows.stop - rows.start for rows in self.rows]),
                np.repeat(self.stripes.pose_of, self.stripes.parts),
            ]
        )
        self.rows_of_pose = [np.flatnonzero(of_pose == pose) for pose in range(len(poses))]
        self.free, self.whiten = _whitening(camera_covariance)

    def camera(self, state: State) -> Camera:
        """Make the camera that has the parameters of this `state`."""
        if not state.camera.any():
            return self.given
        return reprojection.camera_of(reprojection.parameters_of(self.given) + state.camera, self.given.image_size)

    def distances(self, state: State) -> Distances:
        """Compute the distances of all stripes from their light planes at this `state`, with derivatives."""
        return self.stripes.distances(state.planes, state.poses, state.camera, state.bow)

    def linearise(self, state: State, trust: ObservationWeights) -> PoseEquations:
        """Make the equations of all target points, stripes and priors at this `state`, for the free unknowns."""
        residuals, common, own = self.observed(state, trust)
        known = common.shape[1] - PARAMETERS
        prior, by_bow = self._known_of_bows(state, known)
        by_camera = np.hstack([np.zeros((len(self.free), known)), self.whiten])
        by_bow = np.hstack([by_bow, np.zeros((len(by_bow), len(self.free)))])
        return PoseEquations(
            residuals,
            common[:, np.concatenate([np.arange(known), known + self.free])],
            own,
            self.rows_of_pose,
            (np.concatenate([prior, self.whiten @ state.camera[self.free]]), np.vstack([by_bow, by_camera])),
        )

    def with_every_camera_parameter(self, state: State, trust: ObservationWeights) -> PoseEquations:
        """Make the equations at this `state` with all camera parameters as unknowns, and no prior on the camera."""
        residuals, common, own = self.observed(state, trust)
        prior, by_bow = self._known_of_bows(state, common.shape[1])
        return PoseEquations(residuals, common, own, self.rows_of_pose, (prior, by_bow))

    def observed(self, state: State, trust: ObservationWeights) -> tuple[Array, Array, Array]:
        """Compute the residuals (M,) of target points and stripes in standard deviations, and their derivatives.

        These are by the common unknowns (M, C) and by those of the pose each is of (M, 6).
        """
        unknowns = state.planes.jacobian.shape[1]
        width = unknowns + self.bows + PARAMETERS
        points = self._target_points(state) / trust.corner_scale
        of_points = np.hstack([np.zeros((self.corners, unknowns)), points[:, 7:]])
        distances = self.distances(state)
        weight = np.sqrt(trust.weight)[:, None] / trust.sd
        of_stripes = np.concatenate([distances.by_planes, distances.by_bow, distances.by_camera], axis=2)
        return (
            np.concatenate([points[:, 0], (distances.mm * weight).ravel()]),
            np.vstack([of_points, (of_stripes * weight[..., None]).reshape(-1, width)]),
            np.vstack([points[:, 1:7], (distances.by_pose * weight[..., None]).reshape(-1, 6)]),
        )

    def expected_mm(self, state: State, trust: ObservationWeights) -> float:
        """Compute the RMS in mm that noise alone makes of the stripes' offsets and slopes."""
        points, distances = self._target_points(state), self.distances(state)
        by_pose = [points[rows, 1:7] for rows in self.rows]
        covariance = np.array([inverse(own.T @ own) for own in by_pose])[self.stripes.pose_of]
        of_pose = np.einsum("skp,spq,skq->sk", distances.by_pose[:, :2], covariance, distances.by_pose[:, :2])
        return float(np.sqrt(np.mean(of_pose + trust.noise[:, None] ** 2)))

    def _target_points(self, state: State) -> Array:
        """Residuals of all target points in stated standard deviations and their derivatives by pose, bows and camera.

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
        uv, by_camera, by_pose = reprojection.linearise(self.camera(state), Pose.identity(), places)
        by_place = by_pose[:, :, 3:]
        up = np.repeat([pose.rotation[:, 2] for pose in state.poses], count, axis=0)
        by_bow = np.einsum("nij,nj->ni", by_place, up)[:, :, None] * heights[:, None]
        off = (uv - np.concatenate([known.view.uv for known in self.known]))[..., None]
        every = np.concatenate([off, np.cross(turned[:, None], by_place), by_place, by_bow, by_camera], axis=2)
        whitened = [
            known.view.whitened(every[rows.start // 2 : rows.stop // 2])
            for known, rows in zip(self.known, self.rows, strict=True)
        ]
        return np.concatenate(whitened)

    def _known_of_bows(self, state: State, width: int) -> tuple[Array, Array]:
        """Residuals of what is known of the plate's flatness, and their derivatives by the first `width` unknowns."""
        first = state.planes.jacobian.shape[1]
        rows = np.zeros((self.bows, width))
        if self.plate is None:
            return np.zeros(0), rows
        whiten = self.plate.whiten
        rows[:, first : first + self.bows] = whiten
        return np.asarray(whiten @ (state.bow - self.plate.bow), dtype=np.float64), rows

    def move(self, state: State, step: Array) -> State:
        """Move a `state` by a `step` (P,) of all free unknowns, poses included."""
        first = state.planes.jacobian.shape[1]
        last = first + self.bows + len(self.free)
        steps: list[NDArray[np.float64]] = list(step[last:].reshape(-1, 6))
        poses = tuple(reprojection.moved(pose, own) for pose, own in zip(state.poses, steps, strict=True))
        moved = self.move_common(state, step[:last])
        return State(moved.planes, poses, moved.bow, moved.camera)

    def move_common(self, state: State, step: Array) -> State:
        """Move a `state` by a `step` (C,) of the free unknowns common to all poses; the poses stay."""
        first = state.planes.jacobian.shape[1]
        bow = state.bow + step[first : first + self.bows]
        camera = state.camera.copy()
        camera[self.free] += step[first + self.bows :]
        return State(state.planes.moved(step[:first]), state.poses, bow, camera)

    def shape(self, bow: Array, covariance: Array) -> BoardShape:
        """Make the plate's shape of a `bow` (3,) or (0,) and its `covariance`; flat where no plate may bow."""
        if self.plate is None:
            return BoardShape()
        values, own = np.zeros(len(SHAPE_PARAMETERS)), np.zeros((len(SHAPE_PARAMETERS), len(SHAPE_PARAMETERS)))
        values[:BOWS], own[:BOWS, :BOWS] = bow, covariance
        return BoardShape(self.plate.board, values, own)


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
