"""Choice of the stripes' width and contrast from a picture."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from core.image.stripes.noise import estimate_noise
from core.image.stripes.precision import response_noise
from core.image.stripes.profile import measure_profiles
from core.image.stripes.runs import cut_ends
from core.image.stripes.stripe import CONTRAST_QUANTILE, WIDTH_IN_SIGMA, StripeSettings, filter_for
from core.image.stripes.tracing.linking import HOLD, Hysteresis, link
from core.image.stripes.tracing.pixel_state import IGNORED, SATURATED
from core.image.stripes.tracing.seeds import coarse_crests
from core.model.arrays import Array

_BLOCKS = (1, 2, 3, 4, 6, 9, 13)
"""Stripe σ tried at first, in px; the rounds that follow correct a factor of two between them."""

_REDUCED = (4, 8, 16)
"""Factors of the reduced pictures: grains up to so many px are averaged."""
_SMALLEST_REDUCED = 24  # px that a reduced picture must have each way

# Held by tests/image/stripes/test_extraction.py (settings are chosen) on rendered stripes of σ 0.9 to 5 px, of several
# heights and noises.
_ROUNDS = 4  # corrections of the width at most; mostly two
_SETTLED = 0.05  # change of the width, as a share of it, below which it is taken
_LONG = 12.0  # filter σ: shorter runs are no stripe
_STRONG_QUANTILE = 0.9  # of the heights along all stripes: what the next round's thresholds refer to
_FAINTEST = 0.008  # of full scale: 2 grey levels of 8 bits
_ABOVE_NOISE = 8.0  # times the noise of the response
_SHARE_OF_STRONGEST = 0.12  # a run starts from this share of the strong stripes' height,
_LOW_SHARE = 0.4  # and goes on down to this share of that


def choose_settings(
    picture: NDArray[np.float32], full_scale: float, mask: NDArray[np.bool_] | None = None
) -> StripeSettings | None:
    """Choose width and contrast of the stripes in a picture; None when it shows no stripe.

    Parameters
    ----------
    picture
        (H, W) float32, a picture or a difference of two pictures.
    full_scale
        Largest grey value the pictures can hold (255, 65535); values from there on count as saturated.
    mask
        (H, W) True where nothing must be looked at.

    Notes
    -----
    The first guess of the width is the block size at which the strongest crests answer best: with the response
    divided by the square root of the block size (Lindeberg's normalisation of ridges, γ = 3/4), that is where block
    and stripe σ agree. Then stripes are traced, their cross-sections fitted, and the width corrected until it stays.
    A wide speckled stripe falls apart into its grains, and none is long enough. So where nothing is found, the same is
    done in pictures reduced until the grains are averaged.

    References
    ----------
    Lindeberg, T., Edge detection and ridge detection with automatic scale selection, IJCV 30 (1998),
    doi:10.1023/A:1008097225773.
    """
    found = _chosen(picture, full_scale, mask)
    for factor in _REDUCED:
        size = (picture.shape[1] // factor, picture.shape[0] // factor)
        if found is not None or min(size) < _SMALLEST_REDUCED:
            break
        small = np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), dtype=np.float32)
        covered = None if mask is None else cv2.resize(mask.astype(np.uint8), size, interpolation=cv2.INTER_AREA) > 0
        found = _chosen(small, full_scale, covered)
        if found is not None:
            found = StripeSettings(factor * found.width_px, found.contrast)
    return found


def _chosen(picture: NDArray[np.float32], full_scale: float, mask: NDArray[np.bool_] | None) -> StripeSettings | None:
    """Choose settings at one size of the picture; None when it shows no stripe there."""
    state = np.where(picture >= full_scale, np.uint8(SATURATED), np.uint8(0))
    if mask is not None:
        state[mask] |= IGNORED
        picture = np.where(mask, np.float32(np.median(picture[~mask])) if not mask.all() else 0, picture)
    noise = estimate_noise(picture, mask).read_grey
    stripe_px, height = _first_guess(picture, noise)
    for _ in range(_ROUNDS):
        filter_px = filter_for(stripe_px)
        faintest = max(_ABOVE_NOISE * response_noise(noise, stripe_px, filter_px), _FAINTEST * full_scale, noise)
        if height < faintest:
            return None
        faintest = max(faintest, _SHARE_OF_STRONGEST * height)
        sections = _sections(
            picture,
            state,
            stripe_px,
            filter_px,
            Hysteresis(faintest, _LOW_SHARE * faintest, HOLD * filter_px, 0.0, noise),
        )
        if sections.shape[1] < 2 * _LONG * filter_px:
            return None
        width = float(np.median(sections[1]))
        settled = abs(width / stripe_px - 1) < _SETTLED
        stripe_px, height = width, float(np.quantile(sections[0], _STRONG_QUANTILE))
        if settled:
            break
    return StripeSettings(WIDTH_IN_SIGMA * stripe_px, float(np.quantile(sections[0], CONTRAST_QUANTILE)))


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
) -> Array:
    """Heights and widths (2, N) along all long stripes within the `limits`."""
    sections = [np.empty((2, 0))]
    for traced in link(picture, state, stripe_px, filter_px, limits):
        if len(traced) < _LONG * filter_px:
            continue
        run = cut_ends(traced, filter_px, picture.shape)
        if len(run) > 1:
            profiles = measure_profiles(picture, state, run, stripe_px, filter_px)
            seen = profiles.height > 0
            sections.append(np.array([profiles.height[seen], profiles.width[seen]]))
    return np.hstack(sections)
