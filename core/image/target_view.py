"""What one picture shows of a calibration target."""

from __future__ import annotations

from dataclasses import dataclass

from core.model.arrays import Array, frozen_array, set_field


@dataclass(frozen=True, eq=False, slots=True)
class TargetView:
    """The target's marked points found in one picture.

    Parameters
    ----------
    points
        (N, 3) in mm in the target's frame, z = 0.
    uv
        (N, 2) in pixels, where they were found.
    sigma
        (N,) standard uncertainty of each coordinate of `uv`, in pixels.
    name
        The picture they were found in, for messages.
    """

    points: Array
    uv: Array
    sigma: Array
    name: str = ""

    def __post_init__(self) -> None:
        count = len(self.points)
        set_field(self, "points", frozen_array(self.points, (count, 3), "points"))
        set_field(self, "uv", frozen_array(self.uv, (count, 2), "uv"))
        set_field(self, "sigma", frozen_array(self.sigma, (count,), "sigma"))
