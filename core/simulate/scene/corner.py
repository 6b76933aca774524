"""The corner of two boards of the simulated rig: what is printed on them, known without anything being rendered."""

from __future__ import annotations

from collections.abc import Mapping

from core.calibrate.board_shape import BoardTolerance
from core.files.recording.rig import KnownPlaneTarget
from core.image.targets import Charuco, Rectangle, Target

NEAR, FAR = "near", "far"
"""Names of the boards."""
CORNER: Mapping[str, tuple[Target, Target]] = {
    "charuco": (Charuco(19, 5, 14.0, 10.5, "DICT_4X4_100"), Charuco(19, 5, 14.0, 10.5, "DICT_4X4_100", 47)),
    "rectangle": (Rectangle(266.0, 70.0, 6.0), Rectangle(266.0, 70.0, 6.0)),
}
"""Targets of the near and the far board, by their kind. With their margins the boards are 286 × 90 mm, strips of A4."""


def corner_planes(kind: str, tolerance: BoardTolerance) -> dict[str, KnownPlaneTarget]:
    """State what is printed on the boards of a corner of this `kind`, and how true it is."""
    near, far = CORNER[kind]
    return {NEAR: KnownPlaneTarget(near, tolerance), FAR: KnownPlaneTarget(far, tolerance, print_of=NEAR)}
