"""Sections of stripes on a curved surface: width and direction of the light, and its offset from the light plane.

Light has a width. On a bent surface a sheet of σ w falls on one side of its middle plane more steeply and more squarely
than on the other, and the picture of its section, still a Gaussian to the eye, lies beside the plane's own curve: on a
ball of 50 mm by 0.01 px on its shoulders and 0.1 px at its rim, the same way for all stripes. With x across the stripe
in the picture, d the distance from the light plane, s = w/|d'| the light's own σ in px, b the lens's, κ = d''/d',
g = ∂ln(n·l)/∂x how squareness changes, and c the curvature of the curve, the centroid of the light is off by

    t = s² (g − 3κ/2) + b² c/2

(to first order: exp(gx)·exp(−d²/2w²) ≈ exp(−x²/2s²)·(1 + gx − κx³/2s²), blurred). Nothing in the section itself tells
it. But where the surface and its bend are known (`core.scan.surface.bends`), so is t, but for three things that the
stripes tell: w and b by how their width changes with the slant, S² = w²/d'² + b², and where the light comes from by how
its brightness changes along the stripe, as n·l would. All of t goes with the bend: without one nothing is off.

How near this comes to the truth is measured in tests/accuracy/sphere_bound.py.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from core.image.stripes.centreline import Centreline
from core.model import Camera
from core.model.arrays import Array
from core.scan.surface.bends import Bends
from core.scan.surface.triangulate import LEAST_INVERSE_DEPTH

# The law and where it is trusted. Held by tests/scan/test_bend_correction.py and tests/accuracy/sphere_bound.py on
# balls.
LARGEST_SHIFT = 0.25
"""t/s beyond which the law, the first term of a series, is no longer trusted."""
LEAST_COSINE = 0.15
"""Of the angle of view and of incidence, 81°: light that grazes is hardly extracted."""
POINT_STEP = 5
"""Points: every so many-th is used, for neighbours along a stripe share their error."""

# The width of the light; held by the same tests.
BLUR_PRIOR_PX, PRIOR_SHARE = 1.0, 0.01
"""The lens's blur as σ in px, until widths tell it, and what that counts beside them."""
LIGHT_ROUNDS = 6
"""Rounds of trimming and weighting when widths are fitted."""
TRIMMED = 3.0
"""Widths this many times further from the law than half of them are left out."""

# The direction of the light, by brightness; held by the same tests.
UNEVENNESS = 0.15
"""Standard deviation of the logarithm of brightness for other reasons than the angle of incidence."""
LARGEST_MISFIT = 9.0
"""Square of its deviation in these, 3²: a larger one counts as this."""
USUAL_ANGLE = 0.7
"""rad, standard deviation: the light comes from about so near to the surface's normal, if brightness does not tell."""
ANGLES = np.linspace(-1.3, 1.3, 53)
"""rad; directions of the light that are tried, 3° apart, up to grazing."""


@dataclass(frozen=True, eq=False, slots=True)
class Stripe:
    """One centreline of `frame` (−1: the fan) on its light plane, N points on a surface with known bends.

    `normal` and `tilt` = K·X' (N, 3) in space, with X' = ∂X/∂x in mm/px; `slope` = d' in mm/px, `bend` = κ and `arc` =
    c in 1/px (N,); `plane` (3,) the light plane's unit normal; `known` (N,) where all that is.
    """

    sheet: int
    frame: int
    piece: int
    line: Centreline
    plane: Array
    normal: Array
    tilt: Array
    slope: Array
    bend: Array
    arc: Array
    known: NDArray[np.bool_]

    @classmethod
    def of(
        cls, sheet: int, frame: int, piece: int, line: Centreline, pi: Array, camera: Camera, bends: Bends
    ) -> Stripe:
        """Place a centreline on its light plane `pi` (3,) and read the bends of the surface along it."""
        rays = camera.rays(line.uv)
        inverse = rays @ pi
        points = rays / np.where(inverse > LEAST_INVERSE_DEPTH, inverse, np.inf)[:, None]
        normal, curvature = bends.at(points)
        facing = (normal * rays).sum(axis=1)
        known = (inverse > LEAST_INVERSE_DEPTH) & (facing < -LEAST_COSINE)
        facing = np.where(known, facing, -1.0)
        plane = pi / np.linalg.norm(pi)
        jacobian = camera.ray_jacobian(rays)

        def steps(direction: Array) -> tuple[Array, Array, Array]:
            """K·X' (N, 3), d' and the bend's part of d'' (N,) on the way along `direction` (N, 2) in the picture."""
            ray = np.column_stack([np.einsum("nij,nj->ni", jacobian, direction), np.zeros(len(rays))])
            depth = -points[:, 2] * (normal * ray).sum(axis=1) / facing
            step = depth[:, None] * rays + points[:, 2:] * ray
            tilt = np.einsum("nij,nj->ni", curvature, step)
            return tilt, step @ plane, -(step * tilt).sum(axis=1) / facing * (rays @ plane)

        tilt, slope, second = steps(line.normal)
        _, _, sideways = steps(line.tangent)
        known &= np.abs(slope) > 1e-6
        safe = np.where(known, slope, 1.0)
        return cls(sheet, frame, piece, line, plane, normal, tilt, safe, second / safe, -sideways / safe, known)

    @property
    def bent(self) -> NDArray[np.bool_]:
        """Mask (N,) of the points where the surface bends significantly."""
        return self.known & self.tilt.any(axis=1)

    def offsets(self, light_mm: float, blur_px: float, toward: Array) -> Array:
        """Compute how far (N,) in px along its normal the centreline lies off the curve of the light plane itself.

        `light_mm` is σ of the sheet of light, `blur_px` of the lens's blur, `toward` (3,) the direction towards the
        light.
        """
        own = np.minimum(light_mm / np.abs(self.slope), self.line.width)  # no light is wider than its blurred section
        squarely = np.maximum(self.normal @ toward, LEAST_COSINE)
        off = own**2 * (self.tilt @ toward / squarely - 1.5 * self.bend) + 0.5 * blur_px**2 * self.arc
        return np.where(self.known, np.clip(off, -LARGEST_SHIFT * own, LARGEST_SHIFT * own), 0.0)

    def brightness(self, light_mm: float, blur_px: float) -> Array:
        """Compute the logarithm (N,) of the light on the surface from the stripe's height, lens's blur taken out."""
        own = np.maximum((light_mm / self.slope) ** 2, 1e-6)
        return np.asarray(np.log(np.maximum(self.line.strength, 1e-3)) + 0.5 * np.log1p(blur_px**2 / own))


