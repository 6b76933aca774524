"""How far the straight stripes on a target's poses are from the fan's light planes, and what moves them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.calibrate.pencil import PlaneSet, plane_distances
from core.calibrate.stripe_lines import StripeLine
from core.calibrate.target_plane import target_plane_changes
from core.model import Pose
from core.model.arrays import Array

OFFSET_AND_SLOPE = np.array([[1.0, 1.0], [1.0, -1.0]]) / np.sqrt(2)
"""Turns the errors of a stripe's two pivots into two that a bent plate does not mix."""


@dataclass(frozen=True, eq=False, slots=True)
class Distances:
    """Distances (S, 2) in mm of stripes from their light planes, offset and slope, and their derivatives.

    `by_planes` (S, 2, P) by the planes' unknowns, `by_pose` (S, 2, 6) by the pose each stripe is on, `by_camera`
    (S, 2, 10) by the camera's parameters.
    """

    mm: Array
    by_planes: Array
    by_pose: Array
    by_camera: Array


class Stripes:
    """S stripes, each on a pose and of a fan line, stacked."""

    def __init__(self, on_poses: Sequence[dict[int, StripeLine]]) -> None:
        stripes = [(p, line, stripe) for p, lines in enumerate(on_poses) for line, stripe in lines.items()]
        self.pose_of: NDArray[np.intp] = np.array([p for p, _, _ in stripes], dtype=np.intp)
        self.line_of: NDArray[np.intp] = np.array([line for _, line, _ in stripes], dtype=np.intp)
        self._pivots = np.array([stripe.pivots for *_, stripe in stripes])
        self._sigma = np.array([stripe.sigma for *_, stripe in stripes])
        self._across = np.array([stripe.across for *_, stripe in stripes])
        self._by_camera = np.array([stripe.by_camera for *_, stripe in stripes])

    def __len__(self) -> int:
        return len(self.pose_of)

    def distances(self, planes: PlaneSet, poses: Sequence[Pose], camera_change: Array) -> Distances:
        """Where the stripes are, seen by a camera `camera_change` (10,) from the one they came by."""
        pivots = self._pivots.copy()
        pivots[..., :2] += (self._by_camera @ camera_change)[..., None] * self._across[:, None]
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
        by_camera = np.einsum("sij,sj->si", by_ray[..., :2], self._across)[..., None] * self._by_camera
        turn = OFFSET_AND_SLOPE
        return Distances(flat.reshape(-1, 2) @ turn, turn @ by_planes, turn @ by_pose, turn @ by_camera)

    def noise_mm(self, planes: PlaneSet, poses: Sequence[Pose]) -> Array:
        """A stripe's own noise (S,) across its line of rays, seen as a distance in mm from the light plane."""
        target = np.array([target_plane_changes(pose)[0] for pose in poses])[self.pose_of]
        pis = planes.pis[self.line_of]
        middle = self._pivots.mean(axis=1)
        depth = 1 / np.einsum("si,si->s", middle, target)
        ahead = np.einsum("si,si->s", pis, middle) * depth
        by_ray = (pis - ahead[:, None] * target) * (depth / np.linalg.norm(pis, axis=1))[:, None]
        return np.asarray(np.abs(np.einsum("si,si->s", by_ray[:, :2], self._across)) * self._sigma, dtype=np.float64)
