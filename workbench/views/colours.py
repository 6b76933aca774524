"""What each colour and symbol on a picture means. Hues after Okabe & Ito, told apart by colour-blind eyes.

Every meaning has a symbol of its own as well, so nothing is told by colour alone. All are readable on dark pictures;
symbols are drawn with a dark rim, which makes them readable on light ones too.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from PySide6.QtGui import QColor

Symbol = Literal["o", ".", "t", "x", "+", "s", "d"]
"""Open circle, disc, triangle, saltire, cross, square, diamond."""

KeySign = Symbol | Literal["line", "scale"]
"""What a legend shows beside a title: a symbol, a line, or the scale of σ."""

ColourLike = str | tuple[int, int, int] | tuple[int, int, int, int] | QColor

Level = Literal["", "good", "warn", "bad"]


@dataclass(frozen=True, slots=True)
class Mark:
    """Mark by which one meaning is drawn."""

    colour: str
    symbol: Symbol = "o"


FAN = ("#56B4E9", "#FF9E2C", "#F57FC4")
"""Fan lines 1, 2 and 3; `fan_colour` for any number of them."""

SWEEP = "#F4F4F4"
"""Sweep centrelines without σ."""

EXCLUDED = "#8C9196"
"""Whatever does not count: left out by hand, over the limit, without σ."""

REGION = "#FFD54A"
"""Regions drawn by hand."""

FACE_UPPER, FACE_LOWER = "#56B4E9", "#FF9E2C"
"""Points of the two faces of a gauge."""

NEXT_PAIR = "#B070F0"
"""Outlines of faces that could be meant as well as those that were measured."""

FEATURE = "#E66AD2"
"""Points and regions of the feature that is chosen."""

DATUM = "#A8703F"
"""Points of the datums that it refers to; no scale of values has this colour."""

PROPOSED = "#FF6D00"
"""Points of a face that was clicked and is not taken yet; no scale of values has this colour."""

NOMINAL_SURFACE = "#2FA7A0"
"""The nominal surface over the part, seen through; no class of deviations is of this colour."""

OTHER_SURFACE = "#9A7BD0"
"""Points of the surface that the scan is compared with, beside it."""

DEVIATIONS = ("#08306B", "#2166AC", "#5B9FD0", "#A6CDE6", "#C9CDD2", "#F4B79A", "#E08259", "#C4403C", "#7A0221")
"""Classes of deviations from a nominal surface, from the farthest inwards to the farthest outwards; marks tell more."""

KNOWN_PLANE = "#C6A8FF"
"""Outlines of the known planes beside the part."""

CROSSING_GOOD = Mark("#3DDC84", "o")
CROSSING_WEAK = Mark("#FFB000", "t")
CROSSING_LEFT_OUT = Mark("#FF5C57", "x")
CORNER = Mark("#35E0D0", "+")
CORNER_LEFT_OUT = Mark("#FF5C57", "x")
RESIDUAL = "#FFB000"
COVERED = "#3DDC84"
WANTED = "#FFD54A"
"""Where the target should be held next."""

# viridis without its dark third, which would drown in a dark picture
_SIGMA_STOPS = "6f7ff0 4f9be0 3bb5b8 4fc987 95d94a fde725"


def fan_colour(line: int) -> str:
    """Return the colour of fan line 1, 2, 3, …; colours repeat for more lines."""
    return FAN[(line - 1) % len(FAN)]


def to_colour(colour: ColourLike) -> QColor:
    """Convert a colour given by name, hex text, numbers or QColor to a QColor."""
    if isinstance(colour, QColor):
        return colour
    return QColor(colour) if isinstance(colour, str) else QColor(*colour)


def to_rgba(colour: ColourLike) -> tuple[int, int, int, int]:
    """Convert a colour given by name, hex text, numbers or QColor to red, green, blue, alpha, 0 … 255."""
    if isinstance(colour, str):
        return _named(colour)
    chosen = to_colour(colour)
    return chosen.red(), chosen.green(), chosen.blue(), chosen.alpha()


@lru_cache(maxsize=256)
def _named(name: str) -> tuple[int, int, int, int]:
    """The four numbers of a colour: a picture that changes many times a second asks for the same ones."""
    chosen = QColor(name)
    return chosen.red(), chosen.green(), chosen.blue(), chosen.alpha()


@cache
def sigma_table() -> NDArray[np.uint8]:
    """Make the 256 colours for σ (256, 4), uint8, from 0 (blue) to the limit (yellow)."""
    stops = np.array([list(bytes.fromhex(stop)) for stop in _SIGMA_STOPS.split()], dtype=np.float64)
    at = np.linspace(0, len(stops) - 1, 256)
    columns = [np.interp(at, np.arange(len(stops)), stops[:, i]) for i in range(3)]
    rounded: NDArray[np.uint8] = np.round(np.column_stack([*columns, np.full(256, 255.0)])).astype(np.uint8)
    rounded.flags.writeable = False
    return rounded
