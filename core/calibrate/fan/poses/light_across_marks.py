"""The laser's light as it would be without the marks printed on a plate, along the lines found on it.

An extraction's filter sees half a stripe where it enters a mark, so it leaves out several filter σ there, and all of a
short piece between two marks; where the mark's edge crosses the stripe at a slant, points would be pulled aside. A
plane of light draws one straight line of rays on a flat plate: once a part of it is found, its course over the rest
is known. So what a mark hides, near the light that it cuts off, is taken from that light itself, mirrored along the
line at the mark's edge. What is found on such pixels does not count, but what is found beside them is whole.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates
from scipy.spatial import cKDTree

from core.calibrate.fan.poses.stripe_lines import StripeLine
from core.compiled import compiled, inlined
from core.image.mosaic import Sites
from core.image.stripes.centreline import Centreline
from core.image.stripes.stripe import StripeSettings
from core.model import Camera
from core.model.arrays import Array, runs_of

_BEND_REACH = 0.25
"""Of half a line's length beyond its ends, over which its bend is taken to go on; further out it goes straight on."""
_FAR = 8.0
"""Filter σ beside light up to which a mark is filled: the filter reaches 4 of them, and 4 are left out at an end."""
_BAND = 3.0
"""Filter σ on either side of a course that are filled."""
_ASTRAY_PX, _LEAST_COSINE = 1.5, 0.98
"""How far from its course, or half a stripe σ, and how askew to it, a line is none that follows it."""
_HALF_WINDOW, _SAMPLES = 2.5, 11
"""Filter σ on either side of a point over which its filter is taken to reach, and at how many places that is asked."""


class WholeLight(NamedTuple):
    """Light along lines without the marks that hide parts of it, (H, W) each.

    `picture` are its grey levels, `saturated` tells which of them are, `filled` which are those of other pixels, and
    `beside` which pixels are not along the lines.
    """

    picture: NDArray[np.float32]
    saturated: NDArray[np.bool_]
    filled: NDArray[np.bool_]
    beside: NDArray[np.bool_]

    def with_measured_sigma(self, line: Centreline, filter_px: float) -> Centreline:
        """Widen the σ of a line's points near filled-in pixels: what was copied there adds no information.

        With a share f of the filter σ `filter_px` on such pixels, the variance is 1 + 2 f times that of as many of its
        own: at a mark's edge, where half are, twice.
        """
        along = np.linspace(-_HALF_WINDOW, _HALF_WINDOW, _SAMPLES)
        places = line.uv[:, None] + filter_px * along[:, None] * line.tangent[:, None]
        filled = _at(self.filled.astype(np.uint8), places.reshape(-1, 2)).reshape(len(line), -1)
        weight = np.exp(-0.5 * along**2)
        return replace(line, sigma=line.sigma * np.sqrt(1 + 2 * (filled @ weight) / weight.sum()))


def across_marks(
    picture: NDArray[np.float32],
    saturated: NDArray[np.bool_],
    uneven: NDArray[np.bool_],
    courses: Sequence[Array],
    stripe: StripeSettings,
) -> WholeLight:
    """Fill the parts `uneven` (H, W) of a `picture` (H, W) of laser light, along the stripes' `courses`.

    Courses are (N, 4) u, v, n_u, n_v, one px from point to point along the tangent (−n_v, n_u).
    """
    points, band = np.vstack(courses), _BAND * stripe.filter_px
    pixels, nearest, n = _along(points, picture.shape, band)
    beside = np.ones(picture.shape, dtype=bool)
    beside[pixels[:, 1], pixels[:, 0]] = False
    hidden = uneven[pixels[:, 1], pixels[:, 0]]
    pixels, nearest, n = pixels[hidden], nearest[hidden], n[hidden]
    rows = np.arange(-np.ceil(band), np.ceil(band) + 1)
    mirrored = _mirrored(points, [len(course) for course in courses], rows, uneven, _FAR * stripe.filter_px)
    source = mirrored[nearest, np.rint(n - rows[0]).astype(np.intp)]
    known = source >= 0
    at = points[source[known], :2] + n[known, None] * points[source[known], 2:4]
    there = pixels[known, 1], pixels[known, 0]
    whole, full, filled = picture.copy(), saturated.copy(), np.zeros(picture.shape, dtype=bool)
    whole[there] = map_coordinates(picture, at.T[::-1], order=1, mode="nearest")
    full[there] = _at(saturated, at)
    filled[there] = True
    return WholeLight(whole, full, filled, beside)


def follows(line: Centreline, courses: Sequence[Array], stripe: StripeSettings) -> bool:
    """Whether a centreline runs along one of the `courses` (N, 4) of stripes: near it, and in its direction."""
    points = np.vstack(courses)
    away, nearest = cKDTree(points[:, :2]).query(line.uv)
    along = np.abs(np.einsum("ij,ij->i", line.normal, points[nearest, 2:4]))
    return bool(np.median(away) < max(_ASTRAY_PX, 0.5 * stripe.stripe_px) and np.median(along) > _LEAST_COSINE)


