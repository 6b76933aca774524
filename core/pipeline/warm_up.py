"""Compiling ahead: a tiny scan is measured while nobody waits, so that the first real one need not wait for compilers.

What is compiled is kept on the disk: this takes about a minute after an installation or an update, else a moment.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from core.pipeline.live_warm_up import CAMERA, SIZE, Levels, exposed
from core.scan.cloud import Cloud
from core.scan.features import extract_features
from core.scan.fusion import fuse
from core.scan.mesh import build_mesh
from core.scan.normals import with_normals
from core.scan.reference import Picture
from core.scan.reference_features import FeatureOptions

_FAN = (70.0, 84.0, 170.0)
_SWEEPS = (90.0, 150.0, 210.0)


def stages() -> tuple[Callable[[], None], ...]:
    """What there is to be compiled, each part by itself; none takes much longer than half a minute."""
    return lambda: _stripes(np.uint8), lambda: _stripes(np.uint16), _surface


def _stripes(levels: Levels) -> None:
    """Three level lines of a fan, two of them close together, and three upright sweeps: found, refined, crossed."""
    reference = _picture(levels, rows=_FAN)
    frames = [(f"{number}", _picture(levels, rows=_FAN, column=place)) for number, place in enumerate(_SWEEPS)]
    extract_features(reference, frames, len(frames), FeatureOptions(camera=CAMERA))


def _picture(levels: Levels, rows: tuple[float, ...], column: float | None = None) -> Picture:
    v, u = np.mgrid[: SIZE[1], : SIZE[0]]
    light = sum(np.exp(-0.5 * ((v - row - 0.02 * u) / 2.0) ** 2) for row in rows)
    if column is not None:
        light = light + np.exp(-0.5 * ((u - column - 0.1 * v) / 2.0) ** 2)
    return exposed(levels, light)


def _surface() -> None:
    """A level patch of points, fused, with normals and triangles."""
    u, v = (axis.ravel().astype(np.float64) for axis in np.meshgrid(np.arange(40, 200, 2), np.arange(40, 160, 2)))
    uv, count = np.column_stack([u, v]), u.size
    points = 500.0 * np.column_stack([(u - 160) / 400, (v - 120) / 400, np.ones(count)])
    level, none = np.full(count, 0.02), np.zeros(count, dtype=np.int64)
    cloud = with_normals(Cloud(points, uv, level, level, none, none, np.zeros((count, 3))))
    build_mesh(with_normals(fuse(cloud, SIZE)))
