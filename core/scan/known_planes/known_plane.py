"""Model of a known plane, and all that a scan is tied to: the fan's light planes and the known planes.

A stripe point at ray r on a plane τ·X = 1 says π·r = τ·r of its sweep π, as a crossing with a light plane of the fan
does. The plane's error is common to all points on it: τ = τ₀ + L z with LLᵀ its covariance and z three standard normal
numbers.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.calibrate.camera.reprojection import parameters_of
from core.calibrate.deviations import Deviation
from core.model import Camera, Fan
from core.model.arrays import Array, frozen_array, set_field

FREEDOMS = 3
"""Numbers that a plane's error has."""
# Held by tests/pipeline/steps/test_scan_with_planes.py.
BESIDE_FAN = 100.0
"""Times as far as it is known that a plane may lie off where the fan is checked by it: so the sweeps alone say where it
is. They are not tied to planes beside a fan: the network takes it as exact, and wherever its calibration errs the two
would pull them to and fro."""
_CAMERA = 10
"""Parameters of the camera."""


@dataclass(frozen=True, eq=False, slots=True)
class KnownPlane:
    """Plane of a board in the scene, as the camera sees it: τ·X = 1 for points X on it, in the camera's frame.

    Parameters
    ----------
    name
        The board's.
    pi
        τ (3,) in 1/mm.
    outline
        (K, 2) corners in px of where it is seen.
    of_pose, of_flatness
        (3, 3) covariances of τ in 1/mm², by the noise of the board's points and by how flat it is. The camera counts
        as known.
    by_camera
        (3, 10) derivative of τ by the camera's parameters: its pictures say something else with another camera.
    marks
        (H, W) True on what is printed on it, and some px around; None: nothing is.
    scale_sd
        Relative standard uncertainty of the board's size.
    scale_assumed, flatness_assumed
        Whether nobody has stated that, or how flat it is.
    print_of
        Name of the print whose error of size is its own: boards with the same name have it in common.
    pictures
        How many pictures it was seen in.
    rms_px
        Of its points from where they should be.
    picture
        (H, W) grey levels of the first of them; None: not kept.
    """

    name: str
    pi: Array
    outline: Array
    of_pose: Array
    of_flatness: Array
    by_camera: Array
    marks: NDArray[np.bool_] | None = None
    scale_sd: float = 0.0
    scale_assumed: bool = False
    flatness_assumed: bool = False
    print_of: str = ""
    pictures: int = 1
    rms_px: float = float("nan")
    picture: NDArray[Any] | None = None

    def __post_init__(self) -> None:
        shapes = (("pi", (3,)), ("outline", (None, 2)), ("of_pose", (3, 3)), ("of_flatness", (3, 3)))
        for name, shape in (*shapes, ("by_camera", (3, _CAMERA))):
            set_field(self, name, frozen_array(getattr(self, name), shape, name))

    @property
    def covariance(self) -> Array:
        """Covariance (3, 3) of τ in 1/mm², the camera and the board's size taken as known."""
        return np.asarray(self.of_pose + self.of_flatness)

    @property
    def factor(self) -> Array:
        """L (3, 3) with LLᵀ the covariance, of full rank."""
        values, vectors = np.linalg.eigh(self.covariance)
        return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))

    def displaced(self, change: Array) -> KnownPlane:
        """Add a `change` (3,) in 1/mm to τ; how well it is known stays."""
        return replace(self, pi=self.pi + change)

    def enlarged(self, share: float, sd: float) -> KnownPlane:
        """Make the plane of a board that is larger by a `share` than it was taken for, known to `sd` beside the rest.

        It lies farther away by that share.
        """
        factor = 1 / (1 + share)
        return replace(
            self,
            pi=factor * self.pi,
            of_pose=factor**2 * self.of_pose,
            of_flatness=factor**2 * self.of_flatness,
            by_camera=factor * self.by_camera,
            scale_sd=math.hypot(self.scale_sd, sd),
        )


@dataclass(frozen=True, eq=False, slots=True)
class Control:
    """What the sweeps of a scan are tied to: the light planes of the fan, and known planes, numbered after its lines.

    A fan without lines: there is none.
    """

    fan: Fan
    planes: tuple[KnownPlane, ...] = ()

    @classmethod
    def of(cls, known: Fan | Control) -> Control:
        """Make the control that a fan alone is; one that is made already stays."""
        return known if isinstance(known, Control) else cls(known)

    @property
    def factors(self) -> Array:
        """Factors L (K, 3, 3) of the covariances of the known planes."""
        return self.loosening * np.array([plane.factor for plane in self.planes]).reshape(-1, FREEDOMS, FREEDOMS)

    @property
    def loosening(self) -> float:
        """By how many times known planes may be farther off in the equations than they are known to be."""
        return BESIDE_FAN if self.fan.lines else 1.0

    @property
    def gradient(self) -> float:
        """Typical length in 1/mm of how light planes change the inverse depth across a picture."""
        if self.fan.lines:
            return float(np.median(np.linalg.norm(self.fan.pis[:, :2], axis=1)))
        return float(np.median([np.linalg.norm(plane.pi) for plane in self.planes]))

    def pis_at(self, line: NDArray[np.int64], rays: Array) -> Array:
        """Compute the planes (M, 3) in 1/mm of each `line` (M,) where `rays` (M, 3) meet them."""
        if not self.planes:
            return self.fan.pis_at(line, rays)
        on_plane = line >= self.fan.lines
        pis = np.empty((len(line), 3))
        pis[~on_plane] = self.fan.pis_at(line[~on_plane], rays[~on_plane])
        pis[on_plane] = self.plane_pis[line[on_plane] - self.fan.lines]
        return pis

    @property
    def plane_pis(self) -> Array:
        """Vectors τ (K, 3) in 1/mm of the known planes."""
        return np.array([plane.pi for plane in self.planes]).reshape(-1, 3)

    def with_fan(self, fan: Fan) -> Control:
        """Copy the control with another fan; the known planes stay."""
        return replace(self, fan=fan)

    def behind(self, camera: Camera, other: Camera) -> Control:
        """Copy the control with the planes that their pictures would give with an `other` camera than `camera`."""
        if not self.planes or other is camera:
            return self
        change = parameters_of(other) - parameters_of(camera)
        return replace(self, planes=tuple(plane.displaced(plane.by_camera @ change) for plane in self.planes))

    def displaced(self, one: Deviation) -> Control:
        """Copy the control with fan and known planes as a deviation has them."""
        if not len(one.planes):
            return self.with_fan(one.fan)
        moved = zip(self.planes, one.planes, strict=True)
        return Control(one.fan, tuple(replace(plane, pi=pi) for plane, pi in moved))
