"""Print on boards that the reference shows like light of the fan: it is none, and tells nothing of what moved.

A board lies in the reference picture, too, and strips between its dark marks look like short stripes. Light of the fan
on a known plane lies where the fan's light planes cut that plane. What lies elsewhere on it, is bounded by dark marks,
and is as bright a strip in the board's own picture, is print; light on a part that stands before the board is not.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from core.image.stripes.centreline import Centreline
from core.model import Camera, Fan
from core.model.arrays import Array
from core.scan.known_planes.known_plane import KnownPlane
from core.scan.sweeps.fan_lines import ON_ONE_FACE

# Held by tests/scan/test_print_on_boards.py and tests/pipeline/test_run_with_planes.py.
FLANK = 3.0
"""Stripe σ beside a centreline where its strip has ended, and the dark marks that bound it have begun."""
LEAST_SHARE = 0.25
"""Of its height in the reference that a strip of print has in the board's picture, exposed otherwise as it may be."""


def printed_on_boards(
    pieces: Sequence[Centreline], planes: Sequence[KnownPlane], fan: Fan, camera: Camera
) -> NDArray[np.bool_]:
    """Flag those (P,) of the fan's centrelines that are print on the known planes; none where there are no planes."""
    return np.array([any(_print(piece, one, fan, camera) for one in planes) for piece in pieces], dtype=np.bool_)


def _print(piece: Centreline, plane: KnownPlane, fan: Fan, camera: Camera) -> bool:
    """Whether most of a centreline is print on one plane."""
    if plane.picture is None or plane.marks is None:
        return False
    outline = plane.outline.astype(np.float32)
    on = np.array([cv2.pointPolygonTest(outline, (u, v), False) >= 0 for u, v in piece.uv.tolist()])
    if np.mean(on) < 0.5:
        return False
    mine = piece.select(on)
    flanks = [mine.uv + side * FLANK * mine.width[:, None] * mine.normal for side in (-1, 1)]
    bounded = np.any([_at(plane.marks, uv) for uv in flanks], axis=0)
    height = _at(plane.picture, mine.uv) - np.mean([_at(plane.picture, uv) for uv in flanks], axis=0)
    as_bright = np.median(height / np.maximum(mine.strength, 1e-9)) > LEAST_SHARE
    return bool(np.mean(bounded) > 0.5 and as_bright and not _lit_by(fan, plane, camera.rays(mine.uv)))


def _lit_by(fan: Fan, plane: KnownPlane, rays: Array) -> bool:
    """Whether rays (N, 3) meet the plane where a light plane of the fan cuts it."""
    on_plane = rays @ plane.pi
    off = np.abs(rays @ fan.pis.T - on_plane[:, None]) / on_plane[:, None]
    return bool(np.min(np.median(off, axis=0), initial=np.inf) < ON_ONE_FACE)


def _at(picture: NDArray[Any], uv: Array) -> Array:
    """What the pixels nearest to `uv` (N, 2) hold; beyond the border what is there."""
    u, v = (np.rint(uv[:, axis]).astype(np.intp).clip(0, picture.shape[1 - axis] - 1) for axis in range(2))
    return np.asarray(picture[v, u], dtype=np.float64)
