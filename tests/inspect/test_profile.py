"""A new measurement in a section begins where the profile has something to measure."""

import numpy as np
import pytest

from core.inspect.profile import usual_stretches

POSITION = np.arange(0.25, 90.0, 0.5)


def noisy(height):
    return height + np.random.default_rng(0).normal(0, 0.01, len(height))


def test_two_levels_are_measured_the_lower_one_first_and_away_from_the_edge():
    height = np.where((POSITION > 20) & (POSITION < 50), 40.0, 0.0)
    (first, last), (second_first, second_last) = usual_stretches(POSITION, noisy(height))
    assert 50 < first < last < 90
    assert 22 < second_first < second_last < 48


def test_a_slanting_block_and_a_shadow_do_not_hide_the_levels():
    height = np.where(POSITION > 40, 20.0, 0.0) + 0.15 * POSITION
    lit = (POSITION < 33) | (POSITION > 40)
    low, high = usual_stretches(POSITION[lit], noisy(height[lit]))
    assert 0 < low[0] < low[1] < 33
    assert 40 < high[0] < high[1] < 90


def test_of_a_profile_in_one_piece_both_ends_are_taken_whatever_its_length():
    for scale in (0.2, 1.0):
        low, high = usual_stretches(scale * POSITION, noisy(0.0 * POSITION))
        length = scale * 90
        assert 0 < low[0] < low[1] < length / 2 < high[0] < high[1] < length


def test_a_profile_of_one_mean_is_none():
    with pytest.raises(ValueError, match="fewer than two"):
        usual_stretches(np.array([1.0]), np.array([0.0]))


def test_places_without_points_and_single_means_that_are_off_do_not_end_a_level():
    lit = (POSITION % 9 < 5) | (POSITION > 55)
    height = noisy(np.where(POSITION > 40, 20.0, 0.0))
    height[::23] += 0.4
    low, high = usual_stretches(POSITION[lit], height[lit])
    assert 0 < low[0] < 12 and 28 < low[1] < 40
    assert 40 < high[0] < 52 and 78 < high[1] < 90


def test_a_plate_on_either_side_of_a_narrow_block_is_one_level():
    block = (POSITION > 40) & (POSITION < 48)
    height = noisy(np.where(block, 20.0, 0.003 * POSITION))
    _, high = usual_stretches(POSITION, height)
    assert 40 < high[0] < high[1] < 48
