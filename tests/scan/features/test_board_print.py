"""Print of boards in a scan: where it is found, what hides it, and the fan's light beside it."""

import numpy as np
import pytest

from core.image.targets import Checkerboard, TargetNotFound
from core.scan.features.board_print import marks_on_board, without_marks
from core.scan.features.reference import FeatureOptions, read_reference
from tests.image.rendered_targets import Noise, checkers, pose, render, rig

CAMERA = rig(1 / 6)
BOARD = Checkerboard(8, 5, 10.0)


def shown(seed=0):
    return render(CAMERA, pose(-15, 35, 4, (35, 20), 420), checkers(8, 5, 10.0), noise=Noise(0.5, seed), blur=0.9)


PICTURE = shown()
MARKS = marks_on_board(BOARD, PICTURE, shown(1))


def with_line(picture, *, on=None):
    """The picture with a stripe of σ 1.5 px, 90 grey levels high, from side to side."""
    v, u = np.indices(picture.shape)
    light = 90 * np.exp(-((v - 60 - 0.1 * u) ** 2) / (2 * 1.5**2))
    return np.clip(picture * 0.4 + light * (picture / picture.max()), 0, 255).astype(np.uint8)


def test_marks_are_the_dark_squares_and_nothing_beyond_the_board():
    dark = 0.5 * np.quantile(PICTURE, 0.95) > PICTURE
    v, u = np.nonzero(MARKS)
    within = np.s_[v.min() : v.max() + 1, u.min() : u.max() + 1]
    assert 0.3 < MARKS[within].mean() < 0.8
    assert (MARKS & dark).sum() > 0.9 * dark[within].sum()
    assert not MARKS[:20].any() and not MARKS[-20:].any()


def test_marks_count_in_a_reference_exposed_otherwise_and_with_the_fans_light_in_it():
    found = marks_on_board(BOARD, PICTURE, with_line(PICTURE))
    assert (found & MARKS).sum() > 0.95 * MARKS.sum()


@pytest.mark.parametrize("grey", [15, 230])
def test_marks_that_a_part_covers_do_not_count(grey):
    v, u = np.nonzero(MARKS)
    covered = np.s_[v.min() - 40 : v.max() + 40, int(np.median(u)) : u.max() + 40]
    reference = shown(1)
    reference[covered] = grey
    found = marks_on_board(BOARD, PICTURE, reference)
    inner = np.zeros_like(MARKS)
    inner[:, int(np.median(u)) + 25 :] = True
    assert (found & inner).sum() < 0.05 * (MARKS & inner).sum(), "light on the part is to be looked at"
    left = np.zeros_like(MARKS)
    left[:, : int(np.median(u)) - 25] = True
    assert (found & left).sum() > 0.95 * (MARKS & left).sum()


def test_a_picture_without_the_board_is_refused():
    with pytest.raises(TargetNotFound):
        marks_on_board(BOARD, np.full_like(PICTURE, 120), PICTURE)


def test_nothing_is_looked_for_on_marks_and_the_fans_line_beside_them_is_found_as_it_is():
    reference = read_reference(with_line(PICTURE), FeatureOptions(marks=MARKS))
    assert 1.2 < reference.stripe.stripe_px < 1.9
    for line in reference.fan:
        at = np.rint(line.uv).astype(int)
        assert not MARKS[at[:, 1], at[:, 0]].any()
    assert max(len(line) for line in reference.fan) > 60


def test_without_marks_a_picture_is_even_there_and_the_same_elsewhere():
    even = without_marks(PICTURE.astype(np.float32), MARKS)
    assert np.array_equal(even[~MARKS], PICTURE[~MARKS])
    assert even[MARKS].min() > PICTURE[MARKS].mean()
    same = PICTURE.astype(np.float32)
    assert without_marks(same, None) is same
