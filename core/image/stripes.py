"""Stripe extraction: the sub-pixel centrelines of all stripes of light in one picture.

Steger's detector, with what measuring needs on top of it: points at any sub-pixel place (no phase bias), pieces that
end at kinks, jumps and depth edges, curvature and background corrections, and an honest standard uncertainty.

=================================  ==========================================================================
what pulls a point                 what is done about it
=================================  ==========================================================================
pixel phase                        the point is looked at again from its own place (`core.image.ridge`)
curvature, radius R                (g² + 1/12)/(2R) towards the centre is taken off
background slope b                 b·(s² + g²)^1.5/(A·s) is taken off where b is significant
end of a stripe, kink, jump        4 px (1.2 g) and 2 g are left out; a piece never crosses them
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
from core.image.stripe_settings import StripeSettings, choose_settings
from core.model.arrays import Array

__all__ = ["StripeSettings", "choose_settings", "correlation_length_px", "extract_centrelines"]

_HIGH, _LOW = 0.35, 0.12  # of the contrast: a run starts, a run goes on
_HIGH_NOISE, _LOW_NOISE = 6.0, 3.0  # of the response's own noise, at least
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
    runs = link(picture, state, settings.stripe_px, settings.filter_px, _limits(settings, noise, saturated is not None))
    correlation = correlation_length_px(settings)
    shortest = _SHORTEST_PIECE * settings.filter_px
    pieces = [
        (piece, profiles)
        for run in runs
        for piece, profiles in _smooth_pieces(picture, state, run, settings, noise, shortest)
    ]
    filtered_width = float(np.hypot(settings.stripe_px, settings.filter_px))
    crowded = beside_another([piece for piece, _ in pieces], filtered_width)
    lines = []
    for (piece, profiles), flags in zip(pieces, crowded, strict=True):
        points = _corrected(piece, profiles, settings)
        sigma = noise_sigma(profiles, noise, settings.filter_px)
        lines.append((points, profiles, sigma, ~flags))
    excess = roughness([(points, sigma) for points, _, sigma, _ in lines], correlation)
    found = [
        Centreline(
            points[:, :2],
            points[:, 2:4],
            profiles.width,
            profiles.height,
            np.sqrt(sigma**2 + extra**2),
            saturated_points(state, points, settings.filter_px)
            if saturated is not None
            else np.zeros(len(points), bool),
            correlation,
        ).select(keep)
        for (points, profiles, sigma, keep), extra in zip(lines, excess, strict=True)
        if np.count_nonzero(keep) >= shortest
    ]
    return tuple(sorted(found, key=len, reverse=True))


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
    picture: NDArray[np.float32],
    state: NDArray[np.uint8],
    run: Array,
    settings: StripeSettings,
    noise: NoiseModel,
    shortest: float,
) -> list[tuple[Array, Profiles]]:
    """One run cut at its ends, kinks and jumps, with the cross-sections of each piece."""
    g = settings.filter_px
    run = cut_ends(run, g)
    if len(run) < shortest:
        return []
    profiles = measure_profiles(picture, state, run, arc_length(run), settings.stripe_px, g)
    sigma = noise_sigma(profiles, noise, g)
    (extra,) = roughness([(run, sigma)], correlation_length_px(settings))
    pieces = []
    for piece in split_at_breaks(run, g, np.hypot(sigma, extra)):
        arc = arc_length(piece)
        if len(piece) < len(run):  # the running median must not reach across the break
            profiles = measure_profiles(picture, state, piece, arc, settings.stripe_px, g)
        lit = fully_lit(arc, profiles.height, profiles.width, g)
        if len(piece[lit]) >= shortest:
            pieces.append((piece[lit], profiles.select(lit)))
    return pieces


def _corrected(run: Array, profiles: Profiles, settings: StripeSettings) -> Array:
    """The run (N, ≥ 4) freed of the curvature's and the background's pull."""
    g = settings.filter_px
    bend = curvature(run, arc_length(run), 6 * g)
    shift = bend * (g**2 + 1 / 12) / 2
    slope = np.where(np.abs(profiles.slope) > 3 * profiles.slope_sigma, profiles.slope, 0.0)
    visible = profiles.height > 0
    height = np.where(visible, profiles.height, 1.0)
    tilt = slope * (profiles.width**2 + g**2) ** 1.5 / (height * profiles.width)
    shift += np.where(visible, np.clip(tilt, -0.5, 0.5), 0.0)
    corrected = run.copy()
    corrected[:, :2] -= shift[:, None] * run[:, 2:4]
    return corrected
