"""Centrelines against analytic stripes: biases, precision, ends, edges, and what must not be found."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
import pytest

from core.image.stripes.centreline import Centreline
from core.image.stripes.extraction import StripeSettings, choose_settings, correlation_length_px, extract_centrelines
from core.image.stripes.noise import NoiseModel, estimate_noise, estimate_noise_of_pair, free_of_structure
from core.image.stripes.tracing.ridge import kernel_radius
from tests.image.synthetic_stripes import Distance, circle, draw, expose, speckle, straight

QUIET = NoiseModel(0.3)
NOISY = NoiseModel(1.0, 0.02)
S = 1.5
SETTINGS = StripeSettings(4 * S, 150.0)
SHAPE = (160, 220)


def find(picture: np.ndarray, noise: NoiseModel = QUIET, settings: StripeSettings = SETTINGS, **masks: np.ndarray):
    return extract_centrelines(picture.astype(np.float32), settings, noise=noise, **masks)


def errors(line: Centreline, truth: Distance) -> np.ndarray:
    return truth(line.uv[:, 0], line.uv[:, 1])


@pytest.mark.parametrize("angle_deg", [0.0, 1.0, 17.0, 45.0, 73.0, 90.0, 135.0])
@pytest.mark.parametrize("sigma", [1.0, 1.5, 2.5])
def test_no_phase_bias(angle_deg: float, sigma: float) -> None:
    truth = straight((110.3, 80.2), np.radians(angle_deg))
    (line,) = find(draw(SHAPE, truth, sigma, 150.0), settings=StripeSettings(4 * sigma, 150.0))
    assert np.abs(errors(line, truth)).max() < 0.003
    assert len(line) > 100


def test_places_across_the_pixel_agree() -> None:
    """A horizontal stripe at 10 places within a pixel: the phase error does not average out along it."""
    for place in np.linspace(80, 81, 10, endpoint=False):
        truth = straight((0.0, place), 0.0)
        (line,) = find(draw(SHAPE, truth, S, 150.0))
        assert abs(errors(line, truth).mean()) < 0.001


def test_points_are_a_pixel_apart_and_in_order() -> None:
    truth = straight((110.0, 80.0), 0.4)
    (line,) = find(draw(SHAPE, truth, S, 150.0))
    steps = np.diff(line.uv, axis=0)
    np.testing.assert_allclose(np.hypot(*steps.T), 1.0, atol=0.01)
    np.testing.assert_allclose(steps, line.tangent[:-1], atol=0.01)


@pytest.mark.parametrize("sigma", [1.0, 1.5, 2.5, 4.0])
def test_width_and_strength_are_freed_of_the_filter(sigma: float) -> None:
    truth = straight((110.0, 80.0), 0.3)
    (line,) = find(20 + draw(SHAPE, truth, sigma, 120.0), settings=StripeSettings(4 * sigma, 150.0))
    np.testing.assert_allclose(line.width, sigma, rtol=0.02)
    np.testing.assert_allclose(line.strength, 120.0, rtol=0.02)


def test_width_follows_a_step_of_width() -> None:
    truth = straight((110.0, 80.0), 0.0)
    picture = draw(SHAPE, truth, lambda u, v: np.where(u < 110, 1.5, 2.2), 120.0)
    (line,) = find(picture)
    u = line.uv[:, 0]
    np.testing.assert_allclose(line.width[u < 95], 1.5, rtol=0.03)
    np.testing.assert_allclose(line.width[u > 125], 2.2, rtol=0.03)
    assert np.abs(errors(line, truth)).max() < 0.003


@pytest.mark.parametrize("radius", [25.0, 60.0])
def test_curvature_bias_is_removed(radius: float) -> None:
    truth = circle((110.2, 80.4), radius)
    lines = find(draw(SHAPE, truth, S, 150.0))
    error = np.concatenate([errors(line, truth) for line in lines])
    bias_of_steger = SETTINGS.filter_px**2 / (2 * radius)
    assert bias_of_steger > 0.03
    assert np.abs(error).max() < 0.15 * bias_of_steger + 0.003
    assert len(error) > 0.75 * 2 * np.pi * radius


def test_sloping_background_bias_is_removed() -> None:
    truth = straight((110.0, 80.0), 0.3)
    v, u = np.mgrid[: SHAPE[0], : SHAPE[1]]
    slope = 0.3
    picture = 100 + draw(SHAPE, truth, S, 100.0) + slope * truth(u, v)
    (line,) = find(picture)
    bias_of_steger = slope * (S**2 + SETTINGS.filter_px**2) ** 1.5 / (100 * S)
    assert bias_of_steger > 0.03
    assert np.abs(errors(line, truth)).max() < 0.003


@pytest.mark.parametrize("angle_deg", [0.0, 17.0, 60.0, 90.0])
def test_points_reach_to_where_the_filter_would_leave_the_picture(angle_deg: float) -> None:
    """A stripe that leaves the picture has no end there: nothing is trimmed, and its last points are as true."""
    angle = np.radians(angle_deg)
    truth = straight((110.0, 80.0), angle)
    (line,) = find(draw(SHAPE, truth, S, 150.0))
    nearest = np.minimum(line.uv, np.array(SHAPE[::-1]) - 1 - line.uv).min(axis=1)
    reach = kernel_radius(SETTINGS.filter_px)
    assert nearest.min() >= reach
    assert nearest[0] < reach + 2 and nearest[-1] < reach + 2
    assert np.abs(errors(line, truth)).max() < 0.003


def until(end: float) -> Distance:
    """The height of a stripe that ends at u = `end`."""
    return lambda u, v: np.where(u < end, 150.0, 0.0)


def test_a_stripe_that_ends_beside_the_border_is_trimmed_like_any_other() -> None:
    truth = straight((110.0, 80.0), 0.0)
    for end in (198, 204, 207):
        (line,) = find(draw(SHAPE, truth, S, until(end)))
        assert line.uv[:, 0].max() < end - 3
        assert np.abs(errors(line, truth)).max() < 0.01


def test_a_stripe_along_the_border_is_not_found() -> None:
    assert find(draw(SHAPE, straight((0.0, 1.0), 0.0), S, 150.0)) == ()


@pytest.mark.parametrize("angle_deg", [20.0, 60.0, 90.0])
def test_errors_follow_the_law_under_read_and_shot_noise(angle_deg: float) -> None:
    rng = np.random.default_rng(5)
    truth = straight((160.2, 120.1), np.radians(angle_deg))
    light = 10 + draw((240, 320), truth, S, 100.0)
    normalised, plain, means = [], [], []
    for _ in range(12):
        (line,) = find(expose(light, rng), NOISY)
        plain.append(errors(line, truth))
        normalised.append(plain[-1] / line.sigma)
        per_mean = np.median(line.sigma) * np.sqrt(correlation_length_px(SETTINGS) / len(line))
        means.append(errors(line, truth).mean() / per_mean)
    assert 0.85 < np.sqrt(np.mean(np.concatenate(normalised) ** 2)) < 1.15
    assert np.sqrt(np.mean(np.square(means))) < 1.8
    x = np.linspace(-8, 8, 2001)
    section = 100 * np.exp(-0.5 * (x / S) ** 2)
    information = np.trapezoid((x / S**2 * section) ** 2 / NOISY.variance(10 + section), x)
    bound = 1 / np.sqrt(information * correlation_length_px(SETTINGS))
    assert np.sqrt(np.mean(np.concatenate(plain) ** 2)) < 1.2 * bound


def test_speckled_stripes_are_found_whole_and_their_sigma_is_honest() -> None:
    rng = np.random.default_rng(11)
    truth = straight((160.2, 120.1), 0.35)
    light = draw((240, 320), truth, S, 120.0)
    normalised, found = [], 0
    for _ in range(8):
        lines = find(expose(light * speckle(light.shape, 0.18, 1.4, rng), rng), NOISY)
        found += sum(map(len, lines))
        normalised += [errors(line, truth) / line.sigma for line in lines]
    clean = sum(map(len, find(light, NOISY)))
    assert found > 0.97 * 8 * clean
    assert 0.8 < np.sqrt(np.mean(np.concatenate(normalised) ** 2)) < 1.2


def test_deep_speckle_does_not_break_a_stripe_up() -> None:
    rng = np.random.default_rng(12)
    truth = straight((160.2, 120.1), 0.35)
    light = draw((240, 320), truth, 2.0, 120.0) * speckle((240, 320), 0.5, 2.0, rng)
    lines = find(expose(light, rng), NOISY, StripeSettings(8.0, 120.0))
    assert sum(map(len, lines)) > 0.85 * 320
    assert np.sqrt(np.mean(np.concatenate([errors(line, truth) for line in lines]) ** 2)) < 0.4


def test_ends_are_trimmed() -> None:
    truth = straight((110.0, 80.0), 0.0)
    oblique = np.radians(50)

    def lit(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return 150.0 * ((u - 110) * np.cos(oblique) + (v - 80) * np.sin(oblique) < 0)

    (line,) = find(draw(SHAPE, truth, S, lit))
    assert 110 - 12 < line.uv[:, 0].max() < 110 - 3
    assert np.abs(errors(line, truth)).max() < 0.05


@pytest.mark.parametrize("oblique_deg", [20.0, 35.0])
def test_an_oblique_shadow_does_not_pull_the_end_of_a_stripe(oblique_deg: float) -> None:
    truth = straight((110.0, 80.0), 0.0)
    across = np.radians(90.0 - oblique_deg)

    def lit(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return 150.0 * ((u - 150) * np.cos(across) + (v - 80) * np.sin(across) < 0)

    (line,) = find(draw(SHAPE, truth, S, lit))
    assert np.abs(errors(line, truth)).max() < 0.15


def test_a_stripe_that_fades_because_its_surface_turns_away_is_kept() -> None:
    truth = straight((110.0, 80.0), 0.0)

    def lit(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return 150.0 * np.sqrt(np.clip(1 - ((u - 110) / 90) ** 2, 0, None))

    (line,) = find(draw(SHAPE, truth, S, lit))
    assert line.uv[:, 0].min() < 40
    assert line.uv[:, 0].max() > 180
    assert np.abs(errors(line, truth)).max() < 0.01


def test_a_line_that_falls_in_light_and_width_all_along_is_kept_to_its_end() -> None:
    """A laser's line lens does that: no shadow, which falls within a short way."""
    truth = straight((0.0, 60.3), 0.0)
    v, u = np.mgrid[:120, :700]
    width = 2.4 + 0.9 * np.minimum(u, 500) / 500
    light = (50 + 60 * u / 700) * np.exp(-0.5 * (truth(u, v) / width) ** 2)
    light[:, :30] = 0.0
    (line,) = find(light, settings=StripeSettings(12.0, 80.0))
    assert line.uv[:, 0].min() < 50
    assert np.abs(errors(line, truth)).max() < 0.01