def estimate_light(stripes: Sequence[Stripe]) -> tuple[float, float, float]:
    """Estimate σ in mm of the fan's sheets and of the sweeps', and σ in px of the lens's blur, from widths of stripes.

    By S² = w²/d'² + b².
    """
    rows, squares = [np.zeros((0, 3))], [np.zeros(0)]
    for stripe in stripes:
        keep = np.flatnonzero(stripe.known & ~stripe.line.saturated)[::POINT_STEP]
        of_fan = float(stripe.frame < 0)
        gain = 1 / stripe.slope[keep] ** 2
        rows.append(np.column_stack([of_fan * gain, (1 - of_fan) * gain, np.ones(len(keep))]))
        squares.append(stripe.line.width[keep] ** 2)
    design, square = np.concatenate(rows), np.concatenate(squares)
    if not len(square):
        return 0.0, 0.0, 0.0
    solved = np.array([*(_median_ratio((square - BLUR_PRIOR_PX**2), design[:, k]) for k in range(2)), BLUR_PRIOR_PX**2])
    for _ in range(LIGHT_ROUNDS):
        model = np.maximum(design @ solved, 1e-3)
        off = np.abs(square / model - 1)
        keep = off < max(TRIMMED * float(np.median(off)), 1e-3)
        prior = np.sqrt(PRIOR_SHARE * np.count_nonzero(keep)) * np.eye(3)[2:]
        whole = np.concatenate([design[keep] / model[keep, None], prior])
        aim = np.append(square[keep] / model[keep], prior[0, 2] * BLUR_PRIOR_PX**2)
        solved = nnls(whole, aim)[0]
    fan_light, sweep_light, blur = np.sqrt(solved).tolist()
    return fan_light, sweep_light, blur


def _median_ratio(square: Array, gain: Array) -> float:
    """Median of `square` over `gain` where there is any."""
    some = gain > 0
    return max(float(np.median(square[some] / gain[some])), 0.0) if some.any() else 0.0


def toward_light(stripes: Sequence[Stripe], light_mm: float, blur_px: float) -> Array:
    """Find the direction (3,) towards the light in one sheet's plane by the brightness along each of its stripes."""
    parts = [(stripe, np.flatnonzero(stripe.known)[::POINT_STEP]) for stripe in stripes]
    parts = [(stripe, at) for stripe, at in parts if len(at)]
    if not parts:
        return np.zeros(3)
    plane = parts[0][0].plane
    faces = np.concatenate([stripe.normal[at] for stripe, at in parts])
    facing = faces.mean(axis=0)
    facing -= (facing @ plane) * plane
    facing /= max(float(np.linalg.norm(facing)), 1e-9)
    sideways = np.cross(plane, facing)
    directions = np.cos(ANGLES)[:, None] * facing + np.sin(ANGLES)[:, None] * sideways
    cost = (ANGLES / USUAL_ANGLE) ** 2
    for stripe, at in parts:
        squarely = np.log(np.maximum(stripe.normal[at] @ directions.T, 0.05))
        off = stripe.brightness(light_mm, blur_px)[at][:, None] - squarely
        off = (off - np.median(off, axis=0)) / UNEVENNESS
        each = POINT_STEP / max(stripe.line.correlation_px, POINT_STEP)
        cost += each * np.minimum(off**2, LARGEST_MISFIT).sum(axis=0)
    return np.asarray(directions[np.argmin(cost)])
