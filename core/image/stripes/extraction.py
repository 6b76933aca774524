"""Stripe extraction: the sub-pixel centrelines of all stripes of light in one picture.

Steger's detector finds them; the likelihood of every pixel of their cross-sections then says where they are. With that
goes what measuring needs: points at any sub-pixel place, pieces that end at kinks, jumps and depth edges, and an honest
standard uncertainty.

=================================  ==========================================================================
what biases a point                what is done about it
=================================  ==========================================================================
noise, speckle                     pixels are weighted by both (`core.image.stripes.likelihood.influence`), the
                                   speckle measured on the stripe itself (`core.image.stripes.speckle`): 1.04 of
                                   the Cramér–Rao bound
pixel phase                        the model is compared with each pixel where it is: below 0.001 px
curvature, radius R                distances are measured from the stripe's own curve (`core.image.stripes.curve`):
                                   below 0.003 px on the whole for R ≥ 17 s, at each point for R > 40 s
background slope                   the weights do not see a slope: below 0.001 px for 0.1 grey/px
end of a stripe, kink, jump        4 px (2.5 g) and 2 g are left out, but nothing where a stripe goes on beyond the
                                   picture's border; a piece never crosses them
neighbour, crossing line           points nearer than 3.5·√(s² + g²) are left out, nearer than 8.1 s they stay
                                   Steger's, freed of the pull of curvature and background; behind a crossing a line
                                   goes on as one (`core.image.stripes.lines.joining`)
border of the picture              points nearer than 4 g are never found; cuts that leave the picture are not used
skewed section, halo               0.1 to 0.2 px for flanks that differ by 10 %, whatever the estimator, and twice
                                   that with the weights that speckle asks for; so where they disagree by more than
                                   0.03 px on the whole all points of the picture stay Steger's, as below
compression                        JPEG takes the noise away and bends lines block by block: σ is at least what its
                                   own table says (`core.image.stripes.precision`)
saturation                         height and place from the pixels left: below 0.003 px; flagged
=================================  ==========================================================================

Here s is the stripe's σ, g the filter's. Neighbouring points share their noise over a little more than 2√π·g px
(`Centreline.correlation_px`): a mean over L px of stripe has σ·√(correlation/L), not σ/√L.

References
----------
Steger, C., An unbiased detector of curvilinear structures, IEEE PAMI 20 (1998), doi:10.1109/34.659930.
Sun et al., Sensors 2023, 23, 13, §4, doi:10.3390/s23010013.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.image.stripes.centreline import Centreline
from core.image.stripes.likelihood.influence import REACH
from core.image.stripes.likelihood.refinement import Refined
from core.image.stripes.lines.holes import unbroken_parts
from core.image.stripes.lines.joining import joined_at_crossings
from core.image.stripes.lines.neighbours import NEIGHBOUR_DISTANCE, distances_to_neighbours
from core.image.stripes.lines.splitting import split_at_breaks
from core.image.stripes.noise import NoiseModel
from core.image.stripes.positions import Piece, estimate_positions
from core.image.stripes.precision import (
    added_in_squares,
    compression_sigma,
    noise_sigma,
    response_noise,
    roughness,
    saturated_points,
)
from core.image.stripes.profile import fit_profiles, profiles_along
from core.image.stripes.runs import arc_length, correlation_length, cut_ends, fully_lit
from core.image.stripes.settings import choose_settings
from core.image.stripes.stripe import StripeSettings
from core.image.stripes.tracing.linking import HOLD, Hysteresis, link
from core.image.stripes.tracing.pixel_state import IGNORED
from core.image.stripes.tracing.seeds import Picture
from core.model.arrays import Array

__all__ = ["StripeSettings", "choose_settings", "correlation_length_px", "extract_centrelines"]

# Hysteresis. Holding on through dark grains saves the 6 to 15 % of points that a plain threshold loses at a speckle
# contrast ≥ 0.5; the levels were chosen on speckled stripes: tests/image/stripes/test_extraction.py holds them.
_HIGH, _LOW = 0.35, 0.12  # of the contrast: a run starts, a run goes on
_HIGH_NOISE, _LOW_NOISE = 6.0, 3.0  # of the response's own noise, at least
_SATURATED_HOLD = 4.0  # visible widths that it goes on through saturated pixels

_NEIGHBOUR_TAIL = 3.6  # stripe σ that a neighbour's light reaches: 0.15 % of its height is left there
_SHORTEST_PIECE = 7.0  # filter σ: two independent points, at 2√π filter σ each


def correlation_length_px(settings: StripeSettings) -> float:
    """Compute the length in px along a stripe over which the noise of neighbouring points counts as one error.

    It is 2√π·g, with g the σ of the filter.
    """
    return correlation_length(settings.filter_px)


def extract_centrelines(
    picture: Picture,
    settings: StripeSettings,
    *,
    noise: NoiseModel,
    saturated: NDArray[np.bool_] | None = None,
    ignore: NDArray[np.bool_] | None = None,
) -> tuple[Centreline, ...]:
    """Extract the centrelines of all bright stripes in a picture, longest first; none gives an empty tuple.

    Parameters
    ----------
    picture
        (H, W) float32 or int16; a picture or a difference of two, so values may be negative.
    settings
        Width and contrast of the stripes.
    noise
        Scatter of this picture's pixels.
    saturated
        (H, W) True where the picture (or either one of a difference) is saturated; points nearby are flagged.
    ignore
        (H, W) True where nothing must be looked at; no line comes near.

    Raises
    ------
    ValueError
        If the picture is not a 2-D float32 or int16 array or a mask has another shape.
    """
    state = _state_map(picture, saturated, ignore)
    runs = link(picture, state, settings.stripe_px, settings.filter_px, _limits(settings, noise, saturated is not None))
    shortest = _SHORTEST_PIECE * settings.filter_px
    pieces = [
        piece
        for run in runs
        for piece in _smooth_pieces(picture, state, run, settings, noise)
        if len(piece.run) >= shortest
    ]
    pieces, bridges = joined_at_crossings(pieces, settings.filter_px)
    pulled = NEIGHBOUR_DISTANCE * float(np.hypot(settings.stripe_px, settings.filter_px))
    blended = (REACH + _NEIGHBOUR_TAIL) * settings.stripe_px
    apart = distances_to_neighbours(
        [piece.run for piece in pieces], bridges, 2 * settings.filter_px, max(pulled, blended)
    )
    clear = [near > blended for near in apart]
    placed = estimate_positions(picture, state, pieces, clear, settings, noise)
    correlation = max([line.correlation_px for line in placed], default=correlation_length_px(settings))
    excess = roughness([p.judged(line.run, line.sigma) for p, line in zip(pieces, placed, strict=True)], correlation)
    enough = [k for k, near in enumerate(apart) if np.count_nonzero(near > pulled) >= shortest]
    runs, keep = [placed[k].run for k in enough], [apart[k] > pulled for k in enough]
    found = [
        _centreline(pieces[k], placed[k], excess[k], part, noise)
        for own, k in enumerate(enough)
        for part in unbroken_parts(runs, keep, own, settings.filter_px, state)
        if isinstance(part, slice) or len(part) >= shortest
    ]
    return tuple(sorted(found, key=len, reverse=True))


def _state_map(
    picture: Picture, saturated: NDArray[np.bool_] | None, ignore: NDArray[np.bool_] | None
) -> NDArray[np.uint8]:
    if picture.ndim != 2 or picture.dtype not in (np.float32, np.int16):
        raise ValueError(f"picture must be 2-D float32 or int16, not {picture.ndim}-D {picture.dtype}")
    for mask in (saturated, ignore):
        if mask is not None and mask.shape != picture.shape:
            raise ValueError(f"a mask of shape {mask.shape} does not suit a picture of shape {picture.shape}")
    if saturated is None:
        state = np.zeros(picture.shape, np.uint8)
    else:  # not copied: True is SATURATED
        state = np.ascontiguousarray(saturated, dtype=np.bool_).view(np.uint8)
    return state if ignore is None else np.where(ignore, state | np.uint8(IGNORED), state)


def _limits(settings: StripeSettings, noise: NoiseModel, knows_saturation: bool) -> Hysteresis:
    scatter = response_noise(noise.read_grey, settings.stripe_px, settings.filter_px)
    return Hysteresis(
        high=max(_HIGH * settings.contrast, _HIGH_NOISE * scatter),
        low=max(_LOW * settings.contrast, _LOW_NOISE * scatter),
        hold_px=HOLD * settings.filter_px,
        saturated_hold_px=_SATURATED_HOLD * settings.width_px if knows_saturation else 0.0,
        noise_grey=noise.read_grey,
    )


def _smooth_pieces(
    picture: Picture, state: NDArray[np.uint8], run: Array, settings: StripeSettings, noise: NoiseModel
) -> list[Piece]:
    """One run cut at its ends, kinks and jumps, with the cross-sections of each piece."""
    g = settings.filter_px
    run = cut_ends(run, g, picture.shape)
    if len(run) < _SHORTEST_PIECE * g:
        return []
    saturated, arc = saturated_points(state, run, g), arc_length(run)
    fits = fit_profiles(picture, state, run, settings.stripe_px, g)
    whole = Piece(run, profiles_along(arc, slice(0, len(run)), fits, settings.stripe_px, g), saturated)
    sigma = noise_sigma(whole.profiles, noise, g)
    (extra,) = roughness([whole.judged(run, sigma)], correlation_length_px(settings))
    pieces = []
    for part in split_at_breaks(run, arc, whole.usable, g, added_in_squares(sigma, extra)):
        profiles = whole.profiles
        if part.stop - part.start < len(run):  # the running median must not reach across the break
            profiles = profiles_along(arc, part, fits, settings.stripe_px, g)
        first, last = fully_lit(arc[part] - arc[part.start], profiles.height, profiles.width, g)
        lit = slice(part.start + first, part.start + last)
        pieces.append(Piece(run[lit], profiles.select(slice(first, last)), saturated[lit]))
    return pieces


def _centreline(
    piece: Piece, line: Refined, extra: float, part: NDArray[np.intp] | slice, noise: NoiseModel
) -> Centreline:
    """A `part` of the points of a placed piece; `extra` is their scatter in px beyond the law."""
    height, sigma = piece.profiles.height[part], added_in_squares(line.sigma[part], extra)
    correlation = line.correlation_px
    if noise.compression.grey > 0:
        sigma = np.maximum(sigma, compression_sigma(height, noise))
        correlation = max(correlation, noise.compression.block_px)  # points within a block share what it does
    return Centreline(
        line.run[part, :2],
        line.run[part, 2:4],
        piece.profiles.width[part],
        height,
        sigma,
        piece.saturated[part],
        correlation,
        piece.profiles.skewness[part],
    )
