"""Where the stripes of a picture lie: by the likelihood if it and Steger agree, by Steger if not."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.image.guide import guide
from core.image.likelihood import Refined, refine, residuals
from core.image.noise import NoiseModel
from core.image.pieces import arc_length, correlation_length
from core.image.precision import FLOOR_PX, in_squares, noise_sigma, roughness
from core.image.profile import Profiles, Sections, smooth_sections
from core.image.seeds import Picture
from core.image.speckle import Speckle, measure_speckle
from core.image.stripe import StripeSettings
from core.model.arrays import Array, set_field

_CUTS_FOR_SPECKLE = 3000  # more tell nothing new
_LARGEST_PULL_PX = 0.03  # of Steger's points against the likelihood's
_UNUSABLE_WEIGHT = 0.02


@dataclass(frozen=True, eq=False, slots=True)
class Piece:
    """Line points (N, ≥ 4) on one smooth surface, their cross-sections, and which are saturated (N,).

    `usable` (N,) are the points to judge the line by: those not saturated, or all where most of them are.
    """

    run: Array
    profiles: Profiles
    saturated: NDArray[np.bool_]
    usable: NDArray[np.bool_] = field(init=False)

    def __post_init__(self) -> None:
        mostly = 2 * np.count_nonzero(self.saturated) >= len(self.saturated)
        set_field(self, "usable", np.ones_like(self.saturated) if mostly else ~self.saturated)

    @property
    def weight(self) -> Array:
        """What each point counts for the smooth curve through them, (N,).

        Those that are not usable count for little: without any, a curve through the few left swings past the light.
        """
        return np.where(self.usable, 1.0, _UNUSABLE_WEIGHT)

    def judged(self, run: Array, sigma: Array) -> tuple[Array, Array]:
        """Those of the points `run`, and of their standard uncertainties, that are usable."""
        return (run, sigma) if self.usable.all() else (run[self.usable], sigma[self.usable])


def place(
    picture: Picture,
    state: NDArray[np.uint8],
    pieces: list[Piece],
    clear: list[NDArray[np.bool_]],
    settings: StripeSettings,
    noise: NoiseModel,
) -> list[Refined]:
    """The points of all pieces at their likeliest place.

    Steger's, freed of their biases, stay where the likelihood has no say: beside other light, and everywhere if it
    looks for the stripes elsewhere than Steger. Both are right for a Gaussian; a skewed section pulls both, and the
    flanks that a likelihood with speckle listens to pull more.
    """
    g = settings.filter_px
    weights = [piece.weight for piece in pieces]
    curves: list[Array] = [
        guide(piece.run, arc_length(piece.run), weight, g) for piece, weight in zip(pieces, weights, strict=True)
    ]
    sections = [smooth_sections(piece.profiles, g) for piece in pieces]
    lines = [_stegers(piece, curve, settings, noise) for piece, curve in zip(pieces, curves, strict=True)]
    speckle = _speckle(picture, state, curves, sections, settings)
    refined = [
        refine(picture, state, curve, weight, ok, section, noise, speckle, g)
        for weight, curve, ok, section in zip(weights, curves, clear, sections, strict=True)
    ]
    differences = [
        _difference(line.run, better.run, better.sigma, piece.usable)
        for piece, line, better in zip(pieces, lines, refined, strict=True)
    ]
    if _apart_px(differences, correlation_length(g)) > _LARGEST_PULL_PX:
        return lines
    return [_joined(*three) for three in zip(pieces, lines, refined, strict=True)]


def _speckle(
    picture: Picture,
    state: NDArray[np.uint8],
    curves: list[Array],
    sections: list[Sections],
    settings: StripeSettings,
) -> Speckle:
    """The speckle that all stripes of the picture show, from the longest of them."""
    cuts, left = [], _CUTS_FOR_SPECKLE
    for k in sorted(range(len(curves)), key=lambda k: -len(curves[k])):
        if left > 0:
            cuts.append(residuals(picture, state, curves[k][:left], Sections(*(s[:left] for s in sections[k]))))
            left -= len(curves[k])
    return measure_speckle(cuts, settings.stripe_px)


@njit(cache=True, nogil=True, error_model="numpy")
def _difference(run: Array, better: Array, sigma: Array, usable: NDArray[np.bool_]) -> tuple[int, float, float]:
    """Number of the usable points of two lines, and mean and variance of how far across they are apart, in px."""
    number, total, square = 0, 0.0, 0.0
    for k in range(len(run)):
        if usable[k] and sigma[k] < math.inf:
            across = (better[k, 0] - run[k, 0]) * better[k, 2] + (better[k, 1] - run[k, 1]) * better[k, 3]
            number, total, square = number + 1, total + across, square + across * across
    mean = total / max(number, 1)
    return number, mean, max(square / max(number, 1) - mean * mean, 0.0)


def _apart_px(differences: list[tuple[int, float, float]], correlation: float) -> float:
    """How far two kinds of lines usually are apart on the whole, beyond what their points' scatter explains."""
    found = [(n, mean**2 - variance * correlation / n) for n, mean, variance in differences if n]
    number = sum(n for n, _ in found)
    return max(0.0, sum(n * square for n, square in found) / number) ** 0.5 if number else 0.0


def _joined(piece: Piece, line: Refined, better: Refined) -> Refined:
    """The better line, and the other one, as rough as it is, where that has no points."""
    there = np.isfinite(better.sigma)
    sigma = in_squares(better.sigma, FLOOR_PX)
    if there.all():
        return Refined(better.run, sigma, better.correlation_px)
    (extra,) = roughness([piece.judged(line.run, line.sigma)], line.correlation_px)
    run = np.where(there[:, None], better.run, line.run)
    return Refined(run, np.where(there, sigma, in_squares(line.sigma, extra)), better.correlation_px)


def _stegers(piece: Piece, curve: Array, settings: StripeSettings, noise: NoiseModel) -> Refined:
    """Steger's points freed of the curvature's and the background's pull."""
    g, profiles = settings.filter_px, piece.profiles
    light = (profiles.height, profiles.width, profiles.slope, profiles.slope_sigma)
    return Refined(_freed(piece.run, curve, light, g), noise_sigma(profiles, noise, g), correlation_length(g))


@njit(cache=True, nogil=True, error_model="numpy")
def _freed(points: Array, curve: Array, light: tuple[Array, Array, Array, Array], filter_px: float) -> Array:
    """`points` (N, ≥ 2) less the pulls of the `curve` (N, 5) and of the background's slope where it is significant."""
    height, width, slope, slope_sigma = light
    run, square = curve.copy(), filter_px * filter_px
    for k in range(len(run)):
        shift = run[k, 4] * (square + 1 / 12) / 2
        if height[k] > 0 and abs(slope[k]) > 3 * slope_sigma[k]:
            both = width[k] * width[k] + square
            tilt = slope[k] * both * math.sqrt(both) / (height[k] * width[k])
            shift += min(max(tilt, -0.5), 0.5)
        run[k, 0] = points[k, 0] - shift * run[k, 2]
        run[k, 1] = points[k, 1] - shift * run[k, 3]
    return run
