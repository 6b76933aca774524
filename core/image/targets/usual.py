"""Usual sizes of targets, where none are given: those of the simulated rig; all fit A4."""

from __future__ import annotations

from collections.abc import Mapping

USUAL: Mapping[str, tuple[int, int, float]] = {
    "checkerboard": (17, 12, 10.0),
    "charuco": (12, 9, 15.0),
    "circle_grid": (13, 10, 14.0),
    "black_square": (1, 1, 60.0),
}
"""Columns, rows and size in mm."""

USUAL_MARKER = 0.75
"""Side of a marker over that of its square."""
