"""Rough search for dark quadrilaterals on a light ground, in a reduced picture."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from core.image.targets.picture import level_quantiles, without_stripes
from core.model.arrays import Array
from core.model.robust import median

STRIPE_WIDTHS = (1, 7, 13, 21)
"""Widths in pixels of the bright lines taken out before looking, in turn (1: none is)."""

LEAST_SIDE = 14
"""Side in pixels below which a quadrilateral's shape cannot be judged."""


FINER = (0.004, 0.008, 0.015, 0.03)
"""Shares of the length that a long rectangle's corners may be off by, in turn: by more they are no longer near."""

MOST_PIECES = 12
"""Pieces that stripes may cut a square into."""


@dataclass(frozen=True, eq=False, slots=True)
class DarkSquares:
    """Dark squares of a picture: whole quadrilaterals (4, 2) clockwise, largest first, and the number cut off."""

    whole: tuple[Array, ...]
    cut_off: int


def dark_squares(picture: NDArray[np.uint8], line: float | None = None) -> DarkSquares:
    """Find dark, convex quadrilaterals with light all round them; stripes of light may cross them.

    They are about squares; with a `line`, rectangles of any sides: dark throughout where it is 0, else outlines as wide
    as `line`, a share of the root of their area. Of these, what is seen with the fewest stripes taken out goes first:
    more of them also take the light between an outline and what is near it.
    """
    cut_off = 0
    found: list[Array] = []
    for width in STRIPE_WIDTHS:
        opened = picture if width == 1 else without_stripes(picture, width)
        darkest, lightest = level_quantiles(opened[::4, ::4], 0.01, 0.99)
        for mask in _thresholded(opened):
            whole, cut = _quadrilaterals(opened, mask, lightest - darkest, line)
            cut_off = max(cut_off, cut)
            large = [quad for quad in whole if _sides(quad).min() >= 3 * width]
            found.extend(quad for quad in large if width == 1 or line or _mostly_dark(picture, opened, quad))
    if line is None:
        found.sort(key=_smallness)
    largest: list[Array] = []
    for quad in found:  # what lies within another is the same square, or what stripes leave of it
        if not any(_holds(other, quad.mean(axis=0)) for other in largest):
            largest.append(quad)
    return DarkSquares(tuple(sorted(largest, key=_smallness)), cut_off)


def _smallness(quad: Array) -> float:
    return -cv2.contourArea(quad.astype(np.float32))


def _thresholded(picture: NDArray[np.uint8]) -> Iterator[NDArray[np.uint8]]:
    """Masks (255 where dark) by one level for the whole picture, by levels around it, and by the surroundings' mean."""
    smooth = cv2.GaussianBlur(picture, (0, 0), 1)
    level, mask = cv2.threshold(smooth, 0, 255, cv2.THRESH_BINARY_INV | cv2.THRESH_OTSU)
    yield np.asarray(mask, dtype=np.uint8)
    for factor in (0.6, 1.4):
        yield np.asarray(cv2.threshold(smooth, level * factor, 255, cv2.THRESH_BINARY_INV)[1], dtype=np.uint8)
    block = max(picture.shape) // 2 | 1
    mean = cv2.boxFilter(smooth, -1, (block, block))
    yield np.where(smooth < 0.8 * mean, 255, 0).astype(np.uint8)


def _quadrilaterals(
    picture: NDArray[np.uint8], mask: NDArray[np.uint8], contrast: float, line: float | None
) -> tuple[list[Array], int]:
    """Whole dark quadrilaterals of `mask`, and how many convex dark regions the picture's border cuts."""
    found, _ = cv2.findContours(mask, cv2.RETR_LIST, cv2.CHAIN_APPROX_SIMPLE)
    contours = [np.asarray(contour, dtype=np.int32) for contour in found]
    whole: list[Array] = []
    cut = 0
    for contour in contours:
        area = cv2.contourArea(contour)
        if area < LEAST_SIDE**2 or area > 0.9 * mask.size:
            continue
        hull = np.asarray(cv2.convexHull(contour), dtype=np.int32)
        if area < 0.93 * cv2.contourArea(hull):
            continue
        if _touches_border(contour, mask.shape):
            cut += bool(0.01 * mask.size < area < 0.5 * mask.size and len(_polygon(hull)) in (3, 4, 5))
            continue
        corners = _polygon(hull) if line is None else _finest_polygon(hull)
        if len(corners) != 4 or not 0.9 < area / cv2.contourArea(corners) < 1.1:
            continue
        quad = clockwise(corners.reshape(4, 2).astype(np.float64))
        if _sides(quad).min() < LEAST_SIDE:
            continue
        if _outlined(picture, quad, contrast, line) if line else _dark_on_light(picture, quad, contrast):
            whole.append(quad)
    return whole, cut


def _sides(quad: Array) -> Array:
    lengths: Array = np.linalg.norm(np.roll(quad, -1, axis=0) - quad, axis=1)
    return lengths


