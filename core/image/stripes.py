"""Stripe extraction: the sub-pixel centrelines of all stripes of light in one picture.

Steger's detector, with what measuring needs on top of it: points at any sub-pixel place (no phase bias), pieces that
end at kinks, jumps and depth edges, curvature and background corrections, and an honest standard uncertainty.

=================================  ==========================================================================
what pulls a point                 what is done about it
=================================  ==========================================================================
pixel phase                        the point is looked at again from its own place (`core.image.ridge`)
curvature, radius R                (g² + 1/12)/(2R) towards the centre is taken off
background slope b                 b·(s² + g²)^1.5/(A·s) is taken off where b is significant
end of a stripe, kink, jump        4 px (2.5 g) and 2 g are left out; a piece never crosses them
neighbour, crossing line           points nearer than 3.5·√(s² + g²) are left out
border of the picture              points nearer than 4 g are never found
saturation                         flagged; stay in place
=================================  ==========================================================================

Here s is the stripe's σ, g the filter's, A the stripe's height. The noise of neighbouring points is correlated over
2√π·g px (`correlation_length_px`): a mean over L px of stripe has σ·√(2√π·g/L), not σ/√L.

References
----------
Steger, C., An unbiased detector of curvilinear structures, IEEE PAMI 20 (1998), doi:10.1109/34.659930.
Sun et al., Sensors 2023, 23, 13, §4, doi:10.3390/s23010013.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.image.centreline import Centreline
from core.image.linking import IGNORED, SATURATED, Hysteresis, link
from core.image.noise import NoiseModel
from core.image.pieces import (
    arc_length,
    beside_another,
    correlation_length,
    curvature,
    cut_ends,
    fully_lit,
    split_at_breaks,
)
from core.image.precision import noise_sigma, response_noise, roughness, saturated_points
from core.image.profile import Profiles, measure_profiles
from core.image.stripe import StripeSettings
from core.image.stripe_settings import choose_settings
from core.model.arrays import Array

__all__ = ["StripeSettings", "choose_settings", "correlation_length_px", "extract_centrelines"]

_HIGH, _LOW = 0.35, 0.12  # of the contrast: a run starts, a run goes on
_HIGH_NOISE, _LOW_NOISE = 6.0, 3.0  # of the response's own noise, at least
_CURVATURE_ARM = 6.0  # filter σ on either side
_SHORTEST_PIECE = 7.0  # filter σ: two independent points


def correlation_length_px(settings: StripeSettings) -> float:
    """Length along the stripe over which the noise of neighbouring points counts as one, in pixels: 2√π·g."""
    return correlation_length(settings.filter_px)


def extract_centrelines(
    picture: NDArray[np.float32],
    settings: StripeSettings,
    *,
    noise: NoiseModel,
    saturated: NDArray[np.bool_] | None = None,
    ignore: NDArray[np.bool_] | None = None,
) -> tuple[Centreline, ...]:
    """The centrelines of all bright stripes in a picture, longest first; empty when there is none.

    Parameters
    ----------
    picture
        (H, W) float32; a picture or a difference of two, so values may be negative.
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
        If the picture is not a 2-D float32 array or a mask has another shape.
    """
    state = _state_map(picture, saturated, ignore)
    correlation = correlation_length_px(settings)
    runs = link(picture, state, settings.stripe_px, settings.filter_px, _limits(settings, noise, saturated is not None))
    shortest = _SHORTEST_PIECE * settings.filter_px
    pieces = [
        piece
        for run in runs
        for piece in _smooth_pieces(picture, state, run, settings, noise)
        if len(piece.run) >= shortest
    ]
    crowded = beside_another([piece.run for piece in pieces], float(np.hypot(settings.stripe_px, settings.filter_px)))
    pieces = [_corrected(piece, settings) for piece in pieces]
    sigmas = [noise_sigma(piece.profiles, noise, settings.filter_px) for piece in pieces]
    excess = roughness([piece.judged(s) for piece, s in zip(pieces, sigmas, strict=True)], correlation)
    found = [
        Centreline(
            piece.run[:, :2],
            piece.run[:, 2:4],
            piece.profiles.width,
            piece.profiles.height,
            np.hypot(sigma, extra),
            piece.saturated,
            correlation,
        ).select(~near)
        for piece, sigma, extra, near in zip(pieces, sigmas, excess, crowded, strict=True)
        if np.count_nonzero(~near) >= shortest
    ]
    return tuple(sorted(found, key=len, reverse=True))


@dataclass(frozen=True, eq=False, slots=True)
class _Piece:
    """Line points (N, ≥ 4) on one smooth surface, their cross-sections, and which are saturated (N,)."""

    run: Array
    profiles: Profiles
    saturated: NDArray[np.bool_]

    @property
    def usable(self) -> NDArray[np.bool_]:
        """Points to judge the line by: those not saturated, or all where most of them are."""
        return ~self.saturated if np.mean(self.saturated) < 0.5 else np.ones_like(self.saturated)

    def judged(self, sigma: Array) -> tuple[Array, Array]:
        """Usable points and their standard uncertainty."""
        return self.run[self.usable], sigma[self.usable]


def _state_map(
    picture: NDArray[np.float32], saturated: NDArray[np.bool_] | None, ignore: NDArray[np.bool_] | None
) -> NDArray[np.uint8]:
    if picture.ndim != 2 or picture.dtype != np.float32:
        raise ValueError(f"picture must be 2-D float32, not {picture.ndim}-D {picture.dtype}")
    state = np.zeros(picture.shape, dtype=np.uint8)
    for mask, bit in ((saturated, SATURATED), (ignore, IGNORED)):
        if mask is not None:
            if mask.shape != picture.shape:
                raise ValueError(f"a mask of shape {mask.shape} does not suit a picture of shape {picture.shape}")
            state[mask] |= bit
    return state


def _limits(settings: StripeSettings, noise: NoiseModel, knows_saturation: bool) -> Hysteresis:
    scatter = response_noise(noise.read_grey, settings.stripe_px, settings.filter_px)
    return Hysteresis(
        high=max(_HIGH * settings.contrast, _HIGH_NOISE * scatter),
        low=max(_LOW * settings.contrast, _LOW_NOISE * scatter),
        hold_px=3 * settings.filter_px,
        saturated_hold_px=4 * settings.width_px if knows_saturation else 0.0,
    )


def _smooth_pieces(
    picture: NDArray[np.float32], state: NDArray[np.uint8], run: Array, settings: StripeSettings, noise: NoiseModel
) -> list[_Piece]:
    """One run cut at its ends, kinks and jumps, with the cross-sections of each piece."""
    g = settings.filter_px
    run = cut_ends(run, g)
    if len(run) < _SHORTEST_PIECE * g:
        return []
    saturated = saturated_points(state, run, g)
    whole = _Piece(run, measure_profiles(picture, state, run, settings.stripe_px, g), saturated)
    sigma = noise_sigma(whole.profiles, noise, g)
    (extra,) = roughness([whole.judged(sigma)], correlation_length_px(settings))
    pieces = []
    for part in split_at_breaks(run, whole.usable, g, np.hypot(sigma, extra)):
        piece, profiles = run[part], whole.profiles
        if len(piece) < len(run):  # the running median must not reach across the break
            profiles = measure_profiles(picture, state, piece, settings.stripe_px, g)
        lit = fully_lit(arc_length(piece), profiles.height, profiles.width, g)
        pieces.append(_Piece(piece[lit], profiles.select(lit), saturated[part][lit]))
    return pieces


def _corrected(piece: _Piece, settings: StripeSettings) -> _Piece:
    """The piece freed of the curvature's and the background's pull."""
    g, run, profiles = settings.filter_px, piece.run, piece.profiles
    arc, usable = arc_length(run), piece.usable
    bend = np.interp(arc, arc[usable], curvature(run[usable], arc[usable], _CURVATURE_ARM * g))
    shift = bend * (g**2 + 1 / 12) / 2
    slope = np.where(np.abs(profiles.slope) > 3 * profiles.slope_sigma, profiles.slope, 0.0)
    visible = profiles.height > 0
    height = np.where(visible, profiles.height, 1.0)
    tilt = slope * (profiles.width**2 + g**2) ** 1.5 / (height * profiles.width)
    shift += np.where(visible, np.clip(tilt, -0.5, 0.5), 0.0)
    corrected = run.copy()
    corrected[:, :2] -= shift[:, None] * run[:, 2:4]
    return _Piece(corrected, profiles, piece.saturated)
