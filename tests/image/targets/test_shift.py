"""Marks followed from picture to picture."""

import cv2
import numpy as np
import pytest

from core.image.targets import CircleGrid, detect, followed_shift
from tests.image.rendered_targets import Noise, circles, pose, render, rig

GRID = CircleGrid(7, 7, 12.0)
BEFORE = render(rig(1 / 6), pose(-25, 30, 45, (36, 36), 380), circles(GRID.points, 3.5), noise=Noise(0.5))


@pytest.fixture(scope="module")
def view():
    return detect(GRID, BEFORE)


def after(u: float, v: float, gain: float = 1.0) -> np.ndarray:
    """The picture moved by (u, v) px and lit otherwise, with a line of light across it."""
    moved = cv2.warpAffine(
        BEFORE,
        np.array([[1.0, 0, u], [0, 1, v]]),
        BEFORE.shape[::-1],
        flags=cv2.INTER_CUBIC,
        borderMode=cv2.BORDER_REPLICATE,
    ).astype(float)
    rows = np.arange(len(moved))[:, None]
    line = 60 * np.exp(-0.5 * ((rows - len(moved) / 2) / 2) ** 2)
    noise = np.random.default_rng(7).normal(0, 0.5, moved.shape)
    return np.clip(np.round(gain * moved + line + noise), 0, 255).astype(np.uint8)


@pytest.mark.parametrize("gain", [1.0, 0.8])
@pytest.mark.parametrize("shift", [(0.0, 0.0), (0.3, 0.0), (0.4, -0.4), (2.0, 1.0)])
def test_a_shift_is_told_under_a_line_and_in_other_light(view, shift, gain):
    assert followed_shift(view, BEFORE, after(*shift, gain)) == pytest.approx(np.hypot(*shift), abs=0.1)


@pytest.mark.parametrize("spacings", [1, 2])
@pytest.mark.parametrize("neighbour", [1, 7])
def test_neighbours_are_not_taken_for_the_marks_themselves(view, neighbour, spacings):
    """After such a movement each mark but those at one side has another just where it was."""
    shift = spacings * (view.uv[24 + neighbour] - view.uv[24])
    assert followed_shift(view, BEFORE, after(*shift)) is None


def test_another_picture_is_not_followed(view):
    assert followed_shift(view, BEFORE, np.full_like(BEFORE, 128)) is None
