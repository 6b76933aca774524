"""Surface of triangles, such as a nominal one, and the signed distance of points from it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.model.arrays import Array, frozen_array, set_field

# Chosen by time and memory at the same distances: tests/scan/surface/test_triangles.py holds them.
CANDIDATES, MORE_CANDIDATES = 8, 4
"""Triangles tried first for each point, and the factor of more where that may not be enough."""
MOST_PIECES = 400_000
"""Pieces that a surface is cut into at most, about."""
AT_ONCE = 200_000
"""Pairs of a point and a triangle that are compared at once: about 100 MB."""


@dataclass(frozen=True, eq=False, slots=True)
class Triangles:
    """Surface of triangles, with corners (T, 3, 3) in mm; seen from outside each runs anticlockwise.

    They stand for a surface that lies up to `chord_mm` off them; 0 where that is not known, as of an STL file.
    """

    corners: Array
    chord_mm: float = 0.0

    def __post_init__(self) -> None:
        set_field(self, "corners", frozen_array(self.corners, (None, 3, 3), "corners"))

    @property
    def normals(self) -> Array:
        """Outward unit normals (T, 3); zero for a triangle without area."""
        cross = np.cross(self.corners[:, 1] - self.corners[:, 0], self.corners[:, 2] - self.corners[:, 0])
        return np.asarray(cross / np.maximum(np.linalg.norm(cross, axis=1), 1e-30)[:, None])

    @property
    def size_mm(self) -> float:
        """Diagonal in mm of the box, along the axes, around all triangles."""
        return float(np.linalg.norm(np.ptp(self.corners.reshape(-1, 3), axis=0)))

    def moved(self, rotation: Array, translation: Array) -> Triangles:
        """Copy the surface moved by X → R X + t, R (3, 3) and t (3,) in mm."""
        return replace(self, corners=self.corners @ rotation.T + translation)


@dataclass(frozen=True, eq=False, slots=True)
class Nearest:
    """Nearest places of N points: on the surface (N, 3) in mm, outward normal (N, 3), signed distance (N,) in mm."""

    foot: Array
    normal: Array
    distance: Array


@dataclass(frozen=True, eq=False, slots=True)
class _SizeClass:
    """Pieces of about one size: a tree of their middles, the triangles they are of, how far corners are at most."""

    tree: cKDTree
    of: NDArray[np.int64]
    reach: float


@dataclass(frozen=True, eq=False, slots=True)
class _Best:
    """The nearest found so far of N points: distance (N,), foot (N, 3), triangle (N,)."""

    distance: Array
    foot: Array
    which: NDArray[np.int64]


class ProximityQuery:
    """Index of a surface of triangles for finding the place on it that is nearest to a point.

    `surface` are the triangles themselves. They are kept in classes of about one size, each with a tree of its own: the
    reach of a few large triangles must not make every small one a candidate.
    """

    def __init__(self, surface: Triangles) -> None:
        pieces, of = _cut(surface.corners)
        self.surface, self._normals = surface, surface.normals
        self.size_mm = surface.size_mm
        centres = pieces.mean(axis=1)
        radius = np.linalg.norm(pieces - centres[:, None], axis=2).max(axis=1)
        size = np.round(np.log2(np.maximum(radius, 1e-9))).astype(np.int64)
        self._classes = []
        for one in np.unique(size):
            mine = np.flatnonzero(size == one)
            self._classes.append(_SizeClass(cKDTree(centres[mine]), of[mine], float(radius[mine].max())))

    def nearest(self, points: Array, exact_within: float = np.inf) -> Nearest:
        """Find the nearest place on the surface for each point (N, 3); exact for those within `exact_within` mm.

        A piece whose middle is farther than the best distance found plus its class's reach cannot be nearer. Beyond
        `exact_within` (−inf: at all) it is the nearest place of pieces nearest by their middles, at most their reach
        too far: far from a surface very many pieces are nearly as near.
        """
        best = _Best(np.full(len(points), np.inf), np.zeros_like(points), np.zeros(len(points), dtype=np.int64))
        for kind in self._classes:
            self._search(points, kind, exact_within, best)
        return self._signed(points, best.foot, best.which)

    def _search(self, points: Array, kind: _SizeClass, exact_within: float, best: _Best) -> None:
        """Search the pieces of one class for nearer ones than were found."""
        left, count = np.arange(len(points)), min(CANDIDATES, kind.tree.n)
        while len(left):
            unsure = np.zeros(len(left), dtype=np.bool_)
            for start in range(0, len(left), max(1, AT_ONCE // count)):
                part = slice(start, start + max(1, AT_ONCE // count))
                farthest = self._compare(points, left[part], count, kind, best)
                away = best.distance[left[part]]
                unsure[part] = (farthest < away + kind.reach) & (away <= exact_within + kind.reach)
            left = left[unsure & (count < kind.tree.n)]
            count = min(MORE_CANDIDATES * count, kind.tree.n)

    def _compare(self, points: Array, which: NDArray[np.int64], count: int, kind: _SizeClass, best: _Best) -> Array:
        """Compare some points with the `count` nearest pieces; how far the middle of the last of them is."""
        found = kind.tree.query(points[which], k=[*range(1, count + 1)])
        far, pieces = np.asarray(found[0], dtype=np.float64), np.asarray(found[1], dtype=np.int64)
        triangles = kind.of[pieces]
        feet = _foot(points[which, None], self.surface.corners[triangles])
        away = np.linalg.norm(feet - points[which, None], axis=2)
        rows, first = np.arange(len(which)), np.argmin(away, axis=1)
        nearer = away[rows, first] < best.distance[which]
        mine, rows, first = which[nearer], rows[nearer], first[nearer]
        best.distance[mine], best.foot[mine] = away[rows, first], feet[rows, first]
        best.which[mine] = triangles[rows, first]
        return far[:, -1]

    def _signed(self, points: Array, foot: Array, which: NDArray[np.int64]) -> Nearest:
        between = points - foot
        away = np.linalg.norm(between, axis=1)
        normal = self._normals[which]
        sign = np.where((between * normal).sum(axis=1) >= 0, 1.0, -1.0)
        return Nearest(foot, normal, sign * away)


def _cut(corners: Array) -> tuple[Array, NDArray[np.int64]]:
    """The triangles cut at the middle of their longest edge until none is much larger than the others allow."""
    of = np.arange(len(corners))
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    longest = max(2.0 * np.sqrt(float(area.sum()) / max(20_000, 2 * len(corners))), 1e-6)
    while True:
        edges = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)  # edge i: corner i to i + 1
        long = edges.max(axis=1) > longest
        if not long.any() or len(corners) > MOST_PIECES:
            return corners, of
        first = edges[long].argmax(axis=1)
        rolled = np.take_along_axis(corners[long], ((first[:, None] + np.arange(3)) % 3)[:, :, None], axis=1)
        a, b, c = rolled[:, 0], rolled[:, 1], rolled[:, 2]
        middle = (a + b) / 2
        halves = [np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)]
        corners = np.concatenate([corners[~long], *halves])
        of = np.concatenate([of[~long], of[long], of[long]])


def _foot(points: Array, corners: Array) -> Array:
    """The place of each triangle (N, k, 3, 3) nearest to its point (N, 1, 3).

    Ericson, Real-Time Collision Detection (2005), 5.1.5: by the region of the triangle's plane the point lies over.
    """
    a, b, c = corners[..., 0, :], corners[..., 1, :], corners[..., 2, :]
    ab, ac, ap, bp, cp = b - a, c - a, points - a, points - b, points - c

    def dot(one: Array, other: Array) -> Array:
        return np.asarray((one * other).sum(axis=-1))

    d1, d2, d3, d4, d5, d6 = dot(ab, ap), dot(ac, ap), dot(ab, bp), dot(ac, bp), dot(ab, cp), dot(ac, cp)
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2

    def share(part: Array, whole: Array) -> Array:
        return np.asarray(part / np.where(np.abs(whole) > 0, whole, 1.0))[..., None]

    inside = a + share(vb, va + vb + vc) * ab + share(vc, va + vb + vc) * ac
    cases = (
        ((d1 <= 0) & (d2 <= 0), a),
        ((d3 >= 0) & (d4 <= d3), b),
        ((vc <= 0) & (d1 >= 0) & (d3 <= 0), a + share(d1, d1 - d3) * ab),
        ((d6 >= 0) & (d5 <= d6), c),
        ((vb <= 0) & (d2 >= 0) & (d6 <= 0), a + share(d2, d2 - d6) * ac),
        ((va <= 0) & (d4 >= d3) & (d5 >= d6), b + share(d4 - d3, (d4 - d3) + (d5 - d6)) * (c - b)),
    )
    return np.asarray(
        np.select([np.repeat(when[..., None], 3, -1) for when, _ in cases], [at for _, at in cases], inside)
    )
