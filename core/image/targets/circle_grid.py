"""Centres of a grid of dark circles, freed of the perspective's bias."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.image.targets.ellipses import Ellipse, centre_shift, fit_dark_ellipses
from core.image.targets.kinds import CircleGrid
from core.image.targets.picture import Picture, as_8bit, enlarged, reduced, without_stripes
from core.image.targets.pose import homography_of, map_by
from core.image.targets.target_view import LEAVE_OUT_OR_RETAKE, OtherBoard, TargetNotFound, TargetView
from core.messages import Field, Message
from core.model import Camera
from core.model.arrays import Array

SYSTEMATIC_PX = 0.005
"""What is left on perfect pictures, RMS per coordinate."""

UNSUSPICIOUS_PX = 0.03
"""σ of a circle's centre up to which its outline is not suspected."""

LEAST_SHARE = 0.8
"""Share of the circles whose outline must be seen."""

_CIRCLES = Field("target.circles")

MOST_COUNTED = 1000
"""So many spots, and they are no target that was counted wrongly."""

MOST_SPOTS = 2
"""More round spots than this many grids' worth, and the picture shows a texture, not a target."""


def detect_circle_grid(grid: CircleGrid, picture: Picture, name: str = "", camera: Camera | None = None) -> TargetView:
    """Find the images of the circles' centres in `picture` (H, W), in the order of `grid.points`.

    An ellipse is fitted to each circle's sub-pixel outline. Its centre is not the image of the circle's centre: under
    perspective it lies off by up to f r² sin θ cos θ / Z² (0.3 px on a usual board). The shift follows from the plane's
    homography and the circles' radius, both measured here, and is taken off; the homography is that of undistorted
    rays if there is a `camera`. Circles whose outline cannot be followed (a laser stripe over them) are left out.

    Raises
    ------
    TargetNotFound
        If the grid is not there, is of another size, or a part of it is hidden.

    References
    ----------
    Heikkilä, J., Geometric camera calibration using circular control points, IEEE PAMI 22 (2000),
    doi:10.1109/34.879788.
    """
    full = as_8bit(picture)
    most_seen, counted = 0, None
    for longest in (1000, 2000):
        small, factor = reduced(full, longest)
        for candidate in (small, without_stripes(small, 7)):
            spots = _spots(candidate, grid)
            most_seen = max(most_seen, len(spots.uv))
            if most_seen > 2 * MOST_SPOTS * grid.columns * grid.rows:
                raise _failure(grid, most_seen, name)
            centres = _grid_centres(candidate, grid, spots)
            if centres is not None:
                _check_complete(grid, spots, centres, _counted(candidate, grid, spots), name)
                radii = spots.radius[cKDTree(spots.uv).query(centres)[1]]
                return _view(grid, picture, enlarged(centres, factor), radii * factor, name, camera)
            counted = counted or _counted(candidate, grid, spots)
        if factor == 1:
            break
    raise _failure(grid, most_seen, name) if counted is None else _other_grid(grid, counted, name)


@dataclass(frozen=True, eq=False, slots=True)
class _Spots:
    """Dark round spots: centres (N, 2) and radii (N,) in pixels."""

    uv: Array
    radius: Array


def _spot_finder(picture: NDArray[np.uint8], grid: CircleGrid) -> cv2.SimpleBlobDetector:
    settings = cv2.SimpleBlobDetector.Params()
    settings.minArea = 20
    settings.maxArea = 1.0 * picture.size / (grid.columns * grid.rows)
    settings.minDistBetweenBlobs = 5
    settings.minCircularity = 0.83  # a square has 0.785
    return cv2.SimpleBlobDetector.create(settings)


def _spots(picture: NDArray[np.uint8], grid: CircleGrid) -> _Spots:
    found = _spot_finder(picture, grid).detect(picture)
    return _Spots(
        np.array([spot.pt for spot in found], dtype=np.float64).reshape(-1, 2),
        np.array([spot.size / 2 for spot in found], dtype=np.float64),
    )


