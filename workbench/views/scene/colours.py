"""Values to colours, and the colour bar's ticks."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.model.arrays import Array
from workbench.language import number
from workbench.views.colours import DEVIATIONS, to_rgba

Rgb = tuple[int, int, int]
ColourMap = Literal["viridis", "plasma", "deviation", "classes"]
"""viridis and plasma run from low to high, deviation is blue below, red above the middle; classes are `DEVIATIONS`, the
middle one twice as wide."""

UNKNOWN: Rgb = (140, 140, 140)
"""Colour of NaN."""

PLAIN: Rgb = (92, 142, 200)
"""Colour of a cloud without values."""

# Colours of each map, evenly from low to high. viridis and plasma: S. van der Walt, N. Smith (CC0). Their dark ends,
# which cannot be seen on a dark ground, are brightened; viridis is then that of σ on pictures.
_STOPS = {
    "viridis": "6f7ff0 4f9be0 3bb5b8 4fc987 95d94a fde725",
    "plasma": "6c5ce7 8f4bd8 b045c4 cc4778 e16462 f2844b fca636 fcce25 f0f921",
    "deviation": "1b3fae 2c64d8 4f8df0 83b2ee b0c8e0 b9bdb6 e3c0a4 efa079 e6714f cf3f36 a31326",
}


@dataclass(frozen=True, eq=False, slots=True)
class Colouring:
    """Colouring of a cloud or a mesh: by a number each, by given colours, or all in one.

    Name and unit stand over the colour bar; `limits` are the values at its ends, 1 % and 99 % of all values if not
    given.
    """

    name: str = ""
    unit: str = ""
    limits: tuple[float, float] | None = None
    colour_map: ColourMap = "viridis"
    colours: NDArray[np.uint8] | None = None
    plain_colour: Rgb = PLAIN
    clipped: tuple[bool, bool] = (False, False)
    """Whether values lie below and above the limits."""

    @property
    def title(self) -> str:
        """Name and unit of the values, as shown above the colour bar."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name

    def limited(self, values: Array) -> Colouring:
        """Return the colouring with limits; if none were given, the 1 % and 99 % quantiles of `values`."""
        finite = values[np.isfinite(values)]
        if not len(finite):
            return replace(self, limits=self.limits or (0.0, 1.0), clipped=(False, False))
        if self.limits is None:
            low, high = (float(v) for v in np.percentile(finite, [1, 99]))
            if self.colour_map == "deviation":
                high = max(abs(low), abs(high))
                low = -high
        else:
            low, high = self.limits
        if not high > low:
            low, high = low - 0.5 * max(abs(low), 1e-3), low + 0.5 * max(abs(low), 1e-3)
        slack = 1e-9 * (high - low)
        clipped = (bool(finite.min() < low - slack), bool(finite.max() > high + slack))
        return replace(self, limits=(low, high), clipped=clipped)

    def of(self, values: Array) -> NDArray[np.uint8]:
        """Map values (N,) to colours (N, 3), uint8; the colouring must have limits."""
        assert self.limits is not None
        low, high = self.limits
        with np.errstate(invalid="ignore"):
            scaled = np.clip((values - low) * (255.999 / (high - low)), 0, 255)
        known = np.isfinite(values) | np.isinf(values)
        colours = table(self.colour_map)[np.where(known, scaled, 0).astype(np.uint8)]
        colours[~known] = UNKNOWN
        return colours

    def plain(self, indices: NDArray[np.int64]) -> NDArray[np.uint8]:
        """Return the colours (N, 3) of the points numbered `indices`, for a colouring without values."""
        if self.colours is None:
            return np.tile(np.array(self.plain_colour, dtype=np.uint8), (len(indices), 1))
        colours = np.full((len(indices), 3), UNKNOWN, dtype=np.uint8)
        known = indices < len(self.colours)
        colours[known] = self.colours[indices[known]]
        return colours


@cache
def table(colour_map: ColourMap) -> NDArray[np.uint8]:
    """Return a colour map as a table of 256 colours (256, 3), uint8."""
    if colour_map == "classes":
        middle = len(DEVIATIONS) // 2
        steps = np.array([to_rgba(one)[:3] for one in (*DEVIATIONS[: middle + 1], *DEVIATIONS[middle:])])
        colours = steps[np.arange(256) * len(steps) // 256]
    else:
        stops = np.array([list(bytes.fromhex(stop)) for stop in _STOPS[colour_map].split()], dtype=np.float64)
        at = np.linspace(0, len(stops) - 1, 256)
        colours = np.column_stack([np.interp(at, np.arange(len(stops)), stops[:, i]) for i in range(3)])
    rounded: NDArray[np.uint8] = np.round(colours).astype(np.uint8)
    rounded.flags.writeable = False
    return rounded


def as_colours(colours: ArrayLike, count: int) -> NDArray[np.uint8]:
    """Convert colours to one for each of `count` points, (N, 3) uint8; numbers from 0 to 1 are allowed.

    Raises
    ------
    ValueError
        If the shape does not match.
    """
    array = np.asarray(colours)
    if array.shape != (count, 3):
        raise ValueError(f"colours have shape {array.shape}, not {count} × 3")
    if array.dtype.kind == "f":
        array = np.round(np.clip(array, 0, 1) * 255)
    return array.astype(np.uint8)


def ticks(low: float, high: float, at_most: int) -> tuple[list[float], list[str]]:
    """Choose at most `at_most` round numbers from `low` to `high`, and write them with equal decimals.

    They are two at least, even if that is more than `at_most`: one alone tells no scale.
    """
    values: list[float] = []
    while len(values) < 2:
        step = nice_step((high - low) / max(at_most - 1, 1))
        first, last = int(np.ceil(low / step - 1e-6)), int(np.floor(high / step + 1e-6))
        values = [k * step for k in range(first, last + 1)]
        at_most += 1
    decimals = max(0, -int(np.floor(np.log10(step) + 1e-9)))
    return values, [number(value, f".{decimals}f") for value in values]


def nice_step(at_least: float) -> float:
    """Round up to 1, 2 or 5 times a power of ten."""
    power = 10.0 ** np.floor(np.log10(at_least))
    return float(power * next(m for m in (1, 2, 5, 10) if m * power >= at_least * (1 - 1e-9)))
