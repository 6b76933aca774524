"""Silhouettes and creases of what is drawn, found in its depth buffer: they cost the same on any kind of OpenGL.

In perspective 1/depth is linear over the picture of a plane, in parallel projection depth is, and the depth buffer is
linear in the one or the other. So its second differences vanish on every plane, whatever its slope: they are large
where the surface ends or bends.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from workbench.views.scene.camera import SceneCamera
from workbench.views.scene.contents import MARKS_NEARER

FAINT, FULL = 0.35, 1.2
"""Change of slope, in mm of depth per mm across, from which on a bend is drawn and at which it is drawn in full: noise
of a measured mesh stays below the first, an edge of 90° seen from a corner is beyond the second."""

JUMP = 8.0
"""A change of slope beyond which the surface ends: it is drawn on the nearer side only."""

STRENGTH = 190
"""Opacity of a line drawn in full, of 255."""

LINES_NEARER = MARKS_NEARER / 2
"""Lines are drawn nearer than what they lie on by more than this share of the distance."""


@dataclass(frozen=True, eq=False, slots=True)
class Depths:
    """Depth buffer (h, w), 1 where nothing is drawn, and the depths in mm at which it is 0 and 1."""

    buffer: NDArray[np.float32]
    near: float
    far: float


def edge_opacity(depths: Depths, camera: SceneCamera, lines_px: int = 0) -> NDArray[np.uint8]:
    """Compute the opacity (h, w), uint8, of silhouettes and creases to be drawn over the picture.

    Parameters
    ----------
    lines_px
        Lines of so many pixels were drawn as well: they are no edges of the surface. 0: none.
    """
    buffer, near, far = depths.buffer, depths.near, depths.far
    height, width = buffer.shape
    scale = camera.pixels_per_mm((width, height))
    if camera.parallel:
        factor: NDArray[np.float32] | np.float32 = np.float32((far - near) * scale)
    else:
        per_depth = np.float32(scale * camera.distance * (far - near) / (near * far))
        factor = per_depth * np.float32(near * far) / (np.float32(far) - buffer * np.float32(far - near))
    opacity = np.zeros(buffer.shape, dtype=np.float32)
    for axis in (0, 1):
        bend = np.zeros(buffer.shape, dtype=np.float32)
        before, here, after = (_along(axis, start, stop) for start, stop in ((0, -2), (1, -1), (2, None)))
        bend[here] = buffer[before] + buffer[after] - 2 * buffer[here]
        bend *= factor
        bend[bend < -JUMP] = 0.0
        np.maximum(opacity, np.abs(bend), out=opacity)
    opacity -= FAINT
    opacity *= STRENGTH / (FULL - FAINT)
    np.clip(opacity, 0, STRENGTH, out=opacity)
    opacity[buffer >= 1] = 0
    if lines_px:
        reach = lines_px // 2 + 1
        behind = -_largest(-_largest(buffer, reach), reach)  # without what is narrow and nearer than all around it
        nearer = (behind - buffer) * factor > LINES_NEARER * camera.distance * scale
        opacity[_largest(nearer.astype(np.float32), 1) > 0] = 0
    return opacity.astype(np.uint8)


def _along(axis: int, start: int, stop: int | None) -> tuple[slice, slice]:
    """Part of a picture from `start` to `stop` along one axis."""
    part = slice(start, stop)
    return (part, slice(None)) if axis == 0 else (slice(None), part)


def _largest(values: NDArray[np.float32], reach: int) -> NDArray[np.float32]:
    """The largest value within `reach` pixels, in rows and in columns."""
    found = values
    for axis in (0, 1):
        padded = np.pad(found, [(reach, reach) if k == axis else (0, 0) for k in (0, 1)], mode="edge")
        length = values.shape[axis]
        found = np.max([padded[_along(axis, k, k + length)] for k in range(2 * reach + 1)], axis=0)
    return found
