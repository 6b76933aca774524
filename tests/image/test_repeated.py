"""Pictures that are known again by their pixels."""

import cv2
import numpy as np
import pytest

from core.image.repeated import Repeats, pixels_of


@pytest.fixture
def picture():
    return np.random.default_rng(1).integers(0, 256, (48, 64), np.uint8)


def test_equal_pixels_are_the_same_picture_however_they_lie_in_memory(picture):
    assert pixels_of(picture) == pixels_of(picture.copy()) == pixels_of(np.asfortranarray(picture))
    again = cv2.imdecode(cv2.imencode(".bmp", picture)[1], cv2.IMREAD_UNCHANGED)
    assert pixels_of(again) == pixels_of(picture)


@pytest.mark.parametrize("place", [(0, 0), (3, 5), (8, 63), (47, 63)])
def test_one_grey_level_in_any_row_makes_another_picture(picture, place):
    other = picture.copy()
    other[place] ^= 1
    assert pixels_of(other) != pixels_of(picture)


def test_the_same_levels_of_another_size_or_depth_are_another_picture(picture):
    assert pixels_of(picture.reshape(64, 48)) != pixels_of(picture)
    assert pixels_of(picture.view(np.uint16)) != pixels_of(picture)


def test_pictures_without_any_noise_are_not_taken_for_one():
    black = np.zeros((48, 64), np.uint8)
    repeats = Repeats()
    assert [repeats.is_repeat(pixels_of(black)) for _ in range(2)] == [False, False]


def test_a_pose_is_there_again_if_one_of_its_two_pictures_is():
    repeats = Repeats()
    assert not repeats.is_repeat(b"on", b"off")
    assert not repeats.is_repeat(b"other on", b"other off")
    assert repeats.is_repeat(b"third on", b"off")
