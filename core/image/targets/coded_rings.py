"""Coded rings: a dark disc whose centre is measured, in a ring of dark and light sectors that tells its number.

The disc is measured as the circles of a grid are (`core.image.targets.ellipses`). Its ellipse also says where the ring
of the code lies. The code is read as a circle, so that it does not matter how the mark is turned: two codes are told
apart by the least number of sectors in which any turns of them differ.

    radius, in radii of the disc      1        2.1        2.8       3.3
                                 disc  |  light  |  code  |  light  |

References
----------
Ahn, S. J., Rauh, W., Kim, S. I., Circular coded target for automation of optical 3D-measurement and camera
calibration, Int. J. Pattern Recognition and Artificial Intelligence 15 (2001), doi:10.1142/S0218001401001222.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

from core.image.targets.edges import PictureSpline
from core.image.targets.ellipses import Ellipse, fit_dark_ellipses
from core.image.targets.picture import Picture, as_8bit, enlarged, reduced
from core.model.arrays import Array

SECTORS = 16
"""Of a code ring."""
CODE_FROM, CODE_TO, LIGHT_TO = 2.1, 2.8, 3.3
"""Radii of the code ring, and of the light ground about it, in radii of the disc."""
LEAST_APART = 4
"""Sectors in which two codes differ at least, however they are turned: three misread ones make no other code."""
LEAST_TURNS = 4
"""Changes from dark to light and back round a code at least: no plain ring, and no half shadow is one."""
MOST_UNREAD = 1
"""Sectors that may be unreadable, as a laser stripe lies over them."""
CLEAR = 0.25
"""A sector is read if its level is this far, of the step from dark to light, from the middle of it."""
TOO_BRIGHT = 1.35
"""Level, in steps from dark to light, above which a sample is a laser's light."""
_SAMPLES = 8
"""Of the picture along each sector."""
_LONGEST = (1000, 2000)
"""Longer side in px of the reduced pictures in which discs are looked for."""
_SMALLEST_PX, _WINDOWS = 2.5, (0.04, 0.1)
"""Smallest radius of a disc in a reduced picture, and the windows, as shares of its longer side, over which the level
between dark and light is averaged."""


@dataclass(frozen=True, eq=False, slots=True)
class SeenRing:
    """Coded ring seen in a picture: its number, and the ellipse of its disc."""

    number: int
    ellipse: Ellipse


