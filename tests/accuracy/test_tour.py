"""The simulated tour, done as the window guides, in its true size: right, sure and conforming."""

import pytest

from tests.accuracy.tour import ends_well, is_enough, tour, tour_row


@pytest.mark.accuracy
@pytest.mark.parametrize("seed", [1])
def test_the_tour_ends_right_sure_and_conforming(seed, tmp_path):
    """Of 20 seeds with `python -m tests.accuracy tour`."""
    one = tour(seed, tmp_path)
    assert ends_well(one), tour_row(one)
    assert one["doubts"] == []


def test_an_event_without_a_picture_ends_no_recording():
    assert not is_enough(None)
