"""The plate that carries a target: where in a picture it is, and which of the lines on it the laser may have drawn.

The target's points tell where the plate's plane is. How far the plate goes on beyond what is printed on it, its margin,
is known or taken as one square, one pitch of its circles, or the side of the black square. Light beyond lies on
something else. On the plate the laser's lines are straight, of like width and like height; specks of noise, edges and
reflections are not.
"""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.calibrate.fan.poses.stripe_lines import chunk_length, straight_lines
from core.image.stripes.centreline import Centreline
from core.image.targets import Target
from core.image.targets.kinds import BlackSquare, Charuco, Checkerboard, CircleGrid, Rectangle
from core.image.targets.pose import homography_of, map_by
from core.image.targets.target_view import TargetView
from core.model import Camera
from core.model.arrays import Array

# Held by tests/calibrate/fan/poses/test_clutter.py on rendered clutter and by photographs of three rigs.
FAINTEST = 0.15
"""Of the height of the light that most of the stripes have: a fainter line on equally light plate is no line of the
laser. A fan's outer lines have a third of the middle one's light."""
WIDTHS = (0.4, 2.5)
"""Of the width that most of the stripes have: least and most of a line of the same laser."""
MARGIN_OF_RECTANGLE = 0.05
"""Of a rectangle's shorter side: what paper leaves around one that nearly fills it, where its margin is not stated."""
SPACING = 8
"""Px between the places at which the picture is asked where the plate is."""
ROOM = 0.25
"""Of the margin once more around the plate that lines are looked for in, so that they do not end within it."""


class Plate:
    """Plate of a target in one picture: its outline and grey levels.

    Parameters
    ----------
    target, view
        The target and its points in the picture.
    camera
        Takes the distortion off; None: there is none.
    margin_mm
        How far the plate goes on beyond what is printed on it; None: not known.
    """

    def __init__(self, target: Target, view: TargetView, camera: Camera | None, margin_mm: float | None) -> None:
        printed, cell = _printed(target)
        self._camera = camera
        self._margin = cell if margin_mm is None else margin_mm
        self._low, self._high = printed
        if not view.placed:  # the points may be any part of the target
            seen = view.points[:, :2].min(axis=0), view.points[:, :2].max(axis=0)
            whole = target.points[:, :2].min(axis=0), target.points[:, :2].max(axis=0)
            self._low = self._low + (seen[1] - whole[1])
            self._high = self._high + (seen[0] - whole[0])
        self._homography = homography_of(self._rays(view.uv), view.points[:, :2])

    @property
    def corners(self) -> tuple[Array, Array]:
        """Least and largest x and y of the plate, (2,) each in mm in the frame of the view's points."""
        return self._low - self._margin, self._high + self._margin

    def contains(self, uv: Array, room: float = 0.0) -> NDArray[np.bool_]:
        """Flag the points `uv` (N, 2) in px that lie on the plate, (N,); `room` widens it by a share of its margin."""
        if self._homography is None:
            return np.ones(len(uv), dtype=bool)
        places = map_by(self._homography, self._rays(uv))
        reach = (1 + room) * self._margin
        return np.asarray(((places > self._low - reach) & (places < self._high + reach)).all(axis=1))

    def outside(self, shape: tuple[int, ...]) -> NDArray[np.bool_]:
        """Flag the pixels (H, W) of a picture that show other things than the plate, but none within some px of it."""
        rows, columns = (size // SPACING + 2 for size in shape)
        places = SPACING * np.stack(np.meshgrid(np.arange(columns), np.arange(rows)), axis=-1).reshape(-1, 2)
        within = self.contains(places.astype(np.float64), ROOM).reshape(rows, columns).astype(np.uint8)
        within = np.asarray(cv2.dilate(within, np.ones((3, 3), np.uint8)), dtype=np.uint8)
        whole = np.repeat(np.repeat(within, SPACING, axis=0), SPACING, axis=1)
        return np.asarray(whole[: shape[0], : shape[1]] == 0)

    def _rays(self, uv: Array) -> Array:
        return uv if self._camera is None else self._camera.rays(uv)[:, :2]


def _printed(target: Target) -> tuple[tuple[Array, Array], float]:
    """Least and largest x and y in mm of what is printed, and the size of a cell of it."""
    low, high = target.points[:, :2].min(axis=0), target.points[:, :2].max(axis=0)
    match target:
        case Checkerboard() | Charuco():
            beyond, cell = target.square_mm, target.square_mm
        case CircleGrid():
            beyond, cell = target.pitch_mm, target.pitch_mm
        case BlackSquare():
            beyond, cell = 0.0, target.side_mm
        case Rectangle():
            beyond, cell = 0.0, MARGIN_OF_RECTANGLE * min(target.width_mm, target.height_mm)
    return (low - beyond, high + beyond), cell


def without_clutter(centrelines: Sequence[Centreline], camera: Camera | None) -> tuple[Centreline, ...]:
    """Select the centrelines like most of the light in height and width, with a `camera` also straight ones."""
    if not centrelines:
        return ()
    height = np.array([np.median(line.strength) for line in centrelines])
    width = np.array([np.median(line.width) for line in centrelines])
    light = np.maximum(height, 0.0) * width * [len(line) for line in centrelines]
    usual_height, usual_width = _weighted_median(height, light), _weighted_median(width, light)
    like = (height > FAINTEST * usual_height) & (np.abs(width / usual_width - np.mean(WIDTHS)) < np.ptp(WIDTHS) / 2)
    kept = tuple(line for line, good in zip(centrelines, like, strict=True) if good)
    return kept if camera is None else _on_straight_lines(kept, camera)


def _on_straight_lines(centrelines: tuple[Centreline, ...], camera: Camera) -> tuple[Centreline, ...]:
    """Those of which a piece or more lies on straight lines; none if there is no straight line."""
    lines = straight_lines(centrelines, camera)
    if not lines:
        return ()
    straight = cKDTree(np.vstack([line.uv for line in lines]))
    least = chunk_length(centrelines) // 2
    return tuple(line for line in centrelines if np.count_nonzero(straight.query(line.uv)[0] < 1e-6) >= least)


def _weighted_median(values: Array, weight: Array) -> float:
    """The value below which half of the weight is."""
    order = np.argsort(values)
    share = np.cumsum(weight[order])
    return float(values[order][np.searchsorted(share, share[-1] / 2)])
