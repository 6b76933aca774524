"""Ellipses through sub-pixel edge points, and what perspective does to a circle's centre."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.image.targets.edges import PictureSpline, profiles
from core.image.targets.picture import Picture
from core.model.arrays import Array
from core.model.robust import MAD_TO_SD

SAMPLES = (32, 256)
"""Fewest and most places on an outline where its edge is looked for; between them one for each pixel."""

LEAST_SEEN = 0.6
"""Share of an outline's places that must fit its ellipse."""

LEAST_POINTS = 8
"""So many of them, however few there are."""


@dataclass(frozen=True, eq=False, slots=True)
class Ellipse:
    """Fitted ellipse: `centre` (2,) in px, `sigma` of each of its coordinates.

    `shape` (2, 2) maps the unit circle onto it.
    """

    centre: Array
    shape: Array
    sigma: float


@dataclass(frozen=True, eq=False, slots=True)
class _Ellipses:
    """Some ellipses: as :class:`Ellipse`, each with one more axis (N, …) in front."""

    centre: Array
    shape: Array
    sigma: Array

    def of(self, which: NDArray[np.bool_]) -> _Ellipses:
        """Those that `which` (N,) names."""
        return _Ellipses(self.centre[which], self.shape[which], self.sigma[which])


@dataclass(frozen=True, eq=False, slots=True)
class _Outlines:
    """Edge points `uv` (N, K, 2) of N outlines; `plain` (N, K) False where there is none, or not a mere edge.

    `places` (N,) are how many were looked for: the rest of a row is filled up.
    """

    uv: Array
    plain: NDArray[np.bool_]
    places: NDArray[np.intp]


def fit_dark_ellipses(picture: Picture, centres: Array, radii: Array) -> list[Ellipse | None]:
    """Fit ellipses to dark discs near `centres` (N, 2) of about `radii` (N,) px; None if less than 60 % of one fits.

    All at a time: a fit for each costs twenty times what its sums do.
    """
    reach = np.maximum(3.0, 0.45 * radii)
    splines = [
        PictureSpline(picture, centre[None], 1.6 * radius + 2 * half_width + 4)
        for centre, radius, half_width in zip(centres, radii, reach, strict=True)
    ]
    left = np.arange(len(centres))
    ellipses = _Ellipses(centres, radii[:, None, None] * np.eye(2), np.zeros(len(centres)))
    for widest in (np.inf, 5.0, 5.0):
        outlines = _outlines([splines[index] for index in left], ellipses, np.minimum(reach[left], widest))
        ellipses, fitted = _through_most(outlines)
        left = left[fitted]
        near = np.linalg.norm(ellipses.centre - centres[left], axis=1) <= radii[left]
        ellipses, left = ellipses.of(near), left[near]
    found: list[Ellipse | None] = [None] * len(centres)
    for index, centre, shape, sigma in zip(left, ellipses.centre, ellipses.shape, ellipses.sigma, strict=True):
        found[index] = Ellipse(centre, shape, float(sigma))
    return found


def _outlines(splines: Sequence[PictureSpline], about: _Ellipses, half_width: Array) -> _Outlines:
    """Edge points across the outlines of `about`, looked for up to `half_width` (N,) pixels on either side."""
    perimeter = 2 * np.pi * np.sqrt(np.abs(np.linalg.det(about.shape)))
    places = np.clip(perimeter, *SAMPLES).astype(np.intp)
    most = int(places.max(initial=0))
    uv = np.zeros((len(splines), most, 2))
    valid = np.zeros((len(splines), most), dtype=bool)
    steepness, fall, rise = np.zeros(valid.shape), np.zeros(valid.shape), np.full(valid.shape, np.nan)
    for n, (spline, count) in enumerate(zip(splines, places, strict=True)):
        angle = np.arange(count) * 2 * np.pi / count
        circle = np.column_stack([np.cos(angle), np.sin(angle)])
        outward = circle @ np.linalg.inv(about.shape[n])
        outward /= np.linalg.norm(outward, axis=1, keepdims=True)
        start = about.centre[n] + circle @ about.shape[n].T
        across = profiles(spline, start, outward, half_width[n])
        uv[n, :count] = start + across.offset[:, None] * outward
        valid[n, :count], steepness[n, :count], fall[n, :count] = across.valid, across.steepness, across.fall
        rise[n, :count] = across.bright - across.dark
    steep = valid & (steepness > 0.4 * _quantiles(steepness, valid, 0.5)[:, None])
    usual_fall = _quantiles(fall, valid, 0.3) + 0.1 * _quantiles(rise, np.isfinite(rise), 0.5)
    plain = steep & (fall < 1.5 * usual_fall[:, None])  # no stripe crosses the profile
    return _Outlines(uv, plain, places)


