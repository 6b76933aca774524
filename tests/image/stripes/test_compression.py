"""What JPEG does to a line is in the stated uncertainty of its points."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from core.acquire.grey import to_grey
from core.files.compression import compression_of
from core.image.stripes.extraction import StripeSettings, extract_centrelines
from core.image.stripes.noise import Compression, estimate_noise
from tests.image.synthetic_stripes import draw, expose, straight

SHAPE, POINT = (200, 400), (200.0, 100.3)
ANGLES = np.deg2rad([0.0, 3.0, 25.0, 45.0, 80.0])


def errors_in_sigma(sigma_px: float, height: float, quality: int, angle: float) -> np.ndarray:
    """Errors of all points of a stripe in a JPEG over their stated uncertainty."""
    rng = np.random.default_rng(quality)
    truth = straight(POINT, angle)
    light = expose(20 + draw(SHAPE, truth, sigma_px, height, 2), rng, 0.5, 0.0)
    data = cv2.imencode(".jpg", np.clip(np.round(light), 0, 255), [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
    picture = np.asarray(cv2.imdecode(data, cv2.IMREAD_GRAYSCALE), dtype=np.float32)
    noise = replace(estimate_noise(picture), compression=compression_of(data.tobytes()))
    lines = extract_centrelines(picture, StripeSettings(4 * sigma_px, height), noise=noise)
    assert sum(map(len, lines)) > 120
    return np.concatenate([truth(*line.uv.T) / line.sigma for line in lines])


@pytest.mark.parametrize("quality", [50, 75, 95])
@pytest.mark.parametrize(("sigma_px", "height"), [(1.2, 40.0), (2.5, 150.0), (5.0, 100.0)])
def test_lines_in_jpegs_are_as_sure_as_they_say(sigma_px: float, height: float, quality: int) -> None:
    """Along a row of blocks all of a line is off alike: its scatter tells nothing of that."""
    each = [np.sqrt(np.mean(errors_in_sigma(sigma_px, height, quality, angle) ** 2)) for angle in ANGLES]
    assert max(each) < 2.0
    assert np.sqrt(np.mean(np.square(each))) < 1.3


def test_only_compression_makes_lines_less_sure() -> None:
    picture = expose(draw(SHAPE, straight(POINT, 0.1), 2.0, 100.0, 2), np.random.default_rng(1)).astype(np.float32)
    noise, settings = estimate_noise(picture), StripeSettings(8.0, 100.0)
    (plain,) = extract_centrelines(picture, settings, noise=noise)
    (compressed,) = extract_centrelines(picture, settings, noise=replace(noise, compression=Compression(10.0)))
    np.testing.assert_array_equal(compressed.uv, plain.uv)
    assert (compressed.sigma > plain.sigma).all()
    (little,) = extract_centrelines(picture, settings, noise=replace(noise, compression=Compression(1e-3)))
    np.testing.assert_array_equal(little.sigma, plain.sigma)


@pytest.mark.parametrize("quality", [50, 75, 95])
@pytest.mark.parametrize(("sigma_px", "height"), [(2.5, 150.0), (5.0, 100.0)])
def test_a_lasers_colour_in_jpegs_is_as_sure_as_it_says(sigma_px: float, height: float, quality: int) -> None:
    """Its colours have half the pixels and coarser steps, and their noise is smoothed."""
    rng, each = np.random.default_rng(quality), []
    for angle in ANGLES:
        truth = straight(POINT, angle)
        light = 60 + np.multiply.outer(draw(SHAPE, truth, sigma_px, height, 2), [0.03, 0.06, 1.0])
        light = np.clip(np.round(light + rng.normal(0, 2.0, light.shape)), 0, 255)
        data = cv2.imencode(".jpg", light, [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
        picture = to_grey(np.asarray(cv2.imdecode(data, cv2.IMREAD_UNCHANGED)), "red-green").astype(np.float32)
        noise = replace(estimate_noise(picture), compression=compression_of(data.tobytes(), "red-green"))
        lines = extract_centrelines(picture, StripeSettings(4 * np.hypot(sigma_px, 1.0), height), noise=noise)
        errors = np.concatenate([truth(*line.uv.T) / line.sigma for line in lines])
        assert len(errors) > 120
        each.append(np.sqrt(np.mean(errors**2)))
    assert max(each) < 2.0
    assert np.sqrt(np.mean(np.square(each))) < 1.3
