"""Stripes whose section is no Gaussian: placed by the section that is measured, where it is known well."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

import core.image.stripes.positions as positions
from core.image.stripes.centreline import Centreline
from core.image.stripes.extraction import StripeSettings, extract_centrelines
from core.image.stripes.noise import Compression, NoiseModel, estimate_noise
from core.image.stripes.precision import scatter
from core.simulate.effects.laser import LaserEffects
from core.simulate.recording import scan_of
from core.simulate.scenario import Scenario
from tests.image.synthetic_stripes import Distance, expose, speckle, straight

NOISE = NoiseModel(float(np.sqrt(1 + 1 / 12)), 0.02)
CONTRAST, GRAIN_PX = 0.2, 1.4
LENGTH_PX, ENDS = 700, 20
SHAPES: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "Gaussian": lambda x: np.exp(-0.5 * (x / 2.5) ** 2),
    "flat": lambda x: np.exp(-((np.abs(x) / 3.4) ** 4)),
    "bar": lambda x: 0.5 * (np.tanh((x + 3) / 0.9) - np.tanh((x - 3) / 0.9)),
    "one-sided": lambda x: np.exp(-0.5 * (x / np.where(x > 0, 3.2, 2.0)) ** 2),
}


def picture(shape: str, contrast: float, degrees: float, seed: int) -> tuple[np.ndarray, Distance]:
    """A stripe of this section as pixels see it, and how far places lie from its d = 0."""
    angle = np.radians(degrees)
    size = int(LENGTH_PX * np.sin(angle)) + 60, int(LENGTH_PX * np.cos(angle)) + 60
    truth = straight((size[1] / 2, size[0] / 2), angle)
    v, u = np.mgrid[: size[0], : size[1]]
    within = (-1 / 3, 0.0, 1 / 3)
    light = np.mean([150 * SHAPES[shape](truth(u + du, v + dv)) for du in within for dv in within], axis=0)
    rng = np.random.default_rng(seed)
    if contrast:
        light = light * speckle(light.shape, contrast, GRAIN_PX, rng)
    return np.round(expose(light, rng)).astype(np.float32), truth


def longest(light: np.ndarray, noise: NoiseModel = NOISE) -> Centreline:
    return max(extract_centrelines(light, StripeSettings(10.0, 150.0), noise=noise), key=lambda line: len(line.uv))


@cache
def found(shape: str, contrast: float, degrees: float, measured: bool = True) -> tuple[float, float, float]:
    """Scatter, RMS of the stated σ and mean of the places of three pictures, in px; `measured`: as the product does."""
    with pytest.MonkeyPatch.context() as patch:
        if not measured:
            patch.setattr(positions, "by_measured_section", lambda *_: None)
        scatter, stated, mean = [], [], []
        for seed in (1, 2, 3):
            light, truth = picture(shape, contrast, degrees, seed)
            line = longest(light)
            errors = truth(*line.uv.T)[ENDS:-ENDS]
            scatter.append(errors.std())
            stated.append(np.sqrt(np.mean(line.sigma[ENDS:-ENDS] ** 2)))
            mean.append(errors.mean())
    return float(np.mean(scatter)), float(np.mean(stated)), float(np.mean(mean))


@pytest.mark.parametrize("degrees", [88.0, pytest.param(50.0, marks=pytest.mark.accuracy)])
@pytest.mark.parametrize(("shape", "share"), [("flat", 0.5), ("bar", 0.68)])
def test_speckled_stripes_of_another_section_scatter_less_and_say_how_much(shape, share, degrees):
    before, after = found(shape, CONTRAST, degrees, measured=False), found(shape, CONTRAST, degrees)
    assert after[0] < share * before[0]
    assert 0.7 < after[1] / after[0] < 1.3


@pytest.mark.parametrize("shape", ["flat", "bar"])
@pytest.mark.parametrize("degrees", [88.0, pytest.param(50.0, marks=pytest.mark.accuracy)])
def test_the_middle_of_a_line_stays_where_it_was_whatever_the_speckle(shape, degrees):
    """A calibration may have less speckle than a scan: what is called the middle must not depend on it."""
    still = found(shape, 0.0, degrees, measured=False)[2]
    assert found(shape, 0.0, degrees)[2] == pytest.approx(still, abs=0.003)
    assert found(shape, CONTRAST, degrees)[2] == pytest.approx(still, abs=0.03)


@pytest.mark.parametrize("contrast", [0.0, CONTRAST])
def test_one_sided_stripes_stay_where_they_were(contrast):
    assert found("one-sided", contrast, 50.0) == found("one-sided", contrast, 50.0, measured=False)


@pytest.mark.parametrize("contrast", [0.0, CONTRAST])
def test_a_gaussian_stripe_is_placed_to_the_bit_as_by_a_gaussian(contrast, monkeypatch):
    light, _ = picture("Gaussian", contrast, 50.0, 4)
    mine = longest(light)
    monkeypatch.setattr(positions, "by_measured_section", lambda *_: None)
    np.testing.assert_array_equal(mine.uv, longest(light).uv)


def test_what_a_section_promises_is_not_believed_where_points_scatter_more(monkeypatch):
    """Lines of σ 1.1 px, flat before a lens blurs them, each as wide as its distance makes it."""
    stage, _, _ = scan_of(Scenario(scale=0.25, frames=0, laser=LaserEffects(edge=6.0)))
    light = stage.reference().astype(np.float32)

    def extracted() -> list[np.ndarray]:
        lines = extract_centrelines(light, StripeSettings(4.3, 25.0), noise=estimate_noise(light))
        return [np.column_stack([line.uv, line.normal]) for line in lines]

    mine = scatter(extracted(), 6.0)
    monkeypatch.setattr(positions, "by_measured_section", lambda *_: None)
    assert mine < 1.01 * scatter(extracted(), 6.0)


def test_in_compressed_pictures_no_section_is_measured(monkeypatch):
    """Each block keeps another part of it."""
    light, _ = picture("flat", CONTRAST, 50.0, 4)
    compressed = NoiseModel(NOISE.read_grey, NOISE.grey_per_electron, Compression(2.0))
    mine = longest(light, compressed)
    monkeypatch.setattr(positions, "by_measured_section", lambda *_: None)
    np.testing.assert_array_equal(mine.uv, longest(light, compressed).uv)


def test_a_picture_without_stripes_has_no_section():
    assert extract_centrelines(np.zeros((60, 80), np.float32), StripeSettings(10.0, 150.0), noise=NOISE) == ()
