"""From exact stripes to what the extraction would find of them: centrelines with its noise and its stated σ.

No formula stands for the extraction here. Short straight stripes of several brightnesses, with the planned width,
speckle and sensor, are rendered and read by `core.image.stripes.extraction` itself. What it states of its points (σ,
correlation along the stripe) and how far they really are off is all that the plan knows of it, so a better extraction
makes better plans by itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.ndimage import gaussian_filter1d

from core.image.stripes.centreline import Centreline
from core.image.stripes.extraction import extract_centrelines
from core.image.stripes.noise import ROUNDING_VARIANCE, NoiseModel
from core.image.stripes.stripe import WIDTH_IN_SIGMA, StripeSettings, filter_for
from core.messages import Message
from core.model.arrays import Array
from core.simulate.rig import Beam, Optics, Rig
from core.simulate.scene.image import Sensor, generator
from core.simulate.scene.speckle import Speckle
from core.wings.rig_planning.prediction.design import Design, PlanError
from core.wings.rig_planning.prediction.light_lines import LitLine

_WHITE_GREY = 255.0  # largest grey level of 8 bits
_TAILS = (0.02, 0.98)  # quantiles of the brightness along all stripes between which trials are made
LENGTH_PX, TURNS = 1200, (0.03, -0.045)
"""Length of a trial stripe, and its slopes against the pixel rows: all phases occur."""
HEIGHTS = 5
"""Brightnesses tried, from the faintest to the brightest planned."""
LONG_PX = 100
"""Means over stretches of this length show the correlation along the stripe."""
SEED = 20_230_013
"""Of the trials: any number, always the same."""


@dataclass(frozen=True, eq=False, slots=True)
class Light:
    """Light of one kind of stripe of a plan.

    `width_px` is its Gaussian σ in the picture, `background_grey` what lies under it, `single` whether it is read from
    one picture (the scan's reference) instead of from the difference of two.
    """

    width_px: float
    background_grey: float
    single: bool


@dataclass(frozen=True, eq=False, slots=True)
class StripeQuality:
    """Quality of points of one kind of stripe, by brightness.

    Parameters
    ----------
    heights
        (K,) brightnesses tried in grey levels, ascending.
    stated, actual
        (K,) median σ that the extraction states, and RMS error of its points, in pixels across the stripe.
    correlation_px
        Length along the stripe over which the stated noise counts as one.
    actual_correlation_px
        The same of the errors.
    flicker_sd, flicker_px
        Relative scatter of the brightness along the stripe, and its correlation length in pixels.
    filter_px
        σ of the extraction's filter.
    """

    heights: Array
    stated: Array
    actual: Array
    correlation_px: float
    actual_correlation_px: float
    flicker_sd: float
    flicker_px: float
    filter_px: float

    def sigma(self, height: Array) -> Array:
        """Compute the stated σ (N,) in pixels of centreline points for a stripe's `height` (N,) in grey levels."""
        return _power_law(height, self.heights, self.stated)

    def errors(self, height: Array, rng: np.random.Generator) -> Array:
        """Draw correlated errors (N,) in pixels of neighbouring centreline points, for `height` (N,) in grey levels."""
        unit = _correlated(len(height), self.actual_correlation_px, rng)
        return np.asarray(unit * _power_law(height, self.heights, self.actual))

    def flicker(self, count: int, rng: np.random.Generator) -> Array:
        """Draw correlated relative deviations (count,) of the brightness at neighbouring centreline points."""
        return self.flicker_sd * _correlated(count, self.flicker_px, rng)


def try_stripes(light: Light, heights: tuple[float, float], optics: Optics, scale: float) -> StripeQuality:
    """Measure how well stripes of a `light` are extracted, by rendering some between two `heights` in grey levels.

    Raises
    ------
    ValueError
        If even the brightest of them is not found.
    """
    figures = (optics.speckle_contrast, optics.electrons_per_grey, optics.read_noise_grey)
    low, high = max(heights[0], 1.0), max(heights[1], 1.2)
    return _tried(round(light.width_px, 2), round(light.background_grey), light.single, (low, high), figures, scale)


@dataclass(frozen=True, eq=False, slots=True)
class SeenStripes:
    """Kind of stripe of a plan, before and after its trial (`tried`).

    `filter_px` is the σ of the filter that suits the stripe; `single` whether it is read from one picture alone.
    """

    optics: Optics
    scale: float
    single: bool
    filter_px: float
    background_grey: float = 0.0
    quality: StripeQuality | None = None

    @classmethod
    def of_plates(cls, design: Design) -> SeenStripes:
        """Make the kind of stripe that the fan draws on calibration plates, read from two pictures' difference."""
        return cls._planned(design.rig(), design.rig().fan_beam, design, single=False)

    @classmethod
    def of_fan(cls, design: Design) -> SeenStripes:
        """Make the kind of stripe that the fan draws in a scan's reference picture."""
        return cls._planned(design.rig(), design.rig().fan_beam, design, single=True)

    @classmethod
    def of_hand(cls, design: Design) -> SeenStripes:
        """Make the kind of stripe that the hand-held laser draws in the frames of a scan."""
        return cls._planned(design.rig(), design.rig().sweep_beam, design, single=False)

    @classmethod
    def _planned(cls, rig: Rig, beam: Beam, design: Design, *, single: bool) -> SeenStripes:
        width = np.hypot(beam.sigma_mm * design.focal_px / design.distance_mm, rig.blur_px)
        return cls(rig.optics, rig.scale, single, filter_for(float(width)))

    def tried(self, lines: Sequence[LitLine], background_grey: float) -> SeenStripes:
        """Return this kind of stripe with its quality, found by rendering and extracting stripes like `lines`.

        Raises
        ------
        InputError
            If they would not be found at all.
        """
        if not lines:
            return self
        height = np.concatenate([line.height for line in lines])
        width = float(np.median(np.concatenate([line.width for line in lines])))
        low, high = np.quantile(height, _TAILS)
        try:
            quality = try_stripes(
                Light(width, background_grey, self.single), (float(low), float(high)), self.optics, self.scale
            )
        except ValueError as error:
            raise PlanError(
                Message(
                    "plan.too_faint",
                    "the stripes would be too faint to be found ({height:.1f} grey levels high)",
                    height=high,
                ),
                where="[plan] stripe_grey",
                todo=Message("plan.advice_brighter", "plan a brighter laser or a longer exposure"),
            ) from error
        return replace(self, filter_px=quality.filter_px, background_grey=background_grey, quality=quality)

    def centreline(self, line: LitLine, rng: np.random.Generator) -> Centreline:
        """Simulate the centreline that the extraction finds for a stripe, with random errors."""
        assert self.quality is not None, "the stripes have not been tried"
        error = self.quality.errors(line.height, rng)
        strength = line.height * np.maximum(1 + self.quality.flicker(len(line), rng), 0.05)
        ceiling = _WHITE_GREY - self.background_grey - self.optics.black_level_grey
        return Centreline(
            line.uv + error[:, None] * line.normal,
            line.normal,
            line.width,
            strength,
            self.quality.sigma(line.height),
            strength > ceiling,
            self.quality.correlation_px,
        )


@lru_cache(maxsize=256)
def _tried(
    width: float,
    background: float,
    single: bool,
    heights: tuple[float, float],
    figures: tuple[float, float, float],
    scale: float,
) -> StripeQuality:
    optics = Optics(speckle_contrast=figures[0], electrons_per_grey=figures[1], read_noise_grey=figures[2])
    rng = generator(SEED, "trial")
    bench = _StripeTrial(optics, scale, Light(width, background, single), rng)
    tried = np.geomspace(*heights, HEIGHTS)
    rows, correlation = [], 1.0
    for height in tried:
        found = [bench.read(float(height), slope) for slope in TURNS]
        sigma, error, strength = (np.concatenate([part[k] for part in found]) for k in range(3))
        if len(sigma) < LENGTH_PX / 2:
            continue
        correlation = found[0].correlation_px
        error = np.clip(error, *(5 * np.median(np.abs(error)) * np.array([-1, 1])))
        sd, flicker = float(np.sqrt(np.mean(error**2))), strength / strength.mean() - 1
        rows.append((height, np.median(sigma), sd, _length(error), np.std(flicker), _length(flicker)))
    if not rows:
        raise ValueError(f"a stripe of {heights[1]:.0f} grey levels is not found")
    known = np.array(rows)
    length, flicker_sd, flicker_px = known[:, 3:].mean(axis=0)
    return StripeQuality(
        known[:, 0],
        known[:, 1],
        known[:, 2],
        correlation,
        float(length),
        float(flicker_sd),
        float(flicker_px),
        bench.filter_px(heights[1]),
    )


class _StripePoints(NamedTuple):
    """Points (N,) found on one trial stripe: stated σ in px, error in px, strength in grey levels.

    `correlation_px` is their stated correlation length.
    """

    sigma: Array
    error: Array
    strength: Array
    correlation_px: float


class _StripeTrial:
    """Renders one straight stripe after another and reads it."""

    def __init__(self, optics: Optics, scale: float, light: Light, rng: np.random.Generator) -> None:
        self._light, self._rng = light, rng
        self._sensor = Sensor(optics)
        self._black = optics.black_level_grey
        contrast = optics.speckle_contrast
        self._speckle = Speckle(contrast, optics.grain_px(scale), rng) if contrast > 0 else None
        shot = 1 / optics.electrons_per_grey
        one = NoiseModel(
            float(np.sqrt(max(optics.read_noise_grey**2 + ROUNDING_VARIANCE - shot * self._black, ROUNDING_VARIANCE))),
            shot,
        )
        self._noise = one if light.single else one.of_difference(light.background_grey + self._black)

    def filter_px(self, height: float) -> float:
        """σ of the filter that suits the stripe."""
        return self._settings(height).filter_px

    def read(self, height: float, slope: float) -> _StripePoints:
        """Render and read one stripe."""
        width = self._light.width_px
        reach = int(np.ceil(8 * width + 8))
        rows, columns = np.indices((2 * reach + int(abs(slope) * LENGTH_PX), LENGTH_PX))
        middle = rows.shape[0] / 2 + self._rng.uniform(-0.5, 0.5)
        cosine = 1 / np.hypot(1, slope)
        off = (rows - middle - slope * (columns - LENGTH_PX / 2)) * cosine
        stripe = (height * np.exp(-0.5 * (off / width) ** 2)).astype(np.float32)
        if self._speckle is not None:
            row, column = np.nonzero(stripe > 0.02)
            stripe[row, column] *= self._speckle.at(row, column, self._rng)
        under = np.full(stripe.shape, self._light.background_grey, np.float32)
        seen = self._sensor.expose(stripe + under, self._rng)
        picture = seen.astype(np.float32)
        if not self._light.single:
            picture -= self._sensor.expose(under, self._rng)
        pieces = extract_centrelines(picture, self._settings(height), noise=self._noise, saturated=seen >= _WHITE_GREY)
        if not pieces:
            return _StripePoints(np.empty(0), np.empty(0), np.empty(0), 1.0)
        uv = np.concatenate([piece.uv for piece in pieces])
        error = (uv[:, 1] - middle - slope * (uv[:, 0] - LENGTH_PX / 2)) * cosine
        sigma, strength = (np.concatenate([getattr(piece, name) for piece in pieces]) for name in ("sigma", "strength"))
        return _StripePoints(sigma, error, strength, pieces[0].correlation_px)

    def _settings(self, height: float) -> StripeSettings:
        return StripeSettings(WIDTH_IN_SIGMA * self._light.width_px, 0.8 * height)


def _length(values: Array) -> float:
    """Length along the stripe over which `values` (N,) about zero count as one: from how their means scatter."""
    usable = values[: len(values) // LONG_PX * LONG_PX]
    means = usable.reshape(-1, LONG_PX).mean(axis=1)
    return max(float(np.mean(means**2) / np.mean(values**2)) * LONG_PX, 1.0)


def _correlated(count: int, length_px: float, rng: np.random.Generator) -> Array:
    """Normal random numbers (count,) of unit variance that count as one over `length_px`."""
    spread = length_px / (2 * np.sqrt(np.pi))
    margin = 4 * int(spread + 1)
    smooth = gaussian_filter1d(rng.standard_normal(count + 2 * margin), spread)[margin : margin + count]
    return np.asarray(smooth * np.sqrt(length_px), dtype=np.float64)


def _power_law(height: Array, heights: Array, values: Array) -> Array:
    """Values at `height`, interpolated between those at `heights` on logarithmic scales."""
    logarithm = np.interp(np.log(np.maximum(height, 1e-3)), np.log(heights), np.log(values))
    return np.asarray(np.exp(logarithm), dtype=np.float64)
