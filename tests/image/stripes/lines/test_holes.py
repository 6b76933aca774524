"""Whatever a picture shows and whatever width is looked for: lines are unbroken, inside, and run along themselves."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from core.files.pictures import read_picture
from core.image.stripes.centreline import Centreline
from core.image.stripes.extraction import StripeSettings, extract_centrelines
from core.image.stripes.lines.holes import longest_hole_px, unbroken_parts
from core.image.stripes.noise import estimate_noise
from core.image.stripes.tracing.pixel_state import SATURATED
from tests.shared import REAL_SETS

REAL = REAL_SETS / "linelight"
needs_real_pictures = pytest.mark.skipif(not REAL.exists(), reason="the photographs of shared/real are not there")


def structured(seed: int) -> np.ndarray:
    """A picture full of what is no stripe: a board, blobs of many sizes, glare that saturates."""
    rng = np.random.default_rng(seed)
    height, width = 480, 640
    v, u = np.indices((height, width))
    scene = np.where((u // 70 + v // 70) % 2 == 0, 140.0, 30.0)
    for size in (2.0, 6.0, 20.0):
        blobs = cv2.GaussianBlur(rng.normal(0, 1, (height, width)), (0, 0), size)
        scene += 45 * blobs / blobs.std()
    scene += 260 * np.exp(-0.5 * (((u - 320) * 0.3 + (v - 200)) / 25) ** 2)
    return np.clip(np.round(cv2.GaussianBlur(scene, (0, 0), 0.8)), 0, 255).astype(np.uint8)


def lines_in(on: np.ndarray, off: np.ndarray | None, width_px: float) -> tuple[Centreline, ...]:
    picture = on.astype(np.float32) - (0 if off is None else off.astype(np.float32))
    settings = StripeSettings(width_px, 20.0)
    return extract_centrelines(picture, settings, noise=estimate_noise(picture), saturated=on == 255)


def hold(lines: tuple[Centreline, ...], on: np.ndarray, width_px: float) -> None:
    """No point is outside the picture, beside or behind the one before, or far from it where nothing hides the line."""
    longest = longest_hole_px(StripeSettings(width_px, 20.0).filter_px)
    for line in lines:
        assert (line.uv >= 0).all()
        assert (line.uv <= np.array(on.shape[::-1]) - 1).all()
        steps = np.diff(line.uv, axis=0)
        ahead = np.einsum("ni,ni->n", steps, line.tangent[:-1] + line.tangent[1:])
        beside = np.einsum("ni,ni->n", steps, line.normal[:-1] + line.normal[1:])
        assert (ahead > np.abs(beside)).all()
        for k in np.flatnonzero(np.hypot(*steps.T) > longest):
            reach, middle = np.hypot(*steps[k]), line.uv[k : k + 2].mean(axis=0)
            u, v = np.round(line.uv[k] + np.linspace(0, 1, 50)[:, None] * steps[k]).astype(int).T
            if np.mean(on[v, u] == 255) > 0.4:
                continue
            others = np.vstack([other.uv for other in lines if other is not line])
            assert np.hypot(*(others - middle).T).min() < reach


@pytest.mark.parametrize("width_px", [4.0, 12.0, 40.0, 90.0])
@pytest.mark.parametrize("seed", [1, 2])
def test_lines_in_a_picture_full_of_structure_are_whole(width_px: float, seed: int) -> None:
    picture = structured(seed)
    hold(lines_in(picture, None, width_px), picture, width_px)


@needs_real_pictures
@pytest.mark.parametrize(
    ("number", "channel"),
    [
        pytest.param(
            number, channel, marks=() if (number, channel) in {(0, "red"), (10, None)} else pytest.mark.accuracy
        )
        for number in (0, 4, 10)
        for channel in ("red", "green", None)
    ],
)
def test_lines_in_photographs_are_whole(number: int, channel) -> None:
    on = read_picture(REAL / "light_picture" / f"light{number}.jpg", channel)
    off = read_picture(REAL / "calib_picture" / f"calib{number}.jpg", channel)
    for width_px in (4.0, 12.0, 40.0, 90.0):
        for dark in (None, off):
            hold(lines_in(on, dark, width_px), on, width_px)


DARK = np.zeros((100, 300), dtype=np.uint8)


def straight(length: int) -> np.ndarray:
    """A run along u, its normal along −v as that of a run to the right."""
    return np.column_stack([np.arange(length), np.full(length, 50.0), np.zeros(length), -np.ones(length)]).astype(float)


def parts(run: np.ndarray, keep: np.ndarray, *others: np.ndarray, state: np.ndarray = DARK) -> list[np.ndarray]:
    """Numbers of the points of each part of a run that other lines may cross."""
    lines, kept = [*others, run], [*(np.ones(len(other), dtype=bool) for other in others), keep]
    found = unbroken_parts(lines, kept, len(others), 5.0, state)
    return [np.arange(len(run))[part] for part in found]


def test_a_line_goes_on_across_a_short_hole_and_ends_at_a_long_one() -> None:
    run, keep = straight(300), np.ones(300, dtype=bool)
    keep[100:110] = False
    assert len(parts(run, keep)) == 1
    keep[150:200] = False
    assert [(part[0], part[-1]) for part in parts(run, keep)] == [(0, 149), (200, 299)]


def test_a_line_goes_on_behind_saturated_pixels() -> None:
    run, keep = straight(300), np.ones(300, dtype=bool)
    keep[150:200] = False
    assert len(parts(run, keep, state=DARK + np.uint8(SATURATED))) == 1


def test_a_line_goes_on_behind_another_that_crosses_it_and_not_beside_one() -> None:
    run, keep = straight(300), np.ones(300, dtype=bool)
    keep[150:200] = False
    across = np.column_stack([np.full(100, 175.0), np.arange(100.0)])
    beside = np.column_stack([np.arange(300.0), np.full(300, 55.0)])
    assert len(parts(run, keep, across)) == 1
    assert len(parts(run, keep, beside)) == 2


def test_a_line_ends_where_its_points_jump_aside_or_turn_back() -> None:
    run, keep = straight(200), np.ones(200, dtype=bool)
    run[100:, 1] += 3.0
    assert [len(part) for part in parts(run, keep)] == [100, 100]
    run = straight(200)
    run[100:, 0] -= 4.0
    assert [len(part) for part in parts(run, keep)] == [100, 100]