def _through_most(outlines: _Outlines) -> tuple[_Ellipses, NDArray[np.intp]]:
    """The ellipses through most points of their outlines, and the indices of the outlines that have one."""
    left = np.arange(len(outlines.places))
    uv, plain, used = outlines.uv, outlines.plain, outlines.plain
    least = np.maximum(LEAST_POINTS, LEAST_SEEN * outlines.places)
    ellipses, distance = _Ellipses(np.zeros((0, 2)), np.zeros((0, 2, 2)), np.zeros(0)), np.zeros(used.shape)
    for _ in range(4):
        enough = used.sum(axis=1) >= least[left]
        left, uv, plain, used = left[enough], uv[enough], plain[enough], used[enough]
        ellipses, elliptic = _least_squares(uv, used)
        left, uv, plain, used = left[elliptic], uv[elliptic], plain[elliptic], used[elliptic]
        distance = _distances(ellipses, uv)
        scale = np.maximum(MAD_TO_SD * _quantiles(np.abs(distance), used, 0.5), 0.02)
        used = plain & (np.abs(distance) < 4 * scale[:, None])
    count = used.sum(axis=1)
    sigma = np.sqrt(np.where(used, distance**2, 0.0).sum(axis=1) * 2) / count
    return _Ellipses(ellipses.centre, ellipses.shape, sigma), left


def _quantiles(values: Array, used: NDArray[np.bool_], share: float) -> Array:
    """The quantile (N,) of the used ones of `values` (N, K) in each row; infinite where there is none."""
    ranked = np.sort(np.where(used, values, np.inf), axis=1)
    at = np.maximum(used.sum(axis=1) - 1, 0) * share
    low, rows = at.astype(np.intp), np.arange(len(values))
    below, above = ranked[rows, low], ranked[rows, np.minimum(np.ceil(at).astype(np.intp), ranked.shape[1] - 1)]
    with np.errstate(invalid="ignore"):  # infinite less infinite
        return np.asarray(np.where(at > low, below + (at - low) * (above - below), below), dtype=np.float64)


def _least_squares(uv: Array, used: NDArray[np.bool_]) -> tuple[_Ellipses, NDArray[np.bool_]]:
    """Direct ellipse fits (Halíř & Flusser 1998) to the used of points (N, K, 2), normalised for conditioning.

    The ellipses, and which (N,) of the rows have one.
    """
    weight = used.astype(np.float64)[..., None]
    count = weight.sum(axis=1)
    middle = (uv * weight).sum(axis=1) / count
    centred = (uv - middle[:, None]) * weight
    scale = np.sqrt((centred**2).sum(axis=(1, 2)) / (2 * count[:, 0]))
    x, y = np.moveaxis(centred / scale[:, None, None], 2, 0)
    quadratic = np.stack([x * x, x * y, y * y], axis=2)
    linear = np.stack([x, y, weight[..., 0]], axis=2)
    turned, turned_linear = quadratic.transpose(0, 2, 1), linear.transpose(0, 2, 1)
    from_linear = -np.linalg.solve(turned_linear @ linear, turned_linear @ quadratic)
    reduced = turned @ quadratic + turned @ linear @ from_linear
    vectors = np.linalg.eig(np.stack([reduced[:, 2] / 2, -reduced[:, 1], reduced[:, 0] / 2], axis=1))[1].real
    is_ellipse = 4 * vectors[:, 0] * vectors[:, 2] - vectors[:, 1] ** 2 > 0
    rows = np.flatnonzero(is_ellipse.any(axis=1))
    quadratic_part = vectors[rows, :, is_ellipse[rows].argmax(axis=1)]
    linear_part = np.einsum("nij,nj->ni", from_linear[rows], quadratic_part)
    form = quadratic_part[:, [[0, 1], [1, 2]]] * [[1.0, 0.5], [0.5, 1.0]]
    centre = np.linalg.solve(2 * form, -linear_part[:, :2, None])[..., 0]
    level = np.einsum("ni,nij,nj->n", centre, form, centre) - linear_part[:, 2]
    values, axes = np.linalg.eigh(form / level[:, None, None])
    real = (values > 0).all(axis=1)
    rows, values, axes, centre = rows[real], values[real], axes[real], centre[real]
    half_axes = axes * (scale[rows, None] / np.sqrt(values))[:, None, :]
    fits = np.zeros(len(uv), dtype=bool)
    fits[rows] = True
    placed = middle[rows] + scale[rows, None] * centre
    return _Ellipses(placed, half_axes @ axes.transpose(0, 2, 1), np.zeros(len(rows))), fits


def _distances(ellipses: _Ellipses, points: Array) -> Array:
    """Signed distances (N, K) in pixels of `points` (N, K, 2) from their outlines, to first order."""
    back = np.linalg.inv(ellipses.shape)
    local = (points - ellipses.centre[:, None]) @ back.transpose(0, 2, 1)
    radius = np.linalg.norm(local, axis=2)
    gradient = np.linalg.norm(local @ back, axis=2) / radius
    distances: Array = (radius - 1) / gradient
    return distances


def centre_shift(homography: Array, centres: Array, radius: float) -> Array:
    """Compute (N, 2) in px: centre of a circle's elliptic image minus the image of the circle's centre.

    The image of the circle x² + y² = r² about c has the dual conic H T diag(r², r², −1) Tᵀ Hᵀ; an ellipse's centre is
    the first two elements of the last column of its dual conic, over the third.

    Parameters
    ----------
    centres
        (N, 2) in the plane of the target.
    radius
        In the units of the plane.
    """
    h1, h2 = homography[:, 0], homography[:, 1]
    ends = np.column_stack([centres, np.ones(len(centres))]) @ homography.T
    # the dual conic is r² (h1 h1ᵀ + h2 h2ᵀ) − e eᵀ, with e the image of the centre
    last = radius**2 * (h1 * h1[2] + h2 * h2[2]) - ends * ends[:, 2:]
    shift: Array = last[:, :2] / last[:, 2:] - ends[:, :2] / ends[:, 2:]
    return shift