@cache
def code_words() -> tuple[int, ...]:
    """List the codes, by the rings' numbers: SECTORS bits each, any two LEAST_APART bits apart however they are turned.

    Examples
    --------
    >>> len(code_words())
    61
    """
    turns = _turned(np.arange(1 << SECTORS))
    dark, changes = np.bitwise_count(turns[:, 0]), np.bitwise_count(turns[:, 0] ^ turns[:, 1])
    usable = (turns[:, 0] == turns.min(axis=1)) & (changes >= LEAST_TURNS)
    usable &= (dark >= SECTORS // 3) & (dark <= 2 * SECTORS // 3)
    found: list[int] = []
    taken = np.zeros(0, dtype=np.int64)
    for word in np.flatnonzero(usable):
        if not len(taken) or np.bitwise_count(taken ^ word).min() >= LEAST_APART:
            found.append(int(word))
            taken = np.concatenate([taken, turns[word]])
    return tuple(found)


def code_of(number: int) -> NDArray[np.bool_]:
    """Make the sectors (SECTORS,) of ring `number`, True where dark, counted from +x towards +y of the mark."""
    return np.asarray((code_words()[number] >> np.arange(SECTORS)) & 1 == 1)


def _turned(words: NDArray[np.int64]) -> NDArray[np.int64]:
    """All turns (N, SECTORS) of words (N,), each itself first."""
    step = np.arange(SECTORS)
    return ((words[:, None] << step) | (words[:, None] >> (SECTORS - step))) & ((1 << SECTORS) - 1)


@cache
def _known_turns() -> tuple[Array, NDArray[np.intp]]:
    """All turns of all codes as ±1 (T, SECTORS), and their numbers (T,)."""
    turned = _turned(np.array(code_words())).reshape(-1, 1)
    signs = np.asarray(2.0 * ((turned >> np.arange(SECTORS)) & 1) - 1, dtype=np.float64)
    return signs, np.repeat(np.arange(len(code_words())), SECTORS)


def find_rings(picture: Picture, numbers: Collection[int]) -> list[SeenRing]:
    """Find the coded rings with these `numbers` in a picture (H, W), in the order of their numbers.

    One that is hidden, smeared, or crossed by a laser stripe so that its disc or its code cannot be read is not among
    them, nor is a number that is seen twice.

    Parameters
    ----------
    picture
        (H, W) uint8 or uint16.
    numbers
        Those that may be there.

    Returns
    -------
    list of SeenRing
        Each with the ellipse of its disc: its centre is not yet freed of the perspective's shift
        (`core.image.targets.ellipses.centre_shift`).
    """
    full = as_8bit(picture)
    found: dict[int, list[SeenRing]] = {}
    for longest in _LONGEST:
        small, factor = reduced(full, longest)
        centres, radii = _discs(small)
        if len(centres):
            for ellipse in fit_dark_ellipses(picture, enlarged(centres, factor), radii * factor):
                number = None if ellipse is None else _read(picture, ellipse)
                if ellipse is not None and number in numbers:
                    _add(found.setdefault(int(number or 0), []), SeenRing(int(number or 0), ellipse))
        if factor == 1:
            break
    return [found[number][0] for number in sorted(found) if len(found[number]) == 1]


def _add(seen: list[SeenRing], ring: SeenRing) -> None:
    """Add a ring unless it is one already seen, at another window or size; the better fit of the two is kept."""
    for index, other in enumerate(seen):
        if np.linalg.norm(other.ellipse.centre - ring.ellipse.centre) < np.sqrt(
            abs(np.linalg.det(other.ellipse.shape))
        ):
            seen[index] = min(other, ring, key=lambda one: one.ellipse.sigma)
            return
    seen.append(ring)


def _discs(small: NDArray[np.uint8]) -> tuple[Array, Array]:
    """Centres (N, 2) and radii (N,) in px of dark spots about as large as an ellipse in their box."""
    spots = []
    for share in _WINDOWS:
        side = round(share * max(small.shape)) // 2 * 2 + 1
        level = cv2.blur(small, (side, side))
        dark = (small < 0.85 * level.astype(np.float32)).astype(np.uint8)
        _, _, stats, middles = cv2.connectedComponentsWithStats(dark, connectivity=4)
        width, height, area = stats[1:, cv2.CC_STAT_WIDTH], stats[1:, cv2.CC_STAT_HEIGHT], stats[1:, cv2.CC_STAT_AREA]
        filled = area / (np.pi / 4 * width * height)
        radius = np.sqrt(area / np.pi)
        sides = np.maximum(width, height) / np.maximum(np.minimum(width, height), 1)
        round_ = (np.abs(filled - 1) < 0.2) & (sides < 1.8) & (radius >= _SMALLEST_PX) & (radius < side)
        spots.append(np.column_stack([middles[1:], radius])[round_])
    every = np.concatenate(spots)
    return every[:, :2], every[:, 2]


def _read(picture: Picture, ellipse: Ellipse) -> int | None:
    """The number that the code ring about a disc tells; None if it is none, or not clear."""
    angle = 2 * np.pi * (np.arange(SECTORS * _SAMPLES) + 0.5) / (SECTORS * _SAMPLES)
    circle = np.column_stack([np.cos(angle), np.sin(angle)]) @ ellipse.shape.T
    size = float(np.linalg.norm(circle, axis=1).max())
    spline = PictureSpline(picture, ellipse.centre[None], LIGHT_TO * size + 2)
    radii = np.array([0.0, 0.4, 0.75, 1.25, 1.6, 2.3, 2.45, 2.6, 3.05])
    levels = spline.at(ellipse.centre + radii[:, None, None] * circle)
    if not np.isfinite(levels).all():
        return None
    dark, light = float(np.median(levels[:2])), float(np.median(levels[[4, 8]]))
    if light - dark < 4:
        return None
    every = (levels - dark) / (light - dark)
    if min(np.median(every[4]), np.median(every[8])) < 0.75:
        return None
    if every[:3].max() > 0.5 or every[3:5].max() > TOO_BRIGHT:  # a stripe over the disc or its rim draws it aside
        return None
    relative = every[5:8]
    level = np.where(relative < TOO_BRIGHT, relative, np.nan)
    best: tuple[float, int | None] = (0.0, None)
    for phase in range(_SAMPLES):
        turned = np.roll(level, -phase, axis=1).reshape(3, SECTORS, _SAMPLES)[:, :, 2:-2]
        read = np.isfinite(turned).all(axis=2).any(axis=0)
        sector = np.zeros(SECTORS)
        sector[read] = np.nanmedian(turned[:, read], axis=(0, 2)) - 0.5
        read &= np.abs(sector) > CLEAR
        clear = float(np.abs(sector).sum())
        if clear > best[0]:
            best = clear, _number(np.where(read, -np.sign(sector), 0.0))
    return best[1]


def _number(signs: Array) -> int | None:
    """The number of the code with these `signs` (SECTORS,), +1 dark, −1 light, 0 not read; None if there is none.

    In the picture a mark faces the camera, so that its sectors follow each other as they are printed.
    """
    if np.count_nonzero(signs == 0) > MOST_UNREAD:
        return None
    turns, numbers = _known_turns()
    same = np.flatnonzero(((turns * signs) >= 0).all(axis=1))
    return int(numbers[same[0]]) if len(set(numbers[same])) == 1 else None
