"""Layout of a carrier's coded rings, to print it or to simulate it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.image.targets.coded_rings import LIGHT_TO, code_words
from core.model.arrays import Array
from core.views.carrier import Carrier

UNEVEN_MM = 1.5
"""By how much marks are moved off an even layout, so that no turn of it looks like another."""
U_PRINTED_MM, U_SCALE = 0.1, 0.003
"""Standard uncertainty of a printed mark's place on its sheet, and of the printer's scale, across and along."""
U_GLUED_MM, U_TURN_RAD = 0.5, 0.005
"""Standard uncertainty of how the two sheets lie to each other: shift, and turn or tilt (0.5 mm at the rim)."""


def ring_places(marks: int, half_mm: tuple[float, float], disc_mm: float) -> Array:
    """Compute the places (marks, 2) in mm of rings round the rim of a plate of the half sizes `half_mm`."""
    angle = 2 * np.pi * (np.arange(marks) + 0.5) / max(marks, 1)
    ring = np.column_stack([np.cos(angle), np.sin(angle)])
    ring *= (1 / np.abs(ring).max(axis=1))[:, None]
    uneven = UNEVEN_MM * np.sin(2.3 * np.arange(marks))[:, None] * [1.0, -0.6]
    return np.asarray(ring * (np.array(half_mm) - LIGHT_TO * disc_mm - UNEVEN_MM) + uneven)


def two_sided(
    marks: int, half_mm: tuple[float, float], disc_mm: float, thick_mm: float
) -> tuple[NDArray[np.int64], Array]:
    """Make the numbers (2N,) and positions (2N, 3) in mm of `marks` rings on side A, then as many on side B."""
    flat = ring_places(marks, half_mm, disc_mm)
    sides = [np.column_stack([flat, np.full(marks, z)]) for z in (thick_mm / 2, -thick_mm / 2)]
    return np.arange(2 * marks, dtype=np.int64), np.concatenate(sides)


def printed_carrier(marks: int, half_mm: tuple[float, float], disc_mm: float, thick_mm: float) -> Carrier:
    """Make a carrier as it is printed and glued on both sides of a plate, before it is calibrated: its u is large.

    Raises
    ------
    ValueError
        If there are not so many codes.
    """
    if 2 * marks > len(code_words()):
        raise ValueError(f"there are {len(code_words())} codes, not {2 * marks}")
    numbers, positions = two_sided(marks, half_mm, disc_mm, thick_mm)
    sides = np.repeat([0, 1], marks)
    together = np.zeros((6 * marks, 8))
    for axis in range(3):
        together[axis::3, axis] = U_GLUED_MM * sides
        together[:, 3 + axis] = (np.cross(U_TURN_RAD * np.eye(3)[axis], positions) * sides[:, None]).ravel()
    for axis in range(2):
        together[axis::3, 6 + axis] = U_SCALE * positions[:, axis]
    covariance = U_PRINTED_MM**2 * np.eye(6 * marks) + together @ together.T
    return Carrier(
        numbers, sides, positions, covariance, disc_mm, scaled_by_target=False, name="as printed", as_printed=True
    )
