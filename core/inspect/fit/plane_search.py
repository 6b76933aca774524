"""Planes in the cloud, found one after the other by RANSAC.

Three points near each other and of like normals make a hypothesis, the area it explains is its vote, more where points
are closer (MSAC), and the best few are refined before the winner is chosen (locally optimised RANSAC).

References
----------
Fischler, Bolles, Random sample consensus, Comm. ACM 24 (1981), doi:10.1145/358669.358692.
Torr, Zisserman, MLESAC, CVIU 78 (2000), doi:10.1006/cviu.1999.0832.
Chum, Matas, Kittler, Locally optimized RANSAC, DAGM 2003, doi:10.1007/978-3-540-45243-0_31.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.inspect.face_region import Region, most_lies_elsewhere, region_on
from core.messages import Message
from core.model.arrays import Array
from core.progress import Progress, silent
from core.scan.surface.cloud import FAN, Cloud
from core.scan.surface.normals import pixel_angle, with_normals

POINT_CLOUD = Message("surface.where_cloud", "point cloud")
"""Where a search complains of."""

SEARCH_POINTS = 8000
"""About as many points, spread evenly over the picture, are enough to find the planes."""
HYPOTHESES = 300
"""Triples of neighbouring points tried: a face with a tenth of the points is hit by 30 of them."""
FINALISTS = 5
"""The best hypotheses, each refined before the winner is chosen."""
MOST_TRIED = 40
"""So many of the best, as long as among those before are planes that slant through narrow treads."""
MOST_PLANES = 8
"""Faces looked for: as many as features can name by number (`core.inspect.plan.kinds.MOST_FACES`)."""
FEWEST_POINTS = 12
"""Of a plane face: four times what a plane needs."""
LIKE_NORMALS = np.cos(np.radians(30.0))
"""Points of a plane have local normals within 30° of its own: slices of a sphere or a mask do not."""


@dataclass(frozen=True, eq=False, slots=True)
class FoundPlane:
    """Plane normal·X = distance in mm, its normal away from the camera, and its contiguous region."""

    normal: Array
    distance: float
    region: Region


def find_planes(
    cloud: Cloud,
    *,
    margin_mm: float = 1.5,
    most: int = MOST_PLANES,
    seed: int = 0,
    progress: Progress = silent,
) -> list[FoundPlane]:
    """Find at most `most` plane faces of a cloud by RANSAC, the one of the largest area first.

    Parameters
    ----------
    cloud
        Normals are estimated when it has none.
    margin_mm
        Points nearer than this to the edge of their face are left out: stripes are biased there.
    most
        How many are looked for.
    seed
        Of the random search; the same seed gives the same planes.
    progress
        Called with how far it is.
    """
    tolerance = search_tolerance(cloud)
    if len(cloud) >= 3 and not cloud.normals.any():
        cloud = with_normals(cloud, progress=progress)
    left = np.arange(len(cloud))
    planes: list[FoundPlane] = []
    for round_ in range(most):
        progress("faces", round_, most)
        part = cloud.select(left)
        plane = largest_plane(part, tolerance, margin_mm, seed + round_, cloud)
        if plane is None:
            break
        near = _on_plane(part, plane.normal, plane.distance, 2 * tolerance)
        region = Region(left[plane.region.indices], plane.region.area_mm2)
        planes.append(FoundPlane(plane.normal, plane.distance, region))
        left = left[~near]
    progress("faces", most, most)
    return planes


def above_table(cloud: Cloud, tolerance: float, seed: int, progress: Progress) -> NDArray[np.int64]:
    """Select the points nearer to the camera than the largest plane, by over 3 `tolerance` (mm); return their indices.

    All points if there is no plane.
    """
    planes = find_planes(cloud, seed=seed, progress=progress, most=1)
    if not planes:
        return np.arange(len(cloud))
    return np.flatnonzero(cloud.points @ planes[0].normal < planes[0].distance - 3 * tolerance)


def points_on(cloud: Cloud, plane: FoundPlane, tolerance_mm: float) -> NDArray[np.int64]:
    """Select the points of a cloud within `tolerance_mm` of a plane whose normals agree with it; return indices."""
    return np.flatnonzero(_on_plane(cloud, plane.normal, plane.distance, tolerance_mm))


def search_tolerance(cloud: Cloud) -> float:
    """Compute the largest distance in mm of a point from a plane it belongs to: five median σ, at least 0.25 mm."""
    return max(0.25, 5 * float(np.median(cloud.sigma))) if len(cloud) else 0.25


def largest_plane(
    cloud: Cloud, tolerance: float, margin_mm: float, seed: int, whole: Cloud | None = None
) -> FoundPlane | None:
    """Find the plane of the largest area in a cloud, its region less `margin_mm`; None if there is no plane.

    Parameters as for `find_planes`; `tolerance` in mm. The cloud may be what earlier planes have left of a `whole` one.
    """
    whole = cloud if whole is None else whole
    rng = np.random.default_rng(seed)
    sample, area = _even_sample(cloud, rng)
    if len(sample) < FEWEST_POINTS:
        return None
    oriented = _OrientedPoints.of(cloud.points[sample], cloud.normals[sample])
    candidates = _hypotheses(oriented.points, oriented.normals, rng)
    votes = np.array([_vote(oriented, area, n, d, tolerance) for n, d in candidates])
    order = np.argsort(-votes, kind="stable")
    for first in range(0, MOST_TRIED, FINALISTS):
        finalists = [
            _refined(oriented, area, candidates[index], tolerance) for index in order[first : first + FINALISTS]
        ]
        slanting = False
        for vote, normal, distance in sorted(finalists, key=lambda one: -one[0]):
            on = np.flatnonzero(_on_plane(cloud, normal, distance, tolerance))
            region = region_on(cloud, on, normal, margin_mm)
            if vote <= 0 or not len(region.indices):  # nothing may be left of a plane that slants through stairs
                continue
            off = (whole.sweep > FAN) & (np.abs(whole.points @ normal - distance) > tolerance)
            if not most_lies_elsewhere(cloud, on, normal, margin_mm, whole.points[off]):
                return FoundPlane(normal, distance, region)
            slanting = True
        if not slanting:
            break
    return None


def _refined(
    oriented: _OrientedPoints, area: Array, hypothesis: tuple[Array, float], tolerance: float
) -> tuple[float, Array, float]:
    """Vote, normal and distance of a hypothesis fitted to the points near it, again and again."""
    normal, distance = hypothesis
    for _ in range(4):
        near = oriented.near(normal, distance, tolerance)
        if near.sum() < 6:
            break
        normal, distance = _mean_plane(oriented.points[near], area[near])
    return _vote(oriented, area, normal, distance, tolerance), normal, distance


@dataclass(frozen=True, eq=False, slots=True)
class _OrientedPoints:
    """Points (N, 3) and, where known, the normals (N, 3) there; `least` (N,) of each must lie along a plane's."""

    points: Array
    normals: Array
    least: Array

    @classmethod
    def of(cls, points: Array, normals: Array) -> _OrientedPoints:
        return cls(points, normals, LIKE_NORMALS * np.linalg.norm(normals, axis=1))

    def near(self, normal: Array, distance: float, tolerance: float) -> NDArray[np.bool_]:
        """Which points lie within `tolerance` of the plane and do not face elsewhere."""
        close = np.abs(self.points @ normal - distance) < tolerance
        elsewhere = np.abs(self.normals @ normal) < self.least
        near: NDArray[np.bool_] = close & ~elsewhere
        return near


