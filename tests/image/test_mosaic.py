"""Pictures of a sensor with a colour mosaic are told from those of a grey one by their noise."""

import cv2
import numpy as np
import pytest

from core.acquire.grey import to_grey
from core.image.mosaic import is_interpolated


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
