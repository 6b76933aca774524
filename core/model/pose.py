"""Rigid motions between frames. `pose_cam_target` maps target coordinates into the camera frame.

scipy's rotations are imported where they are used: a fifth of a second that no `--help` should wait for.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from core.model.arrays import Array, frozen_array, set_field


@dataclass(frozen=True, eq=False, slots=True)
class Pose:
    """Rigid motion X_to = R X_from + t, with R (3, 3) and t (3,) in mm."""

    rotation: Array
    translation: Array

    def __post_init__(self) -> None:
        set_field(self, "rotation", frozen_array(self.rotation, (3, 3), "rotation"))
        set_field(self, "translation", frozen_array(np.ravel(self.translation), (3,), "translation"))

    @classmethod
    def identity(cls) -> Pose:
        """Make the pose that moves nothing: no rotation, no translation."""
        return cls(np.eye(3), np.zeros(3))

    @classmethod
    def from_vector(cls, vector: ArrayLike) -> Pose:
        """Make a pose from a `vector` (6,): rotation vector in rad, then translation in mm."""
        from scipy.spatial.transform import Rotation

        six = np.asarray(vector, dtype=np.float64)
        return cls(Rotation.from_rotvec(six[:3]).as_matrix(), six[3:])

    @property
    def vector(self) -> Array:
        """The pose as a vector (6,): rotation vector in rad, then translation in mm."""
        from scipy.spatial.transform import Rotation

        return np.concatenate([Rotation.from_matrix(self.rotation).as_rotvec(), self.translation])

    def apply(self, points: ArrayLike) -> Array:
        """Transform `points` (N, 3) in mm by the pose: R X + t."""
        moved: Array = np.asarray(points, dtype=np.float64) @ self.rotation.T + self.translation
        return moved

    def inverse(self) -> Pose:
        """Compute the inverse pose, which moves points back."""
        return Pose(self.rotation.T, -self.rotation.T @ self.translation)

    def __matmul__(self, other: Pose) -> Pose:
        """Composition: first `other`, then this one."""
        return Pose(self.rotation @ other.rotation, self.rotation @ other.translation + self.translation)
