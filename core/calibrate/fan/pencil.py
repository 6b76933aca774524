"""Light planes as unknowns: each on its own, or tied into one pencil.

The planes of a pencil share an axis. With R = (e1 | e2 | d), d along the axis, and a point a on it, the plane at
angle φ about the axis has the normal n = e1 cos φ + e2 sin φ and is π = n / (n·a). The local unknowns are two small
rotations that tilt the axis, two shifts of the axis along e1 and e2, and the angles: one common turn when the angles
between neighbours are fixed (five unknowns, the paper's constraint), or one per plane.

References
----------
Sun et al., Sensors 2023, 23, 13, §3.2, doi:10.3390/s23010013; its eq. (4) minimises algebraic residuals, which
depend on the scale of the coefficients: here orthogonal distances are minimised.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.spatial.transform import Rotation

from core.model.arrays import Array, frozen_array, set_field


class PlaneSet(Protocol):
    """N light planes described by local unknowns."""

    @property
    def pis(self) -> Array:
        """Vectors π (N, 3) in 1/mm of all light planes."""

    @property
    def jacobian(self) -> Array:
        """Derivatives (3N, P) of all light planes' π by a step of the P parameters."""

    def moved(self, step: Array) -> PlaneSet:
        """Move the light planes by a `step` (P,) of their parameters."""


@dataclass(frozen=True, eq=False, slots=True)
class FreePlanes:
    """Planes without a constraint between them: 3N unknowns, `pis` (N, 3) in 1/mm."""

    pis: Array

    def __post_init__(self) -> None:
        set_field(self, "pis", frozen_array(self.pis, (None, 3), "pis"))

    @property
    def jacobian(self) -> Array:
        return np.eye(self.pis.size)

    def moved(self, step: Array) -> FreePlanes:
        return FreePlanes(self.pis + step.reshape(-1, 3))


@dataclass(frozen=True, eq=False, slots=True)
class Pencil:
    """Planes through one axis.

    Parameters
    ----------
    frame
        (3, 3) rotation with columns e1, e2 and the axis d.
    point
        (3,) in mm, on the axis.
    angles
        (N,) in rad, each plane's angle about the axis, counted from e1.
    fixed_angles
        True: the angles between neighbours stay as they are (5 unknowns); False: all are unknown (4 + N).
    """

    frame: Array
    point: Array
    angles: Array
    fixed_angles: bool

    def __post_init__(self) -> None:
        set_field(self, "frame", frozen_array(self.frame, (3, 3), "frame"))
        set_field(self, "point", frozen_array(self.point, (3,), "point"))
        set_field(self, "angles", frozen_array(self.angles, (None,), "angles"))

    @property
    def _normals(self) -> Array:
        return np.column_stack([np.cos(self.angles), np.sin(self.angles)]) @ self.frame[:, :2].T

    @property
    def pis(self) -> Array:
        normals = self._normals
        pis: Array = normals / (normals @ self.point)[:, None]
        return pis

    @property
    def jacobian(self) -> Array:
        normals = self._normals
        cosine, sine = np.cos(self.angles)[:, None], np.sin(self.angles)[:, None]
        e1, e2, axis = self.frame.T
        count = len(self.angles)
        turned = cosine * e2 - sine * e1  # ∂n/∂φ
        by_angle = np.zeros((count, 3, count))
        by_angle[np.arange(count), :, np.arange(count)] = turned
        if self.fixed_angles:
            by_angle = by_angle.sum(axis=2, keepdims=True)
        tilts = np.stack([sine * axis, -cosine * axis], axis=2)
        normal_steps = np.concatenate([tilts, np.zeros((count, 3, 2)), by_angle], axis=2)
        distances = normals @ self.point
        distance_steps = np.einsum("kip,i->kp", normal_steps, self.point)
        distance_steps[:, 2:4] += np.hstack([cosine, sine])
        steps = normal_steps / distances[:, None, None]
        steps -= normals[:, :, None] * (distance_steps / distances[:, None] ** 2)[:, None, :]
        return np.asarray(steps.reshape(3 * count, -1), dtype=np.float64)

    def moved(self, step: Array) -> Pencil:
        frame = self.frame @ Rotation.from_rotvec([step[0], step[1], 0.0]).as_matrix()
        point = self.point + self.frame[:, :2] @ step[2:4]
        return Pencil(frame, point, self.angles + step[4:], self.fixed_angles)


def pencil_near(pis: Array, angle: float | None) -> Pencil:
    """Find a pencil, planes through one axis, near N ≥ 2 light planes `pis`: a start for a fit.

    Parameters
    ----------
    pis
        (N, 3) in 1/mm, in order across the fan.
    angle
        In rad between neighbours, which it then fixes; None leaves every angle free.
    """
    inverse_distance = np.linalg.norm(pis, axis=1)
    normals, distances = pis / inverse_distance[:, None], 1 / inverse_distance
    sides = np.where(normals @ normals[0] < 0, -1.0, 1.0)
    normals, distances = normals * sides[:, None], distances * sides
    axis = np.linalg.svd(normals)[2][2]
    if np.cross(normals[0], normals[-1]) @ axis < 0:
        axis = -axis
    mean = normals.sum(axis=0) - normals.sum(axis=0) @ axis * axis
    e1 = mean / np.linalg.norm(mean)
    e2 = np.cross(axis, e1)
    angles = np.arctan2(normals @ e2, normals @ e1)
    point = np.linalg.lstsq(np.vstack([normals, axis]), np.append(distances, 0.0), rcond=None)[0]
    if angle is not None:
        count = len(pis)
        angles = angles.mean() + angle * (np.arange(count) - (count - 1) / 2)
    return Pencil(np.column_stack([e1, e2, axis]), point, angles, fixed_angles=angle is not None)


def plane_distances(pis: Array, points: Array) -> tuple[Array, Array]:
    """Compute signed distances (N,) in mm of `points` (N, 3) from planes `pis` (N, 3), and their derivatives by π."""
    length = np.linalg.norm(pis, axis=1)
    distances = (np.einsum("ni,ni->n", pis, points) - 1) / length
    by_pi = (points - distances[:, None] * pis / length[:, None]) / length[:, None]
    return distances, by_pi
