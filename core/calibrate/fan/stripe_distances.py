"""How far the straight stripes on a target's poses are from the fan's light planes, and what moves them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.calibrate.board_shape import Board
from core.calibrate.fan.pencil import PlaneSet, plane_distances
from core.calibrate.fan.poses.stripe_lines import StripeLine
from core.calibrate.fan.poses.target_plane import on_target, target_plane_changes
from core.model import Pose
from core.model.arrays import Array

OFFSET_AND_SLOPE = np.array([[1.0, 1.0], [1.0, -1.0]]) / np.sqrt(2)
"""Turns the errors of a stripe's two pivots into two that a bent plate does not mix."""
BOWS = 3
"""Parameters of a bow, the first of `core.calibrate.board_shape.SHAPE_PARAMETERS`."""


@dataclass(frozen=True, eq=False, slots=True)
class Distances:
    """Distances (S, K) in mm of stripes from their light planes, and their derivatives.

    They are offset and slope and, on a plate that may be bowed, bend. `by_planes` (S, K, P) by the planes' unknowns,
    `by_pose` (S, K, 6) by the pose each stripe is on, `by_bow` (S, K, 3 or 0) by the plate's bow, `by_camera`
    (S, K, 10) by the camera's parameters.
    """

    mm: Array
    by_planes: Array
    by_pose: Array
    by_bow: Array
    by_camera: Array


class Stripes:
    """S stripes stacked, each with its pose and its fan line.

    `poses` are where the plate roughly is. `board` is its middle and extent if it may be bowed, None if it is flat.
    """

    def __init__(
        self, on_poses: Sequence[dict[int, StripeLine]], poses: Sequence[Pose], board: Board | None = None
    ) -> None:
        stripes = [(p, line, stripe) for p, lines in enumerate(on_poses) for line, stripe in lines.items()]
        self.parts = 2 if board is None else 3
        self.pose_of: NDArray[np.intp] = np.array([p for p, _, _ in stripes], dtype=np.intp)
        self.line_of: NDArray[np.intp] = np.array([line for _, line, _ in stripes], dtype=np.intp)
        self._pivots = np.array([stripe.pivots for *_, stripe in stripes])
        self._sigma = np.array([stripe.sigma for *_, stripe in stripes])
        self._across = np.array([stripe.across for *_, stripe in stripes])
        self._by_camera = np.array([stripe.by_camera for *_, stripe in stripes])
        self._bend = np.array([stripe.bend for *_, stripe in stripes])
        self._heights = np.zeros((len(stripes), self.parts, 0))
        if board is not None:
            self._heights = np.array([_heights(stripe, poses[pose], board) for pose, _, stripe in stripes])

    def __len__(self) -> int:
        return len(self.pose_of)

    def distances(
        self, planes: PlaneSet, poses: Sequence[Pose], camera_change: Array, bow: Array | None = None
    ) -> Distances:
        """Compute the stripes' distances from their light planes, with derivatives, for a plate of this `bow` (3,).

        The camera has changed by `camera_change` (10,).
        """
        pivots = self._pivots.copy()
        of_camera = self._by_camera[:, :2]
        pivots[..., :2] += (of_camera @ camera_change)[..., None] * self._across[:, None]
        target, by_step = (np.array(a)[self.pose_of] for a in zip(*map(target_plane_changes, poses), strict=True))
        pis = planes.pis[self.line_of]
        depth = 1 / np.einsum("sij,sj->si", pivots, target)
        points = pivots * depth[..., None]
        flat, by_pi = plane_distances(np.repeat(pis, 2, axis=0), points.reshape(-1, 3))
        jacobian = planes.jacobian.reshape(len(planes.pis), 3, -1)[self.line_of]
        by_planes = np.einsum("sij,sjp->sip", by_pi.reshape(-1, 2, 3), jacobian)
        length = np.linalg.norm(pis, axis=1)[:, None]
        ahead = np.einsum("sij,sj->si", pivots, pis) * depth
        by_pose = -(ahead * depth / length)[..., None] * np.einsum("sij,sjp->sip", pivots, by_step)
        by_ray = (pis[:, None] - ahead[..., None] * target[:, None]) * (depth / length)[..., None]
        across = np.einsum("sij,sj->si", by_ray[..., :2], self._across)
        by_camera = across[..., None] * of_camera
        turn = OFFSET_AND_SLOPE
        found = Distances(
            flat.reshape(-1, 2) @ turn,
            turn @ by_planes,
            turn @ by_pose,
            np.zeros((len(self), 2, 0)),
            turn @ by_camera,
        )
        if self.parts == len(turn):
            return found
        up = np.array([pose.rotation[:, 2] for pose in poses])[self.pose_of]
        per_height = ahead.mean(axis=1) / length[:, 0] * np.einsum("si,si->s", target, up)
        bent = np.sqrt(2) * across.mean(axis=1)
        return self._bowed(found, per_height, bent, camera_change, np.zeros(BOWS) if bow is None else bow)

    def _bowed(self, flat: Distances, per_height: Array, bent: Array, camera_change: Array, bow: Array) -> Distances:
        """`flat` distances with the bend and what the plate's `bow` adds.

        `per_height` and `bent` (S,) are the distances that a height of the plate and the bend of the line make. How
        they change with plane and pose counts for nothing: both are small.
        """
        by_bow = per_height[:, None, None] * self._heights
        mm = np.column_stack([flat.mm, bent * (self._bend + self._by_camera[:, 2] @ camera_change)])

        def with_bend(derivative: Array) -> Array:
            return np.pad(derivative, ((0, 0), (0, 1), (0, 0)))

        by_camera = with_bend(flat.by_camera)
        by_camera[:, 2] = bent[:, None] * self._by_camera[:, 2]
        return Distances(mm + by_bow @ bow, with_bend(flat.by_planes), with_bend(flat.by_pose), by_bow, by_camera)

    def noise_mm(self, planes: PlaneSet, poses: Sequence[Pose]) -> Array:
        """Compute the noise (S,) of each stripe's place, as its distance in mm from the light plane."""
        target = np.array([target_plane_changes(pose)[0] for pose in poses])[self.pose_of]
        pis = planes.pis[self.line_of]
        middle = self._pivots.mean(axis=1)
        depth = 1 / np.einsum("si,si->s", middle, target)
        ahead = np.einsum("si,si->s", pis, middle) * depth
        by_ray = (pis - ahead[:, None] * target) * (depth / np.linalg.norm(pis, axis=1))[:, None]
        return np.asarray(np.abs(np.einsum("si,si->s", by_ray[:, :2], self._across)) * self._sigma, dtype=np.float64)


def _heights(stripe: StripeLine, pose: Pose, board: Board) -> Array:
    """(3, 3): what each unit of a bow adds to offset, slope and bend of the plate's height in mm along a stripe."""
    on_plate = pose.inverse().apply(on_target(stripe.rays, pose))
    heights = stripe.moments @ board.changes(on_plate)[:, 2, :BOWS]
    heights[1] *= -1  # as OFFSET_AND_SLOPE has it
    return np.asarray(np.sqrt(2) * heights, dtype=np.float64)
