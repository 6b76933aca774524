"""Ellipses through sub-pixel edge points, and what perspective does to a circle's centre."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.image.targets.edges import PictureSpline, profiles
from core.image.targets.picture import Picture
from core.model.arrays import Array
from core.model.robust import mad_sd


@dataclass(frozen=True, eq=False, slots=True)
class Ellipse:
    """`centre` (2,) in pixels, `sigma` of each of its coordinates; `shape` (2, 2) maps the unit circle onto it."""

    centre: Array
    shape: Array
    sigma: float


def fit_dark_ellipse(picture: Picture, centre: Array, radius: float) -> Ellipse | None:
    """The outline of a dark disc near `centre` (2,) of about `radius` pixels; None if less than 60 % of it is seen."""
    ellipse = Ellipse(np.asarray(centre, dtype=np.float64), np.eye(2) * radius, 0.0)
    reach = max(3.0, 0.45 * radius)
    spline = PictureSpline(picture, ellipse.centre[None], 1.6 * radius + 2 * reach + 4)
    for half_width in (reach, min(reach, 5.0), min(reach, 5.0)):
        fitted = _fit_once(spline, ellipse, half_width)
        if fitted is None or np.linalg.norm(fitted.centre - centre) > radius:
            return None
        ellipse = fitted
    return ellipse


def _fit_once(spline: PictureSpline, about: Ellipse, half_width: float) -> Ellipse | None:
    """Edge points across the outline of `about`, and the ellipse through most of them."""
    count = int(np.clip(2 * np.pi * np.sqrt(abs(np.linalg.det(about.shape))), 32, 256))
    angle = np.arange(count) * 2 * np.pi / count
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    outward = circle @ np.linalg.inv(about.shape)
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    uv = about.centre + circle @ about.shape.T
    across = profiles(spline, uv, outward, half_width)
    points = uv + across.offset[:, None] * outward
    if not across.valid.any():
        return None
    steep = across.valid & (across.steepness > 0.4 * np.median(across.steepness[across.valid]))
    with np.errstate(invalid="ignore"):
        usual_fall = np.quantile(across.fall[across.valid], 0.3) + 0.1 * np.nanmedian(across.bright - across.dark)
        plain = steep & (across.fall < 1.5 * usual_fall)  # no stripe crosses the profile
    used = plain
    ellipse, distance = about, np.zeros(count)
    for _ in range(4):
        if used.sum() < max(8, 0.6 * count):
            return None
        fitted = _least_squares(points[used])
        if fitted is None:
            return None
        ellipse = fitted
        distance = _distances(ellipse, points)
        scale = max(mad_sd(distance[used]), 0.02)
        used = plain & (np.abs(distance) < 4 * scale)
    sigma = float(np.sqrt(np.mean(distance[used] ** 2) * 2 / used.sum()))
    return Ellipse(ellipse.centre, ellipse.shape, sigma)


def _least_squares(points: Array) -> Ellipse | None:
    """Direct ellipse fit (Halíř & Flusser 1998), in coordinates normalised for conditioning."""
    middle, scale = points.mean(axis=0), points.std()
    x, y = ((points - middle) / scale).T
    quadratic = np.column_stack([x * x, x * y, y * y])
    linear = np.column_stack([x, y, np.ones_like(x)])
    from_linear = -np.linalg.solve(linear.T @ linear, linear.T @ quadratic)
    reduced = quadratic.T @ quadratic + quadratic.T @ linear @ from_linear
    vectors = np.linalg.eig(np.array([reduced[2] / 2, -reduced[1], reduced[0] / 2]))[1].real
    elliptic = 4 * vectors[0] * vectors[2] - vectors[1] ** 2 > 0
    if not elliptic.any():
        return None
    a, b, c = vectors[:, elliptic][:, 0]
    d, e, f = from_linear @ np.array([a, b, c])
    form = np.array([[a, b / 2], [b / 2, c]])
    centre = np.linalg.solve(2 * form, [-d, -e])
    level = centre @ form @ centre - f
    values, axes = np.linalg.eigh(form / level)
    if not (values > 0).all():
        return None
    return Ellipse(middle + scale * centre, axes @ np.diag(scale / np.sqrt(values)) @ axes.T, 0.0)


def _distances(ellipse: Ellipse, points: Array) -> Array:
    """Signed distances (N,) in pixels of `points` (N, 2) from the outline, to first order."""
    local = (points - ellipse.centre) @ np.linalg.inv(ellipse.shape).T
    radius = np.linalg.norm(local, axis=1)
    gradient = np.linalg.norm(local @ np.linalg.inv(ellipse.shape), axis=1) / radius
    distances: Array = (radius - 1) / gradient
    return distances


def centre_shift(homography: Array, centres: Array, radius: float) -> Array:
    """Ellipse's centre minus image of the circle's centre, (N, 2), under `homography` (3, 3).

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
