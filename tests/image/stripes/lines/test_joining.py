"""Two stripes that cross in one picture: both stay whole, and no point beside the other's light is kept."""

from __future__ import annotations

import numpy as np
import pytest

from core.image.stripes.centreline import Centreline
from core.image.stripes.extraction import StripeSettings, extract_centrelines
from core.image.stripes.noise import NoiseModel
from tests.image.synthetic_stripes import Distance, expose, speckle, straight

NOISE = NoiseModel(1.0, 0.02)
SHAPE = (380, 560)
MEET = (280.2, 190.3)


def light(distance: Distance, width: float, height: float = 110.0) -> np.ndarray:
    v, u = np.mgrid[: SHAPE[0], : SHAPE[1]].astype(np.float64)
    return height * np.exp(-0.5 * (distance(u, v) / width) ** 2)


def find(picture: np.ndarray, width: float) -> tuple[Centreline, ...]:
    picture = np.minimum(np.round(picture), 255).astype(np.float32)
    settings = StripeSettings(4 * width, 110.0)
    return extract_centrelines(picture, settings, noise=NOISE, saturated=picture >= 255)


def along(line: Centreline, angle: float) -> np.ndarray:
    return (line.uv - MEET) @ np.array([np.cos(angle), np.sin(angle)])


@pytest.mark.parametrize("contrast", [0.0, 0.18])
@pytest.mark.parametrize("width", [1.5, 2.5])
@pytest.mark.parametrize("angle_deg", [20.0, 25.0, 30.0, 45.0, 60.0, 90.0])
def test_both_lines_are_whole_through_every_crossing(angle_deg: float, width: float, contrast: float) -> None:
    rng = np.random.default_rng([round(angle_deg), round(10 * width)])
    angles = (0.05, 0.05 + np.radians(angle_deg))
    lines = [straight(MEET, angle) for angle in angles]
    grains = [speckle(SHAPE, contrast, 0.8 * width, rng) if contrast else 1.0 for _ in lines]
    both = sum((light(d, width) * g for d, g in zip(lines, grains, strict=True)), np.zeros(SHAPE))
    found = find(expose(both, rng), width)
    assert len(found) == 2
    for truth, angle in zip(lines, angles, strict=True):
        (line,) = (one for one in found if np.median(np.abs(truth(*one.uv.T))) < 0.5)
        place = np.sort(along(line, angle))
        assert place[0] < -130 and place[-1] > 130
        gap = np.diff(place).max()
        pulled = 3.5 * np.hypot(1, 1.4) * width  # by the other light, see core.image.stripes.lines.neighbours
        assert gap < 2 * pulled / np.sin(np.radians(angle_deg)) + 12 * 1.4 * width
        error = np.abs(truth(*line.uv.T))
        assert np.sqrt(np.mean((error / line.sigma) ** 2)) < (1.5 if contrast else 1.3)
        assert error.max() < (0.6 if contrast else 0.1)


def test_a_line_and_its_parts_run_one_way() -> None:
    """The normals of parts that were turned to be joined turn with them."""
    lines = [straight(MEET, 0.05), straight(MEET, 0.9)]
    for line in find(expose(sum((light(d, 2.0) for d in lines), np.zeros(SHAPE)), np.random.default_rng(1)), 2.0):
        steps = np.diff(line.uv, axis=0)
        steps /= np.linalg.norm(steps, axis=1)[:, None]
        assert np.sum(steps * line.tangent[:-1], axis=1).min() > 0.99


def test_ends_at_a_depth_edge_are_not_joined_though_they_point_at_each_other() -> None:
    """A gap that no other light crosses, and one across which the line is shifted."""
    truth, other = straight(MEET, 0.05), straight(MEET, 0.05 + np.radians(60))
    u = np.arange(SHAPE[1])
    dark = light(truth, 2.0) * (np.abs(u - MEET[0]) > 20)
    assert len(find(expose(dark, np.random.default_rng(1)), 2.0)) == 2
    shifted = straight((MEET[0], MEET[1] + 6.0), 0.05)
    jump = np.where(u < MEET[0], light(truth, 2.0), light(shifted, 2.0)) * (np.abs(u - MEET[0]) > 14)
    lines = find(expose(jump + light(other, 2.0), np.random.default_rng(1)), 2.0)
    assert len(lines) == 3
    for line in lines:
        if np.median(np.abs(other(*line.uv.T))) > 2:
            assert np.all(line.uv[:, 0] < MEET[0]) or np.all(line.uv[:, 0] > MEET[0])