def _polygon(hull: NDArray[np.int32], off: float = 0.03) -> NDArray[np.int32]:
    """The hull with corners left out where it is `off` by no more than that share of its length."""
    return np.asarray(cv2.approxPolyDP(hull, off * cv2.arcLength(hull, True), True), dtype=np.int32)


def _finest_polygon(hull: NDArray[np.int32]) -> NDArray[np.int32]:
    """The quadrilateral nearest to the hull; if there is none, a polygon of other corners."""
    polygons = [_polygon(hull, off) for off in FINER]
    return next((polygon for polygon in polygons if len(polygon) == 4), polygons[-1])


def _touches_border(contour: NDArray[np.int32], shape: tuple[int, ...]) -> bool:
    left, top, width, height = cv2.boundingRect(contour)
    return left <= 1 or top <= 1 or left + width >= shape[1] - 1 or top + height >= shape[0] - 1


def _dark_on_light(picture: NDArray[np.uint8], quad: Array, contrast: float) -> bool:
    """Whether the inside is dark throughout and lighter ground lies beyond every side, by the picture's contrast."""
    centre = quad.mean(axis=0)
    shares = np.linspace(0.15, 0.85, 25)[:, None]
    along = np.roll(quad, -1, axis=0) - quad
    length = np.linalg.norm(along, axis=1, keepdims=True)
    outwards = np.maximum(3.0, 0.04 * length) * np.column_stack([along[:, 1], -along[:, 0]]) / length
    sides = quad[:, None] + shares * along[:, None]
    outside = min(map(median, _levels(picture, sides + outwards[:, None])))
    inside = _levels(picture, np.stack([sides - outwards[:, None], centre + 0.4 * (sides - centre)]))
    step = outside - median(inside)
    return step > 0.15 * contrast and float(np.mean(inside < outside - 0.4 * step)) > 0.8


def _outlined(picture: NDArray[np.uint8], quad: Array, contrast: float, line: float) -> bool:
    """Whether a dark line as wide as `line`, a share of the root of the area, runs within the sides, between light."""
    width = line * float(np.sqrt(cv2.contourArea(quad.astype(np.float32))))
    shares = np.linspace(0.15, 0.85, 25)[:, None]
    along = np.roll(quad, -1, axis=0) - quad
    inwards = np.column_stack([-along[:, 1], along[:, 0]]) / np.linalg.norm(along, axis=1, keepdims=True)
    sides = quad[:, None] + shares * along[:, None]
    clear = max(2.0, 0.5 * width)
    light = min(
        median(level)
        for places in (sides - clear * inwards[:, None], sides + (width + clear) * inwards[:, None])
        for level in _levels(picture, places)
    )
    dark = _levels(picture, sides + 0.5 * width * inwards[:, None])
    step = light - median(dark)
    return step > 0.15 * contrast and float(np.mean(dark < light - 0.4 * step)) > 0.8


def _mostly_dark(picture: NDArray[np.uint8], opened: NDArray[np.uint8], quad: Array) -> bool:
    """Whether the inside, before stripes were taken out, was dark at least by half, and in few pieces.

    Otherwise it is a pattern whose gaps were taken for stripes.
    """
    corners = np.rint(quad).astype(np.int32)
    left, top, width, height = cv2.boundingRect(corners)
    box = slice(top, top + height), slice(left, left + width)
    picture, opened = picture[box], opened[box]
    inside = np.zeros(picture.shape, dtype=np.uint8)
    cv2.fillConvexPoly(inside, corners - (left, top), 1)
    before, after = picture[inside > 0], opened[inside > 0]
    middle = (level_quantiles(after, 0.5)[0] + level_quantiles(before, 0.98)[0]) / 2
    if float(np.mean(before < middle)) < 0.5:
        return False
    dark = np.where((picture < middle) & (inside > 0), 255, 0).astype(np.uint8)
    areas = cv2.connectedComponentsWithStats(dark, connectivity=4)[2][1:, cv2.CC_STAT_AREA]
    return int(np.count_nonzero(areas > 0.005 * inside.sum())) <= MOST_PIECES


def _levels(picture: NDArray[np.uint8], uv: Array) -> Array:
    """Grey levels (…) at the pixels nearest to `uv` (…, 2), of the border beyond it."""
    u, v = np.moveaxis(np.rint(uv).astype(int), -1, 0)
    levels: Array = picture[v.clip(0, picture.shape[0] - 1), u.clip(0, picture.shape[1] - 1)].astype(np.float64)
    return levels


def clockwise(quad: Array) -> Array:
    """Order `quad` (4, 2) clockwise in the picture, from its corner nearest to the top left."""
    order = np.argsort(np.arctan2(*(quad - quad.mean(axis=0)).T[::-1]))  # v runs down: growing angle is clockwise
    turned = quad[order]
    return np.roll(turned, -first_corner(turned), axis=0)


def first_corner(quad: Array) -> int:
    """Find the index of the corner of `quad` (4, 2) nearest to the top left of the picture (smallest u + v)."""
    return int(np.argmin(quad.sum(axis=1)))


def _holds(quad: Array, point: Array) -> bool:
    return cv2.pointPolygonTest(quad.astype(np.float32), (float(point[0]), float(point[1])), False) >= 0
