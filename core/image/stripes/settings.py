"""Choice of the stripes' width and contrast from a picture."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.image.stripes.noise import estimate_noise
from core.image.stripes.precision import response_noise
from core.image.stripes.profile import measure_profiles
from core.image.stripes.runs import BORDER_PX, arc_length, cut_ends
from core.image.stripes.stripe import CONTRAST_QUANTILE, WIDTH_IN_SIGMA, StripeSettings, filter_for
from core.image.stripes.tracing.linking import HOLD, Hysteresis, link
from core.image.stripes.tracing.pixel_state import SATURATED
from core.image.stripes.tracing.ridge import kernel_radius
from core.image.stripes.tracing.seeds import coarse_crests
from core.model.arrays import Array

_BLOCKS = (1, 2, 3, 4, 6, 9, 13)
"""Stripe σ tried at first, in px; the rounds that follow correct a factor of two between them."""

_REDUCED = (4, 8, 16)
"""Factors of the reduced pictures: grains up to so many px are averaged."""
_MORE_LIGHT, _SHORT, _MOSTLY = 4.0, 0.3, 0.8  # times the light of grains; their length over it, and share within it
_NO_GRAIN = 40.0  # times its width: a run so long is none; the longest runs along grains have been 12
_SMALLEST_REDUCED = 24  # px that a reduced picture must have each way

# Held by tests/image/stripes/test_extraction.py (settings are chosen) on rendered stripes of σ 0.9 to 5 px, of several
# heights and noises.
_ROUNDS = 4  # corrections of the width at most; mostly two
_SETTLED = 0.05  # change of the width, as a share of it, below which it is taken
_LONG = 12.0  # filter σ: shorter runs are no stripe,
_ACROSS = 0.9  # unless they go over so much of the picture's shorter side: nothing is longer there
_STRONG_QUANTILE = 0.9  # of the heights along all stripes: what the next round's thresholds refer to
_FAINTEST = 0.008  # of full scale: 2 grey levels of 8 bits
_ABOVE_NOISE = 8.0  # times the noise of the response
_SHARE_OF_STRONGEST = 0.12  # a run starts from this share of the strong stripes' height,
_LOW_SHARE = 0.4  # and goes on down to this share of that


def choose_settings(picture: NDArray[np.float32], full_scale: float) -> StripeSettings | None:
    """Choose width and contrast of the stripes from a picture (H, W); None if it shows no stripe.

    Parameters
    ----------
    picture
        (H, W) float32, a picture or a difference of two pictures.
    full_scale
        Largest grey value the pictures can hold (255, 65535); values from there on count as saturated.

    Notes
    -----
    The first guess of the width is the block size at which the strongest crests answer best: with the response
    divided by the square root of the block size (Lindeberg's normalisation of ridges, γ = 3/4), that is where block
    and stripe σ agree. Then stripes are traced, their cross-sections fitted, and the width corrected until it stays.
    A wide speckled stripe falls apart into its grains. So the same is done in pictures reduced until grains are
    averaged. What is found there counts where nothing was found before, or only grains of it: a small part of its
    light.

    References
    ----------
    Lindeberg, T., Edge detection and ridge detection with automatic scale selection, IJCV 30 (1998),
    doi:10.1023/A:1008097225773.
    """
    found = _chosen(picture, full_scale, 1)
    if found is not None and found.longest > _NO_GRAIN * found.settings.width_px:
        return found.settings
    for factor in _REDUCED:
        size = (picture.shape[1] // factor, picture.shape[0] // factor)
        if min(size) < _SMALLEST_REDUCED:
            break
        small = np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), dtype=np.float32)
        wider = _chosen(small, full_scale, factor)
        if wider is not None and (found is None or wider.is_made_of(found, picture.shape)):
            found = wider
    return None if found is None else found.settings


@dataclass(frozen=True, eq=False, slots=True)
class _Stripes:
    """The long stripes at one size of the picture, in px of the whole one.

    `uv` (N, 2) are points along them, `longest` and `length` are that of one and of all, and `light` is the sum of
    height times width along them.
    """

    settings: StripeSettings
    uv: Array
    longest: float
    length: float
    light: float

    def is_made_of(self, finer: _Stripes, shape: tuple[int, ...]) -> bool:
        """Whether what was found in a finer picture are grains of these: short, little of their light, within them.

        Grains nearer to the border of the picture (`shape`) than these can be seen say nothing.
        """
        if self.light < _MORE_LIGHT * finer.light or _SHORT * self.length < finer.longest:
            return False
        radius = kernel_radius(self.settings.filter_px)
        to_border = np.minimum(finer.uv, np.array(shape[::-1]) - 1 - finer.uv).min(axis=1)
        seen = finer.uv[to_border > radius]
        if not len(seen):
            return True
        distance = cKDTree(self.uv).query(seen)[0]
        return float(np.mean(distance < self.settings.width_px)) > _MOSTLY


def _chosen(picture: NDArray[np.float32], full_scale: float, factor: int) -> _Stripes | None:
    """Choose settings in a picture reduced by a factor; None when it shows no stripe there."""
    state = np.where(picture >= full_scale, np.uint8(SATURATED), np.uint8(0))
    noise = estimate_noise(picture).read_grey
    stripe_px, height = _first_guess(picture, noise)
    for _ in range(_ROUNDS):
        filter_px = filter_for(stripe_px)
        faintest = max(_ABOVE_NOISE * response_noise(noise, stripe_px, filter_px), _FAINTEST * full_scale, noise)
        if height < faintest:
            return None
        faintest = max(faintest, _SHARE_OF_STRONGEST * height)
        sections, lengths = _sections(
            picture,
            state,
            stripe_px,
            filter_px,
            Hysteresis(faintest, _LOW_SHARE * faintest, HOLD * filter_px, 0.0, noise),
        )
        if not sections.size or sum(lengths) < min(2 * _LONG * filter_px, _ACROSS * min(picture.shape)):
            return None
        width = float(np.median(sections[1]))
        settled = abs(width / stripe_px - 1) < _SETTLED
        stripe_px, height = width, float(np.quantile(sections[0], _STRONG_QUANTILE))
        if settled:
            break
    contrast = float(np.quantile(sections[0], CONTRAST_QUANTILE))
    return _Stripes(
        StripeSettings(factor * WIDTH_IN_SIGMA * stripe_px, contrast),
        factor * sections[2:].T,
        factor * max(lengths),
        factor * sum(lengths),
        factor**2
        * sum(lengths)
        * float(np.median(sections[0] * sections[1])),  # a failed fit may be as high as it likes
    )


def _first_guess(picture: NDArray[np.float32], noise: float) -> tuple[float, float]:
    """σ in pixels and height of the strongest stripes, from the crests at several block sizes."""
    best, guess = 0.0, (1.0, 0.0)
    for block in _BLOCKS:
        if min(picture.shape) < 8 * block:
            break
        found = coarse_crests(picture, block, _ABOVE_NOISE * noise / block / 2)[:, 2]
        if not found.size:
            continue
        number = max(4, sum(picture.shape) // (4 * block))
        response = float(np.median(np.sort(found)[-number:]))
        if response / math.sqrt(block) > best:
            best = response / math.sqrt(block)
            guess = (float(block), response * 2.83)  # a stripe of σ 1 under a filter of σ 1: A/2^1.5
    return guess


def _sections(
    picture: NDArray[np.float32], state: NDArray[np.uint8], stripe_px: float, filter_px: float, limits: Hysteresis
) -> tuple[Array, list[float]]:
    """Heights, widths, u and v (4, N) along all long stripes within the `limits`, and how long each of these is.

    To that belongs what the filter cannot see where a stripe leaves the picture.
    """
    sections, lengths = [np.empty((4, 0))], list[float]()
    radius = kernel_radius(filter_px)
    least = min(_LONG * filter_px, _ACROSS * min(picture.shape))
    for traced in link(picture, state, stripe_px, filter_px, limits):
        if len(traced) + 2 * radius < least:  # too short even if it leaves the picture at both ends, as most of noise
            continue
        inside = np.minimum(traced[[0, -1], :2], np.array(picture.shape[::-1]) - 1 - traced[[0, -1], :2]).min(axis=1)
        unseen = radius * int(np.count_nonzero(inside <= radius + BORDER_PX))
        if len(traced) + unseen < least:
            continue
        run = cut_ends(traced, filter_px, picture.shape)
        if len(run) > 1:
            profiles = measure_profiles(picture, state, run, stripe_px, filter_px)
            seen = profiles.height > 0
            sections.append(np.vstack([profiles.height[seen], profiles.width[seen], run[seen, :2].T]))
            lengths.append(float(arc_length(run)[-1]) + unseen)
    return np.hstack(sections), lengths
