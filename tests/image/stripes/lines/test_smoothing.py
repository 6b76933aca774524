import numpy as np
import pytest

from core.image.stripes.centreline import Centreline
from core.image.stripes.lines.smoothing import smooth

SIGMA_PX = 0.1
CORRELATION_PX = 7.0


def noisy(uv: np.ndarray, seed: int) -> tuple[Centreline, np.ndarray]:
    """A centreline along `uv` whose noise across itself is correlated as a filter leaves it; and its true normals."""
    tangent = np.gradient(uv, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])
    kernel = np.exp(-(np.arange(-10, 11) ** 2) / (2 * (CORRELATION_PX / (2 * np.sqrt(np.pi))) ** 2))
    white = np.random.default_rng(seed).normal(size=len(uv) + 20)
    noise = SIGMA_PX * np.convolve(white, kernel / np.linalg.norm(kernel), mode="valid")
    flat = np.full(len(uv), 1.5)
    line = Centreline(
        uv + noise[:, None] * normal,
        normal,
        flat,
        flat,
        np.full(len(uv), SIGMA_PX),
        np.zeros(len(uv), bool),
        CORRELATION_PX,
    )
    return line, normal


def straight() -> np.ndarray:
    s = np.arange(600.0)
    return np.column_stack([100 + 0.8 * s, 200 + 0.6 * s])


def arc(radius: float) -> np.ndarray:
    phi = np.arange(0, 1.2, 1 / radius)
    return 400 + radius * np.column_stack([np.cos(phi), np.sin(phi)])


def errors(uv: np.ndarray, seeds: range) -> tuple[np.ndarray, np.ndarray]:
    """Errors across the line and stated σ, of the points away from the ends."""
    found, stated = [], []
    for seed in seeds:
        line, normal = noisy(uv, seed)
        smoothed = smooth(line)
        inner = slice(20, -20)
        found.append(np.einsum("ni,ni->n", smoothed.uv - uv, normal)[inner])
        stated.append(smoothed.sigma[inner])
    return np.concatenate(found), np.concatenate(stated)


def test_a_straight_line_becomes_three_times_as_certain():
    error, sigma = errors(straight(), range(10))
    assert np.std(error) < SIGMA_PX / 2.5
    assert np.mean((error / sigma) ** 2) == pytest.approx(1.0, abs=0.5)


@pytest.mark.parametrize("radius", [80.0, 150.0, 400.0])
def test_an_arc_is_not_flattened(radius):
    error, sigma = errors(arc(radius), range(12))
    assert abs(np.mean(error)) < 0.02  # the mean of so few points is itself known to 0.01 only
    assert np.std(error) < SIGMA_PX
    assert np.mean((error / sigma) ** 2) < 1.7


def test_a_bend_is_kept():
    s = np.arange(-200.0, 200.0)
    uv = np.column_stack([300 + s, 200 + 0.15 * np.abs(s)])
    line, normal = noisy(uv, 1)
    error = np.einsum("ni,ni->n", smooth(line).uv - uv, normal)
    assert np.abs(error[195:205]).max() < 0.5
    assert np.std(error[20:170]) < SIGMA_PX / 2


def test_saturated_points_have_no_say():
    line, normal = noisy(straight(), 2)
    spoiled = line.uv.copy()
    spoiled[300:320] += 3.0 * normal[300:320]
    flags = np.zeros(len(line), bool)
    flags[300:320] = True
    other = Centreline(spoiled, line.normal, line.width, line.strength, line.sigma, flags, line.correlation_px)
    assert np.abs(smooth(other).uv - straight())[:290].max() < 0.2
    assert np.abs(smooth(other).uv - straight())[330:].max() < 0.2


def test_too_few_points_stay_as_they_are():
    line, _ = noisy(straight()[:25], 3)
    short = line.select(slice(0, 2))
    assert smooth(short) is short


@pytest.mark.accuracy
@pytest.mark.parametrize("length", [150, 400])
def test_a_mean_along_the_line_is_as_certain_as_the_correlation_length_says(length):
    means, stated = [], []
    for seed in range(300):
        line, normal = noisy(straight(), seed)
        moved = smooth(line)
        middle = slice((len(line) - length) // 2, (len(line) + length) // 2)
        offset = np.sum((moved.uv - straight()) * normal, axis=1)
        means.append(offset[middle].mean())
        stated.append(np.median(moved.sigma[middle]) * np.sqrt(moved.correlation_px / length))
    assert np.std(means) / np.mean(stated) == pytest.approx(1.0, abs=0.1)


def test_an_arc_as_a_sphere_shows_it_keeps_its_place_up_to_its_ends():
    """Light on a sphere of 116 px radius seen at 27°: an ellipse, more bent towards its ends."""
    rng = np.random.default_rng(5)
    x = np.arange(-75.0, 75.0)
    y = 52.0 * (1 - np.sqrt(1 - (x / 116.0) ** 2))
    slope = np.gradient(y, x)
    normal = np.column_stack([-slope, np.ones_like(x)]) / np.hypot(1, slope)[:, None]
    kernel = np.exp(-0.5 * (np.arange(-8, 9) / 2.1) ** 2)
    moved = []
    for _ in range(60):
        noise = np.convolve(rng.normal(0, 0.03, len(x) + 16), kernel, "valid") / np.sqrt(np.sum(kernel**2))
        flat = np.full(len(x), 0.03)
        uv = np.column_stack([x, y]) + noise[:, None] * normal + 200.0
        line = Centreline(uv, normal, 1.5 + 0 * x, 100.0 + 0 * x, flat, np.zeros(len(x), bool), 7.5)
        moved.append(np.sum((smooth(line).uv - 200.0 - np.column_stack([x, y])) * normal, axis=1))
    bias = np.mean(moved, axis=0)
    assert abs(bias[5:15].mean()) < 0.007  # 0.016 with windows that reach in as far as in the middle
    assert abs(bias[55:95].mean()) < 0.007