def _vote(oriented: _OrientedPoints, area: Array, normal: Array, distance: float, tolerance: float) -> float:
    """The area in mm² that a plane explains, the less of it the farther it is away (MSAC).

    A plane that slants through stairs has as much within the tolerance as one of them, but little close by.
    """
    near = oriented.near(normal, distance, tolerance)
    return float(area[near] @ (1 - ((oriented.points[near] @ normal - distance) / tolerance) ** 2))


def _even_sample(cloud: Cloud, rng: np.random.Generator) -> tuple[NDArray[np.int64], Array]:
    """Indices of one random point per cell of the picture, about SEARCH_POINTS in all, and each one's area (mm²)."""
    if len(cloud) < FEWEST_POINTS or not np.ptp(cloud.uv, axis=0).all():
        return np.arange(len(cloud)), np.ones(len(cloud))
    low, high = cloud.uv.min(axis=0), cloud.uv.max(axis=0)
    cell = max(float(np.sqrt(np.prod(high - low) / SEARCH_POINTS)), 1.0)
    column, row = np.floor((cloud.uv - low) / cell).astype(np.int64).T
    shuffled = rng.permutation(len(cloud))
    _, first = np.unique((row * (column.max() + 1) + column)[shuffled], return_index=True)
    sample = np.sort(shuffled[first])
    side = cell * pixel_angle(cloud.points, cloud.uv) * cloud.points[sample, 2]
    return sample, side**2


def _hypotheses(points: Array, normals: Array, rng: np.random.Generator) -> list[tuple[Array, float]]:
    """Planes through three random points near each other whose normals, where known, agree."""
    first = rng.integers(len(points), size=HYPOTHESES)
    near = np.asarray(cKDTree(points).query(points[first], k=min(200, len(points)))[1], dtype=np.int64)
    picks = rng.integers(near.shape[1] // 4, near.shape[1], size=(HYPOTHESES, 2))
    rows = np.arange(HYPOTHESES)
    triples = np.stack([first, near[rows, picks[:, 0]], near[rows, picks[:, 1]]], axis=1)
    a, b, c = (points[triples[:, corner]] for corner in range(3))
    cross = np.cross(b - a, c - a)
    size = np.linalg.norm(cross, axis=1)
    sides = np.linalg.norm(b - a, axis=1) * np.linalg.norm(c - a, axis=1)
    sound = size > 0.2 * sides  # not nearly on one line
    hypotheses = []
    for triple, normal in zip(triples[sound], cross[sound] / size[sound, None], strict=True):
        known = normals[triple][normals[triple].any(axis=1)]
        distance = float(normal @ points[triple].mean(axis=0))
        if (np.abs(known @ normal) > LIKE_NORMALS).all():
            hypotheses.append((normal, distance) if distance > 0 else (-normal, -distance))
    return hypotheses


def _on_plane(cloud: Cloud, normal: Array, distance: float, tolerance: float) -> NDArray[np.bool_]:
    return _OrientedPoints.of(cloud.points, cloud.normals).near(normal, distance, tolerance)


def _mean_plane(points: Array, weights: Array) -> tuple[Array, float]:
    """Weighted orthogonal least-squares plane, its normal away from the camera."""
    centroid = weights @ points / weights.sum()
    centred = points - centroid
    normal = np.linalg.eigh((centred * weights[:, None]).T @ centred)[1][:, 0]
    distance = float(normal @ centroid)
    return (normal, distance) if distance > 0 else (-normal, -distance)
