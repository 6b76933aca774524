"""Pictures of a sensor with a colour mosaic are told from those of a grey one, and used where they were measured."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from core.acquire.channel import PLAIN_CHANNELS
from core.acquire.grey import to_grey
from core.image.mosaic import ALL_SITES, colours_of, even_grey, is_interpolated, sites_of
from core.image.stripes.extraction import choose_settings, extract_centrelines
from core.image.stripes.noise import estimate_noise
from core.scan.features.picture_faults import FINEST_PX


def sensed(seed, shape=(200, 300)):
    """A slope with a bright stripe and noise, as a sensor sees it."""
    v, u = np.mgrid[: shape[0], : shape[1]]
    light = 20 + 0.05 * v + 60 * np.exp(-((v - 90.3 - 0.1 * u) ** 2) / 4)
    return (light + np.random.default_rng(seed).normal(0, 2, shape)).round().clip(0, 255).astype(np.uint8)


@pytest.mark.parametrize("pattern", [cv2.COLOR_BayerRGGB2BGR, cv2.COLOR_BayerGRBG2BGR, cv2.COLOR_BayerRGGB2BGR_EA])
@pytest.mark.parametrize("channel", [None, "red", "green"])
def test_interpolated_colours_are_seen_in_grey_and_in_each_colour(pattern, channel):
    assert is_interpolated(to_grey(cv2.cvtColor(sensed(1), pattern), channel))


@pytest.mark.parametrize("seed", range(5))
def test_what_a_grey_sensor_sees_is_not_interpolated(seed):
    assert not is_interpolated(sensed(seed))
    assert not is_interpolated(sensed(seed, (101, 203)))


def test_neither_fields_of_different_noise_nor_three_sensors_nor_smooth_pictures_are_interpolated():
    fields = sensed(1).astype(float)
    fields[::2] += np.random.default_rng(2).normal(0, 0.6, fields[::2].shape)
    assert not is_interpolated(fields.round().astype(np.uint8))
    assert not is_interpolated(to_grey(np.stack([sensed(seed) for seed in range(3)], axis=2)))
    assert not is_interpolated(np.full((50, 50), 7, np.uint8))
    assert not is_interpolated(np.zeros((1, 3), np.uint8))
    assert not is_interpolated(cv2.blur(sensed(1), (5, 5)))


PATTERNS = ("RGGB", "BGGR", "GRBG", "GBRG")
RED_LASER = {"R": 1.0, "G": 0.12, "B": 0.06}


def behind(pattern, light, response):
    """What a sensor behind a mosaic makes of the light (H, W) if its sites have such a response."""
    seen = light.copy()
    for at, colour in enumerate(pattern):
        seen[at // 2 :: 2, at % 2 :: 2] *= response[colour]
    return seen


@pytest.mark.parametrize("pattern", PATTERNS)
@pytest.mark.parametrize("channel", PLAIN_CHANNELS)
def test_the_sites_of_a_colour_hold_what_was_measured_in_it(pattern, channel):
    raw = behind(pattern, np.full((40, 60), 100, np.uint8), dict.fromkeys("RGB", 0) | {channel[0].upper(): 1})
    sites = sites_of(pattern, channel)
    assert np.all(sites.of(raw) == 100)
    noisy = sensed(3)
    made = to_grey(colours_of(noisy, pattern), channel)
    assert np.array_equal(sites.of(made)[1:-1, 1:-1], sites.of(noisy)[1:-1, 1:-1])
    assert not is_interpolated(sites.of(made))


@pytest.mark.parametrize("pattern", ["RGGB", "GBRG"])
def test_a_stripe_is_found_by_the_sites_that_see_it_where_it_is_as_sure_as_it_says(pattern):
    v, u = np.mgrid[:300, :400].astype(float)
    cosine, sites = np.cos(np.arctan(0.2)), sites_of(pattern, "red")
    light = 10 + behind(pattern, 150 * np.exp(-(((v - 120.37 - 0.2 * u) * cosine) ** 2) / 18), RED_LASER)
    errors = []
    for seed in range(8):
        noise = np.random.default_rng(seed).normal(0, 2, light.shape)
        seen = sites.of((light + noise).round().clip(0, 255)).astype(np.float32)
        lines = extract_centrelines(seen, choose_settings(seen, 255.0), noise=estimate_noise(seen))
        line = max(sites.in_whole_picture(lines), key=len)
        assert len(line) > 180
        assert np.median(line.width) == pytest.approx(3.0, rel=0.05)
        errors.append((line.uv[:, 1] - 120.37 - 0.2 * line.uv[:, 0]) * cosine / line.sigma)
    assert abs(np.mean(np.concatenate(errors))) < 0.2
    assert 0.85 < np.std(np.concatenate(errors)) < 1.15


@pytest.mark.parametrize(("width", "least", "most"), [(1.0, 5.0, 30.0), (FINEST_PX, 0.7, 1.4)])
def test_interpolated_a_stripe_too_fine_for_the_tiles_is_off_by_more_than_its_sigma(width, least, most):
    """Nearly along the rows, where it is worst: the bound from which on it is as sure as it says is measured."""
    v, u = np.mgrid[:300, :400].astype(float)
    light, errors = 150 * np.exp(-((v - 40.37 - 0.02 * u) ** 2) / (2 * width**2)), []
    for seed in range(2):
        noise = np.random.default_rng(seed).normal(0, 2, light.shape)
        raw = (10 + behind("RGGB", light, RED_LASER) + noise).round().clip(0, 255).astype(np.uint8)
        seen = to_grey(cv2.cvtColor(raw, cv2.COLOR_BayerRGGB2BGR), "red").astype(np.float32)
        lines = extract_centrelines(seen, choose_settings(seen, 255.0), noise=estimate_noise(seen))
        line = max(lines, key=len)
        errors.append((line.uv[:, 1] - 40.37 - 0.02 * line.uv[:, 0]) / line.sigma)
    assert least < np.sqrt(np.mean(np.concatenate(errors) ** 2)) < most


def test_places_and_stripes_go_to_the_sites_and_back():
    sites = sites_of("GBRG", "red")
    line = extract_centrelines(
        sensed(1).astype(np.float32),
        choose_settings(sensed(1).astype(np.float32), 255.0),
        noise=estimate_noise(sensed(1)),
    )[0]
    (back,) = sites.in_whole_picture([line])
    assert sites.places_of(back.uv) == pytest.approx(line.uv)
    assert back.sigma == pytest.approx(2 * line.sigma)
    (same,) = ALL_SITES.in_whole_picture([line])
    assert same is line
    stripe = choose_settings(sensed(1).astype(np.float32), 255.0)
    assert sites.stripe_in_whole_picture(sites.stripe_of(stripe)) == stripe
    assert sites.stripe_of(stripe) == replace(stripe, width_px=stripe.width_px / 2)
    assert sites.stripe_of(None) is None


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_a_target_in_any_light_is_grey_in_all_sites_and_its_edges_stay(dtype):
    white = np.iinfo(dtype).max
    v, u = np.mgrid[:200, :200].astype(float)
    target = np.where((np.abs(u - 100) < 40) & (np.abs(v - 90) < 50), 0.1, 0.8)
    raw = behind("GRBG", 0.9 * white * target, {"R": 0.3, "G": 1.0, "B": 0.5}).round().astype(dtype)
    grey = even_grey(raw)
    assert grey.dtype == np.uint16
    for part in (target > 0.5, target < 0.5):
        assert np.ptp(grey[part].astype(float)) < 0.02 * grey.max()
    assert np.median(grey[target < 0.5]) == pytest.approx(np.median(grey[target > 0.5]) / 8, rel=0.02)
