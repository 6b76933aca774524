"""A turn of lasers about a line along the viewing direction."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from core.model import LightPlane
from core.model.arrays import Array
from core.simulate.scene.laser import Sheet


@dataclass(frozen=True, eq=False, slots=True)
class Turn:
    """Rotation (3, 3) about the line along z through a point (3,) in mm."""

    rotation: Array
    through: Array

    @classmethod
    def about_the_view(cls, through: Array, degrees: float) -> Turn:
        """Make the rotation by `degrees` about the line along the camera's z through the point `through` (3,) in mm."""
        return cls(Rotation.from_euler("z", degrees, degrees=True).as_matrix(), np.asarray(through, dtype=np.float64))

    def point(self, point: Array) -> Array:
        """Rotate a point (3,) in mm, camera frame."""
        return np.asarray(self.rotation @ (point - self.through) + self.through)

    def plane(self, plane: LightPlane) -> LightPlane:
        """Rotate a light plane."""
        normal = self.rotation @ plane.normal
        return LightPlane(normal / (plane.d_mm + (normal - plane.normal) @ self.through))

    def sheet(self, sheet: Sheet) -> Sheet:
        """Rotate a laser sheet, which must not move within the exposure."""
        return replace(
            sheet,
            plane=self.plane(sheet.plane),
            emitter=self.point(sheet.emitter),
            axis=self.rotation @ sheet.axis,
        )
