"""Final positions of stripe points: by the likelihood where it and Steger agree, by Steger where not."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc

from core.compiled import compiled
from core.image.stripes.curve import smooth_curve
from core.image.stripes.likelihood.refinement import Refined, StripeModel, residuals
from core.image.stripes.measured_positions import StripePicture, by_measured_section
from core.image.stripes.noise import NoiseModel
from core.image.stripes.precision import FLOOR_PX, added_in_squares, noise_sigma, roughness, scatter
from core.image.stripes.profile import Profiles, Sections, smooth_sections
from core.image.stripes.runs import arc_length, correlation_length
from core.image.stripes.speckle import Speckle, measure_speckle
from core.image.stripes.stripe import PIXEL_VARIANCE, StripeSettings
from core.image.stripes.tracing.seeds import Picture
from core.model.arrays import Array, set_field
from core.model.small_arrays import first_rows, new_flags

_CUTS_FOR_SPECKLE = 3000  # cuts; more tell nothing new of the speckle
_LARGEST_DISAGREEMENT_PX = 0.03
"""Between Steger's points and the likelihood's, on the whole: beyond, the section is no Gaussian (a halo of 8 % shows
at once) and all points stay Steger's. Held by tests/image/stripes/likelihood/test_refinement.py (no Gaussian)."""
_CHANCE, _MOST_BY_CHANCE_PX = 1e-5, 0.1
"""Probability above which that is chance, and how far chance goes. On pictures of one speckled stripe of 350 px one in
four was taken for skewed without it, by some hundredths of a pixel, and its points were twice as far off as they could
be; with 1e-3 some still were. On photographs, 0.14 to 0.6 px, one of the two estimates is wrong, however few the points
that say so."""
_WORTH = 0.97
"""Of the scatter that points show, at most so much with the measured section: else the Gaussian's stay. What a section
promises is not enough: of lines of σ 1.1 px, flat before a lens blurs them and each as wide as its distance makes it,
points scattered by 0.13 px instead of 0.07, where 0.05 was foretold."""
_UNUSABLE_WEIGHT = 0.02
"""Of saturated points in the smooth curve, 1 for the others: enough to hold it where all are saturated. Set by rendered
plates, where a curve without them swung up to 4 px astray; tests/image/test_rendered_lines.py holds it."""
_LARGEST_MOVE = 1.0
"""Stripe σ between a point of Steger's and the likeliest one: beyond, that is on something else, and Steger's stays."""
_LARGEST_BEND_PULL = 0.5
"""Filter σ of the correction for a bend: beyond, the bend is tighter than the filter, and is none of a stripe."""
_SIGNIFICANT_SLOPE = 3.0  # standard uncertainties: smaller slopes of the background are not corrected for
_LARGEST_SLOPE_PULL_PX = 0.5  # of such a correction: more is no pull on a line but another line