def course_of(line: StripeLine, camera: Camera, sites: Sites) -> Array:
    """Extend a stripe over the whole picture: points one px apart, (N, 4) u, v, n_u, n_v in px of the `sites`.

    Near its ends it is bent as where it was seen.
    """
    width, height = camera.image_size
    middle, along = line.pivots[:, :2].mean(axis=0), line.pivots[1, :2] - line.pivots[0, :2]
    along = along / np.linalg.norm(along)
    seen = line.rays[:, :2] - middle
    t, off = seen @ along, seen @ line.across
    bend = np.polynomial.Polynomial.fit(t, off, 2)
    border = camera.rays([[0, 0], [width - 1, 0], [width - 1, height - 1], [0, height - 1]])[:, :2]
    reach = float(np.linalg.norm(border - middle, axis=1).max())  # further out a distorted picture may be entered anew
    places = np.arange(-reach, reach, 0.5 / camera.focal)
    kept = np.clip(places, (1 + _BEND_REACH) * t.min(), (1 + _BEND_REACH) * t.max())
    bent = bend(kept) + bend.deriv()(kept) * (places - kept)
    uv = camera.pixels(middle + places[:, None] * along + bent[:, None] * line.across)
    uv = sites.places_of(uv[((uv >= 0) & (uv <= np.array([width, height]) - 1)).all(axis=1)])
    if len(uv) < 2:
        return np.empty((0, 4))
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(uv, axis=0).T))])
    at = np.arange(0.0, arc[-1] + 1.0)
    points = np.column_stack([np.interp(at, arc, uv[:, axis]) for axis in range(2)])
    tangent = np.gradient(points, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    return np.column_stack([points, tangent[:, 1], -tangent[:, 0]])


def _along(points: Array, shape: tuple[int, ...], band: float) -> tuple[NDArray[np.intp], NDArray[np.intp], Array]:
    """Pixels (K, 2) u, v within `band` px of courses, the nearest point of each, and how far along its normal it is."""
    nearest_of = _nearest(points, shape[0], shape[1], math.ceil(band))
    v, u = np.nonzero(nearest_of >= 0)
    nearest, pixels = nearest_of[v, u].astype(np.intp), np.column_stack([u, v])
    n = np.einsum("ij,ij->i", pixels - points[nearest, :2], points[nearest, 2:4])
    close = np.abs(n) <= band
    return pixels[close], nearest[close], n[close]


@compiled()
def _nearest(points: Array, height: int, width: int, reach: int) -> NDArray[np.int32]:
    """The nearest of `points` (N, ≥ 2) u, v to each pixel (H, W) at most `reach` px from one along u and v; else −1."""
    nearest = np.empty((height, width), np.int32)
    for v in range(height):
        for u in range(width):
            nearest[v, u] = -1
    # the nearest point of a pixel may be one that it is farther from along one axis
    farthest = math.ceil(math.sqrt(2.0) * (reach + 0.5)) + 1
    for distance in (reach, farthest):
        for k in range(len(points)):
            left, top = round(points[k, 0]), round(points[k, 1])
            for v in range(max(top - distance, 0), min(top + distance + 1, height)):
                for u in range(max(left - distance, 0), min(left + distance + 1, width)):
                    known = nearest[v, u]
                    if known < 0:
                        if distance == reach:
                            nearest[v, u] = k
                    elif _square(points, k, u, v) < _square(points, known, u, v):
                        nearest[v, u] = k
    return nearest


@inlined()
def _square(points: Array, k: int, u: int, v: int) -> float:
    """Square of the distance in px of point `k` from a pixel."""
    return float((points[k, 0] - u) ** 2 + (points[k, 1] - v) ** 2)


def _mirrored(
    points: Array, lengths: Sequence[int], rows: Array, uneven: NDArray[np.bool_], far: float
) -> NDArray[np.intp]:
    """For each point of the courses and each of the `rows` beside them, the point there that it mirrors, (N, R).

    −1 where none is near enough.
    """
    even = ~_at(uneven, points[:, None, :2] + rows[:, None] * points[:, None, 2:4])
    found, first = np.empty(even.shape, dtype=np.intp), 0
    for length in lengths:
        for row in range(len(rows)):
            own = _folded(even[first : first + length, row], far)
            found[first : first + length, row] = np.where(own >= 0, own + first, -1)
        first += length
    return found


def _folded(even: NDArray[np.bool_], far: float) -> NDArray[np.intp]:
    """For each place (N,) the one that it mirrors at the nearest end of an `even` stretch; −1 if that is `far`."""
    found, nearest = np.arange(len(even)), np.where(even, 0.0, np.inf)
    for start, end in runs_of(even):
        reach, length = math.floor(far), end - start
        for edge, outwards in ((start, -1), (end - 1, 1)):
            behind = np.arange(1, reach + 1)
            at = edge + outwards * behind
            away = (behind - 1) % (2 * length)  # a short stretch is mirrored to and fro
            mirror = edge - outwards * np.minimum(away, 2 * length - 1 - away)
            ok = (at >= 0) & (at < len(even))
            at, mirror, behind = at[ok], mirror[ok], behind[ok]
            nearer = behind < nearest[at]
            found[at[nearer]], nearest[at[nearer]] = mirror[nearer], behind[nearer]
    return np.where(nearest < np.inf, found, -1)


def _at(flags: NDArray[Any], uv: Array) -> NDArray[Any]:
    """What the pixels nearest to places (..., 2) hold; those beyond the picture's border what is there."""
    u, v = (np.rint(uv[..., axis]).astype(np.intp).clip(0, flags.shape[1 - axis] - 1) for axis in range(2))
    return np.asarray(flags[v, u])