def _grid_centres(picture: NDArray[np.uint8], grid: CircleGrid, spots: _Spots) -> Array | None:
    """Centres (N, 2) to the pixel, in the order of `grid.points`; None if the spots do not make up the grid."""
    wanted = grid.columns * grid.rows
    if not wanted <= len(spots.uv) <= MOST_SPOTS * wanted:
        return None
    kind = cv2.CALIB_CB_ASYMMETRIC_GRID if grid.asymmetric else cv2.CALIB_CB_SYMMETRIC_GRID
    finder = _spot_finder(picture, grid)
    for flags in (kind, kind | cv2.CALIB_CB_CLUSTERING):
        found, centres = cv2.findCirclesGrid(picture, (grid.columns, grid.rows), flags=flags, blobDetector=finder)
        if found:
            return _ordered(grid, np.asarray(centres, dtype=np.float64).reshape(-1, 2))
    return None


def _counted(picture: NDArray[np.uint8], grid: CircleGrid, spots: _Spots) -> tuple[int, int] | None:
    """Columns and rows of another grid than `grid` that all the spots make up, none of it beyond the picture's border.

    None if they are as many as `grid` has, or make up none.
    """
    count = len(spots.uv)
    if count == grid.columns * grid.rows or count > MOST_COUNTED:
        return None
    for columns in range(count // 3, 2, -1):
        rows, rest = divmod(count, columns)
        turned = not grid.asymmetric and (columns - rows) * (grid.columns - grid.rows) < 0
        if rest or turned:
            continue
        other = replace(grid, columns=columns, rows=rows)
        centres = _grid_centres(picture, other, spots)
        if centres is not None and _ends_within(picture, other, centres):
            return columns, rows
    return None


def _ends_within(picture: NDArray[np.uint8], grid: CircleGrid, centres: Array) -> bool:
    """Whether a further row or column on any side would be seen in the picture, too, with all of its circles."""
    homography = homography_of(grid.points[:, :2], centres)
    if homography is None:
        return False
    step = 1.5 * (2 if grid.asymmetric else 1) * grid.pitch_mm
    low, high = grid.points[:, :2].min(axis=0) - step, grid.points[:, :2].max(axis=0) + step
    further = map_by(homography, np.array([low, (high[0], low[1]), high, (low[0], high[1])]))
    height, width = picture.shape
    return bool(((further > 0) & (further < [width - 1, height - 1])).all())


def _other_grid(grid: CircleGrid, counted: tuple[int, int], name: str) -> OtherBoard:
    return OtherBoard(
        Message(
            "target.other_circles",
            "the target shows {n} circles, not {all}",
            n=f"{counted[0]} × {counted[1]}",
            all=f"{grid.columns} × {grid.rows}",
        ),
        where=name,
        todo=Message("advice.check_circles", "check the number of {field}", field=_CIRCLES),
        counted=counted,
    )


def _ordered(grid: CircleGrid, centres: Array) -> Array | None:
    """`centres` in the order that :class:`CircleGrid` promises; None if they are no grid after all."""
    ways = [centres]
    if not grid.asymmetric:
        block = centres.reshape(grid.rows, grid.columns, 2)
        turned = (np.rot90(way, turn) for way in (block, block[:, ::-1]) for turn in range(4))
        ways = [way.reshape(-1, 2) for way in turned if way.shape == block.shape]
    fitting = [way for way in ways if _fits(grid, way)]
    return min(fitting, key=lambda way: float(way[0].sum())) if fitting else None


def _fits(grid: CircleGrid, centres: Array) -> bool:
    """Whether `centres` are the grid's image under a right-handed homography, to a fifth of the pitch."""
    homography = homography_of(grid.points[:, :2], centres)
    if homography is None:
        return False
    error = np.abs(map_by(homography, grid.points[:, :2]) - centres).max()
    pitch = np.linalg.norm(centres[1] - centres[0])
    weight = np.column_stack([grid.points[:, :2], np.ones(len(centres))]) @ homography[2]
    return bool(error < 0.2 * pitch and np.linalg.det(homography) * weight.mean() > 0)


def _check_complete(
    grid: CircleGrid, spots: _Spots, centres: Array, counted: tuple[int, int] | None, name: str
) -> None:
    """Refuse a part of a larger grid: spots of the same size where a further row or column would be.

    `counted` are the columns and rows that all spots make up, if they do.
    """
    if counted is not None:
        raise _other_grid(grid, counted, name)
    if grid.asymmetric:
        return
    block = centres.reshape(grid.rows, grid.columns, 2)
    tree = cKDTree(spots.uv)
    usual = float(np.median(spots.radius[tree.query(centres)[1]]))
    for turn in range(4):
        way = np.rot90(block, turn)
        further = 3 * way[0] - 3 * way[1] + way[2]
        distance, index = tree.query(further)
        reach = 0.25 * np.linalg.norm(way[0] - way[1], axis=1)
        alike = np.abs(np.log(spots.radius[index] / usual)) < 0.4
        if np.mean((distance < reach) & alike) > 0.75:
            raise TargetNotFound(
                Message(
                    "target.more_circles",
                    "the target shows more than {columns} × {rows} circles",
                    columns=grid.columns,
                    rows=grid.rows,
                ),
                where=name,
                todo=Message("advice.check_circles", "check the number of {field}", field=_CIRCLES),
            )


def _view(
    grid: CircleGrid, picture: Picture, centres: Array, radii: Array, name: str, camera: Camera | None
) -> TargetView:
    """Ellipses at full size, and the perspective's shift taken off their centres."""
    fitted = fit_dark_ellipses(picture, centres, radii)
    usual = float(np.median([ellipse.sigma for ellipse in fitted if ellipse is not None] or [0.0]))
    fitted = [
        ellipse if ellipse is not None and ellipse.sigma < max(UNSUSPICIOUS_PX, 5 * usual) else None
        for ellipse in fitted
    ]
    followed = np.array([ellipse is not None for ellipse in fitted])
    ellipses = [ellipse for ellipse in fitted if ellipse is not None]
    if len(ellipses) < LEAST_SHARE * len(fitted):
        raise TargetNotFound(
            Message(
                "target.outlines_lost",
                "the outlines of {n} of the {all} circles cannot be followed",
                n=len(fitted) - len(ellipses),
                all=len(fitted),
            ),
            where=name,
            todo=Message("advice.show_circles", "check focus and exposure, and that nothing covers the circles"),
        )
    points = grid.points[followed]
    uv = np.array([ellipse.centre for ellipse in ellipses])
    sigma = np.hypot([ellipse.sigma for ellipse in ellipses], SYSTEMATIC_PX)
    return TargetView(points, _without_shift(points[:, :2], uv, ellipses, camera), sigma, name)


def _without_shift(xy: Array, uv: Array, ellipses: list[Ellipse], camera: Camera | None) -> Array:
    """Images (N, 2) of the circles' centres `xy` (N, 2) from the ellipses' centres `uv` (N, 2)."""
    area = np.array([abs(np.linalg.det(ellipse.shape)) for ellipse in ellipses])  # over π
    if camera is None:
        flat, flat_area = uv, area
    else:
        rays = camera.rays(uv)
        flat, flat_area = rays[:, :2], area * np.abs(np.linalg.det(camera.ray_jacobian(rays)))
    centre = flat
    for _ in range(3):
        homography = homography_of(xy, centre)
        if homography is None:
            return uv
        weight = np.column_stack([xy, np.ones(len(xy))]) @ homography[2]
        radius = float(np.sqrt(np.median(flat_area / np.abs(np.linalg.det(homography) / weight**3))))
        centre = flat - centre_shift(homography, xy, radius)
    return centre if camera is None else camera.pixels(centre)


def _failure(grid: CircleGrid, seen: int, name: str) -> TargetNotFound:
    wanted = grid.columns * grid.rows
    if seen < 0.3 * wanted or seen > MOST_SPOTS * wanted:
        return TargetNotFound(
            Message("target.no_circle_grid", "no grid of circles is seen in the picture"),
            where=name,
            todo=LEAVE_OUT_OR_RETAKE,
        )
    return TargetNotFound(
        Message(
            "target.spots_without_grid",
            "{n} round dark spots are seen, but no {columns} × {rows} grid of circles",
            n=seen,
            columns=grid.columns,
            rows=grid.rows,
        ),
        where=name,
        todo=Message(
            "advice.show_whole_target",
            "show the whole target, and check the number of {field}",
            field=_CIRCLES,
        ),
    )
