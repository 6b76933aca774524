"""Print on boards that the reference shows like light of the fan: it tells nothing of what moved.

A board lies in the reference picture, too, and its squares look like short stripes. Light of the fan on a known plane
lies where the fan's light planes cut that plane; what lies elsewhere on it and is of no line of the fan is print.
"""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from core.image.stripes.centreline import Centreline
from core.model import Camera
from core.scan.known_planes.known_plane import Control, KnownPlane
from core.scan.sweeps.fan_lines import ON_ONE_FACE, UNASSIGNED, FanLines


def printed_on_boards(
    pieces: Sequence[Centreline], lines: FanLines, control: Control, camera: Camera
) -> NDArray[np.bool_]:
    """Flag those (P,) of the fan's centrelines that are print on the known planes; none where there are no planes."""
    flags = [
        line == UNASSIGNED and any(_elsewhere_on(plane, piece, control, camera) for plane in control.planes)
        for piece, line in zip(pieces, lines.line, strict=True)
    ]
    return np.array(flags, dtype=np.bool_)


def _elsewhere_on(plane: KnownPlane, piece: Centreline, control: Control, camera: Camera) -> bool:
    """Whether most of a centreline is seen on a plane, and not where a light plane of the fan cuts it."""
    outline = plane.outline.astype(np.float32)
    on = np.array([cv2.pointPolygonTest(outline, (u, v), False) >= 0 for u, v in piece.uv.tolist()])
    if np.mean(on) < 0.5:
        return False
    rays = camera.rays(piece.uv[on])
    on_plane = rays @ plane.pi
    off = np.abs(rays @ control.fan.pis.T - on_plane[:, None]) / on_plane[:, None]
    return bool(np.min(np.median(off, axis=0), initial=np.inf) > ON_ONE_FACE)
