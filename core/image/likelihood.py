"""The likeliest place of a stripe: every pixel of its cross-sections asked once, with the weight it deserves.

Steger's points say where to look. Rows of the picture (columns, where the stripe lies flat) cut the stripe once a
pixel; x is the distance of a pixel from the curve through the points (`core.image.guide`), and the model of its grey
value a Gaussian integrated over the pixel on a sloping background,

    I(x) = B + b·x + A·exp(−(x − t)²/2s²)

with A, B, b and s known from `core.image.profile`, A varying along the stripe. A step of Fisher scoring moves the curve
by t = Σ ψ·(I − model) / Σ ψ·d, with d the derivative of the model and ψ the weight of `core.image.influence`: the
maximum of a likelihood with read and shot noise and speckle in it, whatever the background's offset and slope. Both
sums are taken over a Gaussian window along the stripe, so points stay as smooth as the filter made them, but bends do
not pull them: the curve's own bend is in x. A and s change along the stripe, and a pixel is held against those at its
own foot on the curve, not where its row cuts it: where a slanting stripe fades, all rows are brighter on one side.

Where pixels cannot be used (saturated, or other light far off the model), A is estimated together with t from those
that are left, for then the two are no longer independent.

References
----------
Kay, S. M., Fundamentals of Statistical Signal Processing: Estimation Theory (1993), §7.7: scoring; §6: the best linear
unbiased estimator, to which each step comes down.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.image.cut_model import Light
from core.image.cuts import cut_residuals, cuts_of
from core.image.guide import guide
from core.image.influence import influences
from core.image.noise import NoiseModel
from core.image.pieces import arc_length
from core.image.profile import Sections
from core.image.running import median
from core.image.scores import score_cuts
from core.image.seeds import Picture
from core.image.speckle import Speckle
from core.image.window import averages
from core.model.arrays import Array

_CORE = 1.6  # stripe σ that speckle is looked for in
_PIXEL_VARIANCE = 1 / 12
_HEIGHT_CLASS = 0.1  # sections alike within this share of their height use one weight
_SAMPLE = 8  # points of sections that are the same over many
_ENOUGH = 0.3  # of a window's cuts
_NEAR = 0.2  # stripe σ: one step from there errs by less than a hundredth of its length


class Refined(NamedTuple):
    """Points (N, 5) u, v, n_u, n_v, curvature; their σ in px, and the length in px over which their errors are one.

    σ is infinite where too few pixels could be used.
    """

    run: Array
    sigma: Array
    correlation_px: float


def refine(
    picture: Picture,
    state: NDArray[np.uint8],
    curve: Array,
    weight: Array,
    clear: NDArray[np.bool_],
    sections: Sections,
    noise: NoiseModel,
    speckle: Speckle,
    filter_px: float,
) -> Refined:
    """Move the points of a `curve` (N, 5), as `core.image.guide` gives it, to the likeliest place of the stripe.

    Parameters
    ----------
    picture, state
        (H, W) grey values, and which of them are saturated or to be ignored.
    weight
        (N,) what each point counts for the curve they make.
    clear
        (N,) True where no other light reaches into the cuts; the others are not used.
    sections
        The model at each point.
    filter_px
        σ in px of the window along the stripe.
    """
    kind, weights, shares = _weights(sections, noise, speckle)
    light = Light(np.column_stack(sections), kind, weights, (noise.read_grey**2, noise.grey_per_electron))
    curve, variance, support = _likeliest(picture, state, curve, weight, clear, light, filter_px)
    # grains reach further along the stripe than the pixel: the window averages over fewer of them than of pixels
    grown = math.sqrt(1 + median(shares[kind[::_SAMPLE]]) * (speckle.grain_px / (2 * filter_px)) ** 2)
    usual = 1 / math.sqrt(2 * math.pi) / filter_px
    sigma = np.where(support * usual > _ENOUGH, np.sqrt(variance / grown), np.inf)
    return Refined(curve, sigma, 2 * math.sqrt(math.pi) * filter_px * grown)


@njit(cache=True, nogil=True, error_model="numpy")
def _likeliest(
    picture: Picture,
    state: NDArray[np.uint8],
    start: Array,
    weight: Array,
    clear: NDArray[np.bool_],
    light: Light,
    filter_px: float,
) -> tuple[Array, Array, Array]:
    """The curve (N, 5), the variance of its points and the weight of all cuts they rest on, (N,)."""
    curve, arc, last = start.copy(), arc_length(start), False
    while True:
        cuts = cuts_of(curve, arc)
        sums = score_cuts(picture, state, curve, cuts, clear, light)
        found = averages(arc, cuts[:, 0], sums, filter_px)
        near = True
        for k in range(len(curve)):
            curve[k, 0] += found[k, 0] * curve[k, 2]
            curve[k, 1] += found[k, 0] * curve[k, 3]
            near &= abs(found[k, 0]) < _NEAR * light.sections[k, 1]
        if near or last:
            break
        curve, last = guide(curve, arc, weight, filter_px), True
    for k in range(len(curve)):
        seen = 0.5 * _PIXEL_VARIANCE * curve[k, 4]  # an arc through square pixels
        curve[k, 0] += seen * curve[k, 2]
        curve[k, 1] += seen * curve[k, 3]
    return curve, found[:, 1], found[:, 2]


def residuals(
    picture: Picture,
    state: NDArray[np.uint8],
    curve: Array,
    sections: Sections,
) -> Array:
    """By how much pixels near the crest differ from the model, and the model's light there: (2, K, W) of K cuts.

    Zeros where a pixel cannot be used. The other arguments are those of `refine`.
    """
    half = max(2, int(_CORE * median(sections.width)))
    cuts = cuts_of(curve, arc_length(curve))
    return np.asarray(cut_residuals(picture, state, curve, cuts, np.column_stack(sections), half))


def _weights(sections: Sections, noise: NoiseModel, speckle: Speckle) -> tuple[NDArray[np.int64], Array, Array]:
    """Which weight suits each point (N,), the weights (K, DEGREE + 1), and the share of speckle in their variance."""
    kind, heights = _height_classes(sections.height)
    background, width = (median(figure[::_SAMPLE]) for figure in (sections.background, sections.width))
    return kind, *influences(tuple(heights.tolist()), background, width, noise, speckle)


@njit(cache=True, nogil=True, error_model="numpy")
def _height_classes(height: Array) -> tuple[NDArray[np.int64], Array]:
    """For each point which of some heights (K,) is nearest to its own."""
    level = np.empty(len(height), dtype=np.int64)
    here, from_height, to_height = 0, np.inf, -np.inf
    for k in range(len(height)):
        if not from_height <= height[k] < to_height:  # seldom: heights change slowly
            here = round(math.log(max(height[k], 1e-3)) / _HEIGHT_CLASS)
            from_height, to_height = math.exp((here - 0.5) * _HEIGHT_CLASS), math.exp((here + 0.5) * _HEIGHT_CLASS)
        level[k] = here
    lowest = level.min()
    number = np.zeros(level.max() - lowest + 1, dtype=np.int64)
    for k in range(len(level)):
        number[level[k] - lowest] = 1
    heights = np.exp((np.flatnonzero(number) + lowest) * _HEIGHT_CLASS)
    return (np.cumsum(number) - 1)[level - lowest], heights
