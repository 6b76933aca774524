"""Marks of a carrier that a view's picture shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.image.targets.coded_rings import find_rings
from core.image.targets.picture import Picture
from core.model.arrays import Array, frozen_array, set_field
from core.views.carrier import Carrier

SYSTEMATIC_PX = 0.012
"""What is left of a disc's centre in rendered pictures, RMS per coordinate, beside the scatter of its outline: the
code ring's blur, and discs of few pixels."""


@dataclass(frozen=True, eq=False, slots=True)
class MarksSeen:
    """Marks seen in one view, by their numbers.

    Parameters
    ----------
    numbers
        (n,) of the marks.
    uv
        (n, 2) in px: the centres of their discs' ellipses, with the perspective's shift still in them.
    covariance
        (n, 2, 2) in px² of each.
    view
        Name of the view.
    """

    numbers: NDArray[np.int64]
    uv: Array
    covariance: Array
    view: str = ""

    def __post_init__(self) -> None:
        count = len(self.uv)
        set_field(self, "uv", frozen_array(self.uv, (count, 2), "uv"))
        set_field(self, "covariance", frozen_array(self.covariance, (count, 2, 2), "covariance"))
        index = np.array(self.numbers, dtype=np.int64).reshape(count)
        index.flags.writeable = False
        set_field(self, "numbers", index)

    def __len__(self) -> int:
        return len(self.uv)

    def select(self, keep: NDArray[np.bool_]) -> MarksSeen:
        """Select marks by a mask (n,)."""
        return MarksSeen(self.numbers[keep], self.uv[keep], self.covariance[keep], self.view)


def see_marks(picture: Picture, carrier: Carrier, view: str = "") -> MarksSeen:
    """Find a carrier's coded rings in a picture (H, W) of a view, the fan on or all lasers off."""
    rings = find_rings(picture, set(carrier.numbers.tolist()))
    sigma = np.array([np.hypot(ring.ellipse.sigma, SYSTEMATIC_PX) for ring in rings])
    return MarksSeen(
        np.array([ring.number for ring in rings], dtype=np.int64),
        np.array([ring.ellipse.centre for ring in rings]).reshape(-1, 2),
        sigma[:, None, None] ** 2 * np.eye(2) if len(rings) else np.zeros((0, 2, 2)),
        view,
    )
