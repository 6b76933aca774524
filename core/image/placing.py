"""Where the stripes of a picture lie: by the likelihood if it and Steger agree, by Steger if not."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.image.guide import guide
from core.image.likelihood import Refined, refine, residuals
from core.image.noise import NoiseModel
from core.image.pieces import arc_length, correlation_length
from core.image.precision import FLOOR_PX, noise_sigma
from core.image.profile import Profiles, Sections, smooth_sections
from core.image.seeds import Picture
from core.image.speckle import Speckle, measure_speckle
from core.image.stripe import StripeSettings
from core.model.arrays import Array

_CUTS_FOR_SPECKLE = 3000  # more tell nothing new
_LARGEST_PULL_PX = 0.03  # of Steger's points against the likelihood's


@dataclass(frozen=True, eq=False, slots=True)
class Piece:
    """Line points (N, ≥ 4) on one smooth surface, their cross-sections, and which are saturated (N,)."""

    run: Array
    profiles: Profiles
    saturated: NDArray[np.bool_]

    @property
    def weight(self) -> Array:
        """What each point counts for the smooth curve through them, (N,)."""
        return self.usable.astype(np.float64)

    @property
    def usable(self) -> NDArray[np.bool_]:
        """Points to judge the line by: those not saturated, or all where most of them are."""
        mostly = 2 * np.count_nonzero(self.saturated) >= len(self.saturated)
        return np.ones_like(self.saturated) if mostly else ~self.saturated

    def judged(self, run: Array, sigma: Array) -> tuple[Array, Array]:
        """Those of the points `run`, and of their standard uncertainties, that are usable."""
        return run[self.usable], sigma[self.usable]


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
    curves = [guide(piece.run, arc_length(piece.run), piece.weight, g) for piece in pieces]
    sections = [smooth_sections(piece.profiles, g) for piece in pieces]
    lines = [_stegers(piece, curve, settings, noise) for piece, curve in zip(pieces, curves, strict=True)]
    speckle = _speckle(picture, state, curves, sections, settings)
    refined = [
        refine(picture, state, curve, piece.weight, ok, section, noise, speckle, g)
        for piece, curve, ok, section in zip(pieces, curves, clear, sections, strict=True)
    ]
    differences = [_difference(*three) for three in zip(pieces, lines, refined, strict=True)]
    if _apart_px(differences, correlation_length(g)) > _LARGEST_PULL_PX:
        return lines
    return [_joined(line, better) for line, better in zip(lines, refined, strict=True)]


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


def _difference(piece: Piece, line: Refined, better: Refined) -> Array:
    """How far across the stripe the usable points of two lines are apart, in px."""
    both = piece.usable & np.isfinite(better.sigma)
    across: Array = np.sum((better.run[both, :2] - line.run[both, :2]) * better.run[both, 2:4], axis=1)
    return across


def _apart_px(differences: list[Array], correlation: float) -> float:
    """How far two kinds of lines usually are apart on the whole, beyond what their points' scatter explains."""
    found = [(len(d), float(np.mean(d)) ** 2 - float(np.var(d)) * correlation / len(d)) for d in differences if len(d)]
    number = sum(n for n, _ in found)
    return max(0.0, sum(n * square for n, square in found) / number) ** 0.5 if number else 0.0


def _joined(line: Refined, better: Refined) -> Refined:
    """The better line, and the other one where that has no points."""
    there = np.isfinite(better.sigma)
    return Refined(
        np.where(there[:, None], better.run, line.run),
        np.where(there, np.hypot(better.sigma, FLOOR_PX), line.sigma),
        better.correlation_px,
    )


def _stegers(piece: Piece, curve: Array, settings: StripeSettings, noise: NoiseModel) -> Refined:
    """Steger's points freed of the curvature's and the background's pull."""
    g, profiles = settings.filter_px, piece.profiles
    run = curve.copy()
    shift = run[:, 4] * (g**2 + 1 / 12) / 2
    slope = np.where(np.abs(profiles.slope) > 3 * profiles.slope_sigma, profiles.slope, 0.0)
    visible = profiles.height > 0
    height = np.where(visible, profiles.height, 1.0)
    tilt = slope * (profiles.width**2 + g**2) ** 1.5 / (height * profiles.width)
    shift += np.where(visible, np.clip(tilt, -0.5, 0.5), 0.0)
    run[:, :2] = piece.run[:, :2] - shift[:, None] * run[:, 2:4]
    return Refined(run, noise_sigma(profiles, noise, g), correlation_length(g))
