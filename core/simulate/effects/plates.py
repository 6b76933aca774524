"""Plates of calibration that are not as they are said to be: bowed, or of another size."""

from __future__ import annotations

from dataclasses import dataclass

from core.simulate.effects.ranges import require_ranges


@dataclass(frozen=True, slots=True)
class PlateEffects:
    """Differences of plates from what rig.toml states of them.

    Parameters
    ----------
    camera_bow_mm
        How far the left and right edges of the camera's target lie in front of the plane through its middle, along a
        parabola. Paper on board is off by 0.1 to 1 mm, a dibond plate by 0.05 to 0.3 mm.
    plane_bow_mm
        The same of the plane target, which the fan's light meets; also in the pictures of an interim check.
    camera_scale, plane_scale
        By which share the plates are larger than stated: office printers are off by 5e-4 to 5e-3, and whoever reads a
        ruler wrongly by some 1e-2.

    References
    ----------
    Strobl & Hirzinger, More accurate pinhole camera calibration with imperfect planar target, ICCV Workshops (2011),
    doi:10.1109/ICCVW.2011.6130369 (prints: 1e-3 of their size, 0.1 to 1 mm off their plane).
    """

    camera_bow_mm: float = 0.0
    camera_scale: float = 0.0
    plane_scale: float = 0.0
    plane_bow_mm: float = 0.0

    def __post_init__(self) -> None:
        bows = tuple((name, -20.0, 20.0) for name in ("camera_bow_mm", "plane_bow_mm"))
        require_ranges(self, (*bows, ("camera_scale", -0.2, 0.2), ("plane_scale", -0.2, 0.2)))


TRUE_PLATES = PlateEffects()
"""Flat, and as large as stated."""