@dataclass(frozen=True, eq=False, slots=True)
class Piece:
    """Run of line points (N, ≥ 4) on one smooth surface, their cross-sections, and which are saturated (N,).

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
        """Weight (N,) of each point in fitting the smooth curve through the piece."""
        return np.where(self.usable, 1.0, _UNUSABLE_WEIGHT)

    def judged(self, run: Array, sigma: Array) -> tuple[Array, Array]:
        """Select the points `run` (N, ≥ 2) and standard uncertainties `sigma` (N,) at the points that are `usable`."""
        return (run, sigma) if self.usable.all() else (run[self.usable], sigma[self.usable])


def estimate_positions(
    picture: Picture,
    state: NDArray[np.uint8],
    pieces: list[Piece],
    clear: list[NDArray[np.bool_]],
    settings: StripeSettings,
    noise: NoiseModel,
) -> list[Refined]:
    """Estimate the final positions of the points of all pieces of a `picture` (H, W), the likeliest ones.

    Steger's positions, corrected for their biases, stay beside other light, and everywhere if the two disagree on the
    whole. Both are right for a Gaussian; a skewed section pulls both, and the flanks that a likelihood with speckle
    listens to pull more.
    """
    g = settings.filter_px
    weights = [piece.weight for piece in pieces]
    curves: list[Array] = [
        smooth_curve(piece.run, arc_length(piece.run), weight, g) for piece, weight in zip(pieces, weights, strict=True)
    ]
    sections = [smooth_sections(piece.profiles, g) for piece in pieces]
    lines = [_steger_line(piece, curve, settings, noise) for piece, curve in zip(pieces, curves, strict=True)]
    speckle = _speckle(picture, state, curves, sections, settings)
    stripes = [StripeModel(*four) for four in zip(curves, weights, clear, sections, strict=True)]
    lit = StripePicture(picture, state, stripes, noise, speckle, g)
    refined = lit.refined(stripes)
    if _apart_px(pieces, lines, refined, g) > _LARGEST_DISAGREEMENT_PX:
        return lines
    measured = by_measured_section(lit, refined)
    if (
        measured is not None
        and _scatter_px(pieces, measured, g) < _WORTH * _scatter_px(pieces, refined, g)
        and _apart_px(pieces, lines, measured, g) <= _LARGEST_DISAGREEMENT_PX
    ):
        refined = measured
    return [_joined(*three) for three in zip(pieces, lines, refined, strict=True)]


def _apart_px(pieces: list[Piece], lines: list[Refined], refined: list[Refined], filter_px: float) -> float:
    """How far two estimates of all pieces are apart on the whole, in px; 0 where that is chance."""
    differences = [
        _difference(line.run, other.run, other.sigma, piece.usable)
        for piece, line, other in zip(pieces, lines, refined, strict=True)
    ]
    return _disagreement_px(differences, correlation_length(filter_px))


def _scatter_px(pieces: list[Piece], lines: list[Refined], filter_px: float) -> float:
    """How much the usable points of all pieces scatter along them, in px."""
    runs = [piece.judged(line.run, line.sigma)[0] for piece, line in zip(pieces, lines, strict=True)]
    return scatter(runs, correlation_length(filter_px))


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


@compiled()
def _difference(run: Array, better: Array, sigma: Array, usable: NDArray[np.bool_]) -> tuple[int, float, float]:
    """Number of the usable points of two lines, and mean and variance of how far across they are apart, in px."""
    number, total, square = 0, 0.0, 0.0
    for k in range(len(run)):
        if usable[k] and sigma[k] < math.inf:
            across = (better[k, 0] - run[k, 0]) * better[k, 2] + (better[k, 1] - run[k, 1]) * better[k, 3]
            number, total, square = number + 1, total + across, square + across * across
    mean = total / max(number, 1)
    return number, mean, max(square / max(number, 1) - mean * mean, 0.0)


def _disagreement_px(differences: list[tuple[int, float, float]], correlation: float) -> float:
    """RMS in px of the mean distances between two estimates of each line, beyond what their scatter explains.

    0 where chance alone does: on a short speckled stripe the two are a few hundredths of a pixel apart.
    """
    found = [(n, mean**2, variance * correlation / n) for n, mean, variance in differences if n]
    if not found:
        return 0.0
    number = sum(n for n, _, _ in found)
    apart = float(max(0.0, sum(n * (square - error) for n, square, error in found) / number) ** 0.5)
    in_errors = sum(square / max(error, 1e-12) for _, square, error in found)
    by_chance = apart < _MOST_BY_CHANCE_PX and chdtrc(len(found), in_errors) > _CHANCE
    return 0.0 if by_chance else apart


def _joined(piece: Piece, line: Refined, better: Refined) -> Refined:
    """The better line, and the other one, as rough as it is, where that has no points."""
    there = np.isfinite(better.sigma) & _is_near(line.run, better.run, piece.profiles.width)
    sigma = added_in_squares(better.sigma, FLOOR_PX)
    if there.all():
        return Refined(better.run, sigma, better.correlation_px)
    (extra,) = roughness([piece.judged(line.run, line.sigma)], line.correlation_px)
    run = np.where(there[:, None], better.run, line.run)
    return Refined(run, np.where(there, sigma, added_in_squares(line.sigma, extra)), better.correlation_px)


@compiled()
def _is_near(run: Array, better: Array, width: Array) -> NDArray[np.bool_]:
    """Whether points (N, ≥ 2) of two lines are the same place of a stripe of σ `width` (N,)."""
    near = new_flags(len(run))
    for k in range(len(run)):
        near[k] = math.hypot(better[k, 0] - run[k, 0], better[k, 1] - run[k, 1]) <= _LARGEST_MOVE * width[k]
    return near


def _steger_line(piece: Piece, curve: Array, settings: StripeSettings, noise: NoiseModel) -> Refined:
    """Steger's points freed of the curvature's and the background's pull."""
    g, profiles = settings.filter_px, piece.profiles
    light = (profiles.height, profiles.width, profiles.slope, profiles.slope_sigma)
    return Refined(_bias_corrected(piece.run, curve, light, g), noise_sigma(profiles, noise, g), correlation_length(g))


@compiled()
def _bias_corrected(points: Array, curve: Array, light: tuple[Array, Array, Array, Array], filter_px: float) -> Array:
    """`points` (N, ≥ 2) less the pulls of the `curve` (N, 5) and of the background's slope where it is significant."""
    height, width, slope, slope_sigma = light
    run, square = first_rows(curve, len(curve)), filter_px * filter_px
    for k in range(len(run)):
        shift = run[k, 4] * (square + PIXEL_VARIANCE) / 2
        shift = min(max(shift, -_LARGEST_BEND_PULL * filter_px), _LARGEST_BEND_PULL * filter_px)
        if height[k] > 0 and abs(slope[k]) > _SIGNIFICANT_SLOPE * slope_sigma[k]:
            both = width[k] * width[k] + square
            tilt = slope[k] * both * math.sqrt(both) / (height[k] * width[k])
            shift += min(max(tilt, -_LARGEST_SLOPE_PULL_PX), _LARGEST_SLOPE_PULL_PX)
        run[k, 0] = points[k, 0] - shift * run[k, 2]
        run[k, 1] = points[k, 1] - shift * run[k, 3]
    return run
