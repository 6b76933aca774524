"""The outline of measured points in the picture: a polygon that can be kept, drawn and dragged."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import InputError
from core.inspect.face_region import inside_polygon
from core.inspect.fit.plane_search import FEWEST_POINTS, FoundPlane, find_planes, points_on, search_tolerance
from core.messages import Message
from core.model.arrays import Array
from core.scan.surface.cloud import Cloud

REGION = Message("surface.where_region", "region")

CELLS_ACROSS = 400
"""The points are laid out in about so many cells along their longer side."""
SMALLEST_CELL_PX = 1.0
"""Points are seen to about a pixel: smaller cells would have holes."""
GAP_SHARE = 6.0
"""Gaps up to this many times the median distance of a place to the nearest point are closed: those between stripes."""
SLACK = 0.008
"""Corners are left out as long as the outline stays this near to the points, as a share of their longer side."""
MOST_CORNERS = 16
"""As many as a person can drag."""
MOST_FACES = 5
"""Plane faces looked for among the chosen points."""
SMALL_FACE = 0.2
"""Faces among the chosen points smaller than this share of the largest one are not meant."""
WHOLE = 0.6
"""Faces are chosen as a whole, as far as anything is, if the share chosen of them is this part of the largest share."""
OPENED_SHARE = 0.85
"""Single stripes that stick out are cut off as long as so much of the area stays."""


def face_outline(cloud: Cloud, chosen: NDArray[np.int64], face: str) -> Array:
    """Compute the outline (n, 2) in pixels of the plane face that a selection of points on the screen means.

    What is chosen on the screen holds points behind the face as well, often more of them. Meant is the face that was
    chosen as a whole rather than a part of one that goes on outside; of several such ones the nearest to the camera for
    the upper face, the farthest for the lower one.

    Parameters
    ----------
    cloud
        The measured points, with normals.
    chosen
        Indices of points of the cloud.
    face
        "upper" or "lower".

    Returns
    -------
    Array
        (n, 2) corners, 3 ≤ n ≤ 16, going round once; holes in the face are filled.

    Raises
    ------
    InputError
        If there is no plane face among them.
    """
    part = cloud.select(np.asarray(chosen, dtype=np.int64))
    found = find_planes(part, margin_mm=0.0, most=MOST_FACES) if len(part) >= FEWEST_POINTS else []
    planes = [plane for plane in found if len(plane.region.indices) >= FEWEST_POINTS]
    if not planes:
        raise InputError(
            Message("surface.no_face_chosen", "there is no plane face among the {n} chosen points", n=len(part)),
            where=REGION,
            todo=Message("surface.advice_draw_larger", "draw round a larger part of one face"),
        )
    return outline_px(part.uv[_meant(cloud, part, planes, nearest=face == "upper").region.indices])


def _meant(cloud: Cloud, part: Cloud, planes: list[FoundPlane], *, nearest: bool) -> FoundPlane:
    """The plane that was chosen as a whole; of several the nearest to the camera, or the farthest."""
    tolerance = search_tolerance(cloud)
    largest = max(plane.region.area_mm2 for plane in planes)
    large = [plane for plane in planes if plane.region.area_mm2 >= SMALL_FACE * largest]
    shares = [
        len(points_on(part, plane, tolerance)) / max(len(points_on(cloud, plane, tolerance)), 1) for plane in large
    ]
    whole = [plane for plane, share in zip(large, shares, strict=True) if share >= WHOLE * max(shares)]
    direction = max(whole, key=lambda plane: plane.region.area_mm2).normal
    depths = [float(np.median(part.points[plane.region.indices] @ direction)) for plane in whole]
    return whole[int(np.argmin(depths) if nearest else np.argmax(depths))]


def outline_px(uv: ArrayLike) -> Array:
    """Compute the outline (n, 2), a polygon of few corners, of places `uv` (N, 2) in the picture, in pixels.

    Parameters
    ----------
    uv
        (N, 2) pixels, N ≥ 3, not all on one line.

    Returns
    -------
    Array
        (n, 2) corners, 3 ≤ n ≤ 16, of the largest connected part; holes are filled.

    Raises
    ------
    InputError
        If the places lie on one line.
    """
    places = np.asarray(uv, dtype=np.float64)
    low, size = places.min(axis=0), np.ptp(places, axis=0)
    cell = max(SMALLEST_CELL_PX, float(size.max()) / CELLS_ACROSS)
    if len(places) < 3 or _on_one_line(places, cell):
        raise InputError(
            Message("surface.chosen_on_a_line", "the chosen points lie on one line"),
            where=REGION,
            todo=Message("surface.advice_draw_more", "draw round more of the face"),
        )
    covered, gap = _covered(np.floor((places - low) / cell).astype(np.int64))
    contour = _largest_contour(covered)
    slack = max(SLACK * float(size.max()) / cell, gap / 3)
    corners = _simplified(contour, slack)
    while len(corners) > MOST_CORNERS:
        slack *= 1.3
        corners = _simplified(contour, slack)
    outline = (corners + 0.5) * cell + low
    if len(outline) >= 3 and inside_polygon(places, outline).any():
        return np.asarray(outline)
    hull = np.asarray(cv2.convexHull(places.astype(np.float32)), dtype=np.float64).reshape(-1, 2)
    coarser: Array = hull[:: -(-len(hull) // MOST_CORNERS)]
    return coarser


def _on_one_line(places: Array, cell: float) -> bool:
    """Whether the places are nowhere wider than one cell."""
    centred = places - places.mean(axis=0)
    across = np.linalg.svd(centred[:: max(1, len(centred) // 10_000)], full_matrices=False)[2][1]
    return bool(np.ptp(centred @ across) < cell)


def _covered(cells: NDArray[np.int64]) -> tuple[NDArray[np.uint8], float]:
    """The cells with points, gaps between stripes closed, and half the widest gap that is closed."""
    column, row = cells.T
    bare = np.ones((int(row.max()) + 1, int(column.max()) + 1), dtype=np.uint8)
    bare[row, column] = 0
    gap = 1 + GAP_SHARE * float(np.median(cv2.distanceTransform(bare, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)))
    pad = int(np.ceil(gap)) + 2
    padded = np.pad(bare, pad, constant_values=1)
    grown = (cv2.distanceTransform(padded, cv2.DIST_L2, cv2.DIST_MASK_PRECISE) <= gap).astype(np.uint8)
    deep = cv2.distanceTransform(grown, cv2.DIST_L2, cv2.DIST_MASK_PRECISE) > gap
    kept: NDArray[np.uint8] = (deep | (padded == 0)).astype(np.uint8)
    side = 2 * max(1, round(gap / 2)) + 1
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (side, side))
    opened = np.asarray(cv2.morphologyEx(kept, cv2.MORPH_OPEN, disc), dtype=np.uint8)
    whole = opened if opened.sum() >= OPENED_SHARE * kept.sum() else kept
    return whole[pad:-pad, pad:-pad], gap


def _largest_contour(covered: NDArray[np.uint8]) -> NDArray[np.int32]:
    contours, _ = cv2.findContours(covered, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    largest = max(contours, key=cv2.contourArea)
    return np.asarray(largest, dtype=np.int32)


def _simplified(contour: NDArray[np.int32], slack: float) -> Array:
    """Corners (n, 2) of a closed line that stays within `slack` of the contour."""
    return np.asarray(cv2.approxPolyDP(contour, slack, closed=True), dtype=np.float64).reshape(-1, 2)
