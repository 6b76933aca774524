"""View of a surface as the user left it, so that a report can show it so. Light to import."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.model.arrays import Array, frozen_array, set_field


@dataclass(frozen=True, eq=False, slots=True)
class SeenFrom:
    """View of the surface, in mm of the camera frame.

    Parameters
    ----------
    axes
        (3, 3) unit vectors in rows: right, up and towards the viewer.
    focal
        (3,) what is in the middle.
    half_height_mm
        Half the height of what is seen there.
    aspect
        Width of the view by its height.
    hidden
        A place (3,) and the unit vector (3,) beyond which the surface is hidden, as rows (2, 3); None: nothing is.

    Raises
    ------
    ValueError
        If a shape does not match or a number is not finite.
    """

    axes: Array
    focal: Array
    half_height_mm: float
    aspect: float
    hidden: Array | None = None

    def __post_init__(self) -> None:
        set_field(self, "axes", frozen_array(self.axes, (3, 3), "axes"))
        set_field(self, "focal", frozen_array(self.focal, (3,), "focal"))
        if self.hidden is not None:
            set_field(self, "hidden", frozen_array(self.hidden, (2, 3), "hidden"))

    def hides(self, points: Array) -> NDArray[np.bool_]:
        """Compute flags (N,) of the points (N, 3) in mm that a cutting plane hid in the view."""
        if self.hidden is None:
            return np.zeros(len(points), dtype=bool)
        place, towards = self.hidden
        return np.asarray((points - place) @ towards > 0)

    def in_sight(self, points: Array) -> NDArray[np.bool_]:
        """Compute flags (N,) of the points (N, 3) in mm that were within the view and not hidden."""
        x, y = self.axes[:2] @ (points - self.focal).T
        within = (np.abs(x) <= self.half_height_mm * self.aspect) & (np.abs(y) <= self.half_height_mm)
        return np.asarray(within & ~self.hides(points))

    @property
    def words(self) -> str:
        """Numbers of the view as one line of text, equal for two views that show the same."""
        parts = [self.axes, self.focal, self.half_height_mm, self.aspect, *([] if self.hidden is None else self.hidden)]
        return " ".join(f"{number:.6g}" for part in parts for number in np.ravel(part) + 0.0)