@pytest.mark.parametrize("jump", [1.0, 3.0, 8.0, 20.0])
def test_a_centreline_never_crosses_a_jump(jump: float) -> None:
    left, right = straight((0.0, 80.2), 0.0), straight((0.0, 80.2 + jump), 0.0)
    rng = np.random.default_rng(2)
    light = draw(SHAPE, lambda u, v: np.where(u < 110, left(u, v), right(u, v)), S, 120.0)
    lines = find(expose(light, rng), NOISY)
    assert len(lines) == 2
    for line in lines:
        truth = left if line.uv[:, 0].mean() < 110 else right
        assert np.abs(errors(line, truth)).max() < 0.15
        assert np.all(line.uv[:, 0] < 110) or np.all(line.uv[:, 0] > 110)


@pytest.mark.parametrize("kink_deg", [8.0, 25.0, 60.0])
def test_a_centreline_never_crosses_a_kink(kink_deg: float) -> None:
    slope = np.tan(np.radians(kink_deg))
    left, right = straight((110.0, 60.0), 0.0), straight((110.0, 60.0), np.arctan(slope))
    bisector = np.radians(kink_deg) / 2

    def bent(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        before = (u - 110) * np.cos(bisector) + (v - 60) * np.sin(bisector) < 0
        return np.where(before, left(u, v), right(u, v))

    rng = np.random.default_rng(3)
    lines = find(expose(draw(SHAPE, bent, S, 120.0), rng), NOISY)
    assert len(lines) == 2
    for line in lines:
        truth = left if line.uv[:, 0].mean() < 110 else right
        assert np.abs(errors(line, truth)).max() < 0.1


def test_a_smooth_curve_stays_in_one_piece() -> None:
    wave = 6.0

    def truth(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        slope = wave * 2 * np.pi / 200 * np.cos(2 * np.pi * u / 200)
        return (v - 80 - wave * np.sin(2 * np.pi * u / 200)) / np.hypot(1, slope)

    (line,) = find(expose(draw(SHAPE, truth, S, 120.0), np.random.default_rng(4)), NOISY)
    assert len(line) > 180


def test_parallel_neighbours_pull_no_point() -> None:
    one = straight((0.0, 70.0), 0.0)
    for apart in (4.6, 5.0, 5.8, 6.5, 8.0):
        other = straight((0.0, 70.0 + apart * S), 0.0)
        for line in find(draw(SHAPE, one, S, 120.0) + draw(SHAPE, other, S, 120.0)):
            nearest = np.minimum(np.abs(errors(line, one)), np.abs(errors(line, other)))
            assert nearest.max() < 0.01
    assert len(find(draw(SHAPE, one, S, 120.0) + draw(SHAPE, other, S, 120.0))) == 2


def test_crossing_stripes_of_one_picture_leave_the_junction_out() -> None:
    one, other = straight((110.0, 80.0), 0.0), straight((110.0, 80.0), np.radians(70))
    lines = find(draw(SHAPE, one, S, 120.0) + draw(SHAPE, other, S, 120.0))
    assert sum(map(len, lines)) > 220
    for line in lines:
        nearest = np.minimum(np.abs(errors(line, one)), np.abs(errors(line, other)))
        assert nearest.max() < 0.02


def test_saturated_points_are_flagged_and_only_they() -> None:
    truth = straight((110.0, 80.3), 0.0)
    light = draw(SHAPE, truth, S, lambda u, v: np.where(np.abs(u - 110) < 20, 400.0, 150.0))
    picture = np.minimum(np.round(light), 255.0)
    (line,) = find(picture, saturated=picture >= 255)
    beside = np.abs(line.uv[:, 0] - 110)
    assert line.saturated[beside < 18].all()
    assert not line.saturated[beside > 20 + 3 * SETTINGS.filter_px].any()
    assert np.abs(errors(line, truth)).max() < 0.02


def test_a_stripe_goes_on_beyond_a_saturated_gap() -> None:
    """Frame − reference is zero where the reference is saturated: the line goes on behind it, bare in between."""
    truth = straight((110.0, 80.3), 0.1)
    light = draw(SHAPE, truth, S, 120.0)
    gap = np.zeros(SHAPE, dtype=bool)
    gap[:, 103:117] = True
    (line,) = find(np.where(gap, 0.0, light), saturated=gap)
    assert line.uv[:, 0].min() < 20 and line.uv[:, 0].max() > 200
    assert np.abs(errors(line, truth))[~line.saturated].max() < 0.02
    assert len(find(np.where(gap, 0.0, light))) == 2


def test_ignored_parts_are_left_alone() -> None:
    truth = straight((110.0, 80.3), 0.0)
    ignore = np.zeros(SHAPE, dtype=bool)
    ignore[:, 110:] = True
    (line,) = find(draw(SHAPE, truth, S, 120.0), ignore=ignore)
    assert line.uv[:, 0].max() < 110


def test_no_stripe_gives_nothing() -> None:
    rng = np.random.default_rng(1)
    for light in (np.zeros(SHAPE), np.full(SHAPE, 255.0), expose(np.full(SHAPE, 30.0), rng)):
        assert find(light, NOISY) == ()
        assert choose_settings(light.astype(np.float32), 255.0) is None


def test_an_edge_of_brightness_is_no_stripe() -> None:
    rng = np.random.default_rng(1)
    v, u = np.mgrid[: SHAPE[0], : SHAPE[1]]
    step = np.where(straight((110.0, 80.0), 0.3)(u, v) > 0, 150.0, 20.0)
    assert find(expose(step, rng), NOISY) == ()


def test_pictures_too_small_or_of_the_wrong_kind() -> None:
    assert find(np.zeros((9, 9))) == ()
    double: Any = np.zeros((50, 50))
    with pytest.raises(ValueError, match="float32"):
        extract_centrelines(double, SETTINGS, noise=QUIET)
    with pytest.raises(ValueError, match="mask"):
        find(np.zeros((50, 50)), ignore=np.zeros((40, 50), dtype=bool))


def test_16_bit_pictures_give_the_same_as_8_bit_ones() -> None:
    rng = np.random.default_rng(6)
    picture = np.round(expose(20 + draw(SHAPE, straight((110.0, 80.0), 0.3), S, 120.0), rng))
    small, large = picture.astype(np.float32), (257 * picture).astype(np.float32)
    chosen, chosen_large = choose_settings(small, 255.0), choose_settings(large, 65535.0)
    assert chosen is not None and chosen_large is not None
    assert chosen_large.width_px == pytest.approx(chosen.width_px, rel=1e-3)
    assert chosen_large.contrast == pytest.approx(257 * chosen.contrast, rel=1e-3)
    (line,) = extract_centrelines(small, chosen, noise=estimate_noise(small))
    (line_large,) = extract_centrelines(large, chosen_large, noise=estimate_noise(large))
    np.testing.assert_allclose(line_large.uv, line.uv, atol=1e-3)
    np.testing.assert_allclose(line_large.sigma, line.sigma, rtol=0.02)


@pytest.mark.parametrize(
    ("sigma", "height", "background", "read"),
    [(1.5, 150, 0, 1.0), (2.5, 30, 20, 2.0), (0.9, 60, 5, 1.5), (5.0, 100, 50, 2.0), (2.5, 800, 10, 1.0), (2, 8, 9, 1)],
)
def test_settings_are_chosen_right(sigma: float, height: float, background: float, read: float) -> None:
    rng = np.random.default_rng(8)
    light = background + draw((400, 500), straight((250.0, 200.0), 0.4), sigma, height, samples=2)
    picture = np.clip(np.round(expose(light, rng, read)), 0, 255).astype(np.float32)
    chosen = choose_settings(picture, 255.0)
    assert chosen is not None
    assert chosen.width_px == pytest.approx(4 * sigma, rel=0.05)
    assert chosen.contrast == pytest.approx(height, rel=0.1)


def test_settings_are_chosen_from_a_difference_with_speckle() -> None:
    rng = np.random.default_rng(9)
    shape = (400, 500)
    still = 30 + draw(shape, straight((250.0, 200.0), 1.2), S, 150.0, samples=2)
    light = draw(shape, straight((250.0, 200.0), 0.2), S, 90.0, samples=2) * speckle(shape, 0.18, 1.4, rng)
    difference = np.round(expose(still + light, rng)) - np.round(expose(still, rng))
    chosen = choose_settings(difference.astype(np.float32), 255.0)
    assert chosen is not None
    assert chosen.width_px == pytest.approx(6.0, rel=0.08)
    assert 55 < chosen.contrast < 100


@pytest.mark.parametrize(("width_px", "contrast", "grain_px"), [(60.0, 0.3, 2.0), (80.0, 0.3, 5.0), (100.0, 0.6, 3.0)])
def test_the_grains_of_a_wide_stripe_are_not_taken_for_stripes(
    width_px: float, contrast: float, grain_px: float
) -> None:
    rng, shape, truth = np.random.default_rng(1), (1000, 1300), straight((650.0, 500.0), 0.3)
    light = draw(shape, truth, width_px / 4, 120.0, 1) * speckle(shape, contrast, grain_px, rng)
    picture = np.clip(np.round(expose(20 + light, rng)), 0, 255).astype(np.float32)
    chosen = choose_settings(picture, 255.0)
    assert chosen is not None
    assert chosen.width_px == pytest.approx(width_px, rel=0.1)
    (line,) = extract_centrelines(picture, chosen, noise=estimate_noise(picture))
    assert len(line) > 0.7 * (1300 / np.cos(0.3) - 2 * width_px)
    assert np.abs(np.median(errors(line, truth))) < 1.0


def test_a_narrow_line_along_a_bright_band_is_no_grain_of_it() -> None:
    rng, truth = np.random.default_rng(2), straight((300.0, 200.0), 0.0)
    light = 20 + draw((400, 600), truth, 25.0, 120.0) + draw((400, 600), truth, 1.5, 60.0, 2)
    chosen = choose_settings(expose(light, rng).astype(np.float32), 255.0)
    assert chosen is not None
    assert chosen.width_px < 10


def test_a_wide_speckled_stripe_is_found_though_its_grains_are_no_stripes() -> None:
    rng, shape, truth = np.random.default_rng(1), (900, 1200), straight((600.0, 440.3), 0.2)
    light = draw(shape, truth, 20.0, 120.0, 2) * speckle(shape, 0.5, 4.0, rng)
    picture = np.clip(np.round(expose(20 + light, rng)), 0, 255).astype(np.float32)
    chosen = choose_settings(picture, 255.0)
    assert chosen is not None
    assert chosen.width_px == pytest.approx(80.0, rel=0.1)
    lines = extract_centrelines(picture, chosen, noise=estimate_noise(picture), saturated=picture >= 255)
    assert max(np.abs(np.median(errors(line, truth))) for line in lines) < 2.0
    assert sum(map(len, lines)) > 0.65 * 1200


@pytest.mark.parametrize("contrast", [0.0, 0.3, 0.6])
@pytest.mark.parametrize("width_px", [60.0, 80.0, 100.0])
def test_a_wide_stripe_is_told_in_a_small_picture(width_px: float, contrast: float) -> None:
    """The filter sees no more than a stretch in the middle of it: it goes on to the borders."""
    rng, shape = np.random.default_rng(1), (500, 400)
    grains = speckle(shape, contrast, 3.0, rng) if contrast else 1.0
    light = draw(shape, straight((200.0, 250.0), 1.45), width_px / 4, 120.0, 1) * grains
    picture = np.clip(np.round(expose(20 + light, rng)), 0, 255).astype(np.float32)
    chosen = choose_settings(picture, 255.0)
    assert chosen is not None
    assert chosen.width_px == pytest.approx(width_px, rel=0.1)


def test_noise_is_estimated() -> None:
    rng = np.random.default_rng(10)
    light = np.tile(np.linspace(5, 200, 640), (480, 1))
    first, second = (expose(light, rng, 1.2, 0.03).astype(np.float32) for _ in range(2))
    for found in (estimate_noise(first), estimate_noise_of_pair(first, second)):
        assert found.grey_per_electron == pytest.approx(0.03, rel=0.15)
        assert np.sqrt(found.variance(np.array(100.0))) == pytest.approx(np.sqrt(1.44 + 3.0), rel=0.1)
    dark = expose(np.zeros((480, 640)), rng, 1.5, 0.0).astype(np.float32)
    assert estimate_noise(dark).read_grey == pytest.approx(1.5, rel=0.05)
    assert NoiseModel(1.5).of_difference().read_grey == pytest.approx(1.5 * np.sqrt(2))


@pytest.mark.parametrize(("cell_px", "most"), [(40.0, 1.15), (20.0, 1.15), (10.0, 1.15), (8.0, 1.35)])
def test_structure_does_not_pass_for_noise(cell_px: float, most: float) -> None:
    """Small squares fill the picture; a pair of pictures of them is free of structure."""
    rng = np.random.default_rng(1)
    v, u = np.indices((480, 640))
    x, y = 0.94 * u + 0.34 * v, 0.94 * v - 0.34 * u
    board = np.where((np.floor(x / cell_px) + np.floor(y / cell_px)) % 2 == 0, 200.0, 30.0)
    board = cv2.GaussianBlur(board, (0, 0), 0.8)
    one, other = (np.round(board + rng.normal(0, 1.0, board.shape)).astype(np.float32) for _ in range(2))
    assert 0.9 < estimate_noise(one).read_grey < most
    pair = estimate_noise_of_pair(one, other)
    assert 0.9 < free_of_structure(estimate_noise(one), pair, 100.0).read_grey < 1.15


def test_settings_and_noise_refuse_nonsense() -> None:
    with pytest.raises(ValueError, match="width_px"):
        StripeSettings(0.0, 10.0)
    with pytest.raises(ValueError, match="contrast"):
        StripeSettings(6.0, float("nan"))
    with pytest.raises(ValueError, match="read_grey"):
        NoiseModel(-1.0)


def test_a_stripe_saturated_all_along_still_has_an_honest_sigma() -> None:
    rng = np.random.default_rng(13)
    truth = straight((160.2, 120.1), 0.35)
    light = draw((240, 320), truth, 2.0, 500.0) * speckle((240, 320), 0.18, 2.0, rng)
    picture = np.clip(np.round(expose(light, rng)), 0, 255)
    (line,) = find(picture, NOISY, StripeSettings(8.0, 250.0), saturated=picture >= 255)
    assert line.saturated.mean() > 0.9
    assert 0.7 < np.sqrt(np.mean((errors(line, truth) / line.sigma) ** 2)) < 1.4
