"""The sub-pixel curve of one stripe of light in one picture."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from core.model.arrays import Array, frozen_array, set_field


@dataclass(frozen=True, eq=False, slots=True)
class Centreline:
    """Unbroken run of stripe points, in order along the stripe, about one pixel apart.

    A stripe cut by a depth edge or a dark gap gives several centrelines. Neighbouring points are further apart only
    across dark grains and where another stripe crosses (`core.image.stripes.lines.holes`); each lies ahead of the one
    before.

    Parameters
    ----------
    uv
        (N, 2) points in pixels, distorted image coordinates.
    normal
        (N, 2) unit vectors across the stripe; the tangent is (−normal_v, normal_u), and points run along it.
    width
        (N,) Gaussian σ of the light's cross-section in pixels, freed of the filter's own width.
    strength
        (N,) height of the cross-section over its background, in grey levels of the picture.
    sigma
        (N,) standard uncertainty of the position along the normal, in pixels.
    saturated
        (N,) True where pixels of the cross-section are saturated: weight these zero.
    correlation_px
        Length along the stripe over which the noise of neighbouring points counts as one: a mean over L px has
        sigma·√(correlation_px / L).
    skewness
        (N,) of the light's cross-section, a mean over a long stretch; positive where it reaches further towards the
        normal. 0 where it is not known (and when left out).
    """

    uv: Array
    normal: Array
    width: Array
    strength: Array
    sigma: Array
    saturated: NDArray[np.bool_]
    correlation_px: float = 1.0
    skewness: Array = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        count = len(self.uv)
        if not len(self.skewness):
            set_field(self, "skewness", np.zeros(count))
        for name, shape in (
            ("uv", (count, 2)),
            ("normal", (count, 2)),
            ("width", (count,)),
            ("strength", (count,)),
            ("sigma", (count,)),
            ("skewness", (count,)),
        ):
            set_field(self, name, frozen_array(getattr(self, name), shape, name))
        saturated = np.array(self.saturated, dtype=np.bool_).reshape(count)
        saturated.flags.writeable = False
        set_field(self, "saturated", saturated)

    def __len__(self) -> int:
        return len(self.uv)

    @property
    def tangent(self) -> Array:
        """Unit vectors (N, 2) along the stripe."""
        return np.column_stack([-self.normal[:, 1], self.normal[:, 0]])

    def select(self, keep: NDArray[np.bool_] | NDArray[np.intp] | slice) -> Centreline:
        """Select the points of the centreline by a mask (N,), by indices or by a slice."""
        return Centreline(
            self.uv[keep],
            self.normal[keep],
            self.width[keep],
            self.strength[keep],
            self.sigma[keep],
            self.saturated[keep],
            self.correlation_px,
            self.skewness[keep],
        )
