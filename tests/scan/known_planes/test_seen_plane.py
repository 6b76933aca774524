"""Planes of boards from pictures of them: which are used, how well they are known, and what is told of the others."""

import numpy as np
import pytest

from core.calibrate.board_shape import TRUE
from core.image.targets import Checkerboard, Rectangle
from core.scan.known_planes.seen_plane import LEAST_SHIFT_MM, BoardOf, seek_plane
from tests.image.rendered_targets import Noise, checkers, pose, rectangle, render, rig

CAMERA = rig(1 / 6)
BOARD = BoardOf("wall", Checkerboard(8, 5, 10.0), TRUE)
RECTANGLE = Rectangle(80.0, 50.0)
GREY = np.full((458, 640), 120, np.uint8)


def shown(turned_deg=0.0, *, seed=0):
    """The board, 90 × 60 mm, at a tilt, and turned by so much more about its middle."""
    where = pose(-15, 45 + turned_deg, 4, (35, 20), 380)
    return render(CAMERA, where, checkers(8, 5, 10.0), noise=Noise(0.5, seed), blur=0.9)


def plane_of(*pictures):
    sought = seek_plane(BOARD, [(f"{k}.png", picture) for k, picture in enumerate(pictures)], CAMERA)
    assert sought.plane is not None, sought.notes
    return sought.plane


def test_pictures_that_agree_make_a_plane_better_known_as_their_number_says():
    alone, both = plane_of(shown(seed=1)), plane_of(shown(seed=1), shown(seed=2))
    assert both.pictures == 2
    assert np.trace(both.of_pose) < 0.8 * np.trace(alone.of_pose)


def test_pictures_that_disagree_by_what_does_no_harm_make_a_plane_known_as_badly_as_they_disagree():
    turned_deg = 0.07
    assert 45 * np.radians(turned_deg / 2) < LEAST_SHIFT_MM
    one, other = plane_of(shown(seed=1)), plane_of(shown(turned_deg, seed=2))
    both = plane_of(shown(seed=1), shown(turned_deg, seed=2))
    apart = one.pi - other.pi
    own = np.linalg.inv(np.linalg.inv(one.of_pose) + np.linalg.inv(other.of_pose))
    squares = apart @ np.linalg.solve(one.of_pose + other.of_pose, apart)
    assert squares > 9, "the pictures disagree surely"
    assert both.of_pose == pytest.approx(own * squares / 3, rel=1e-6)


def test_why_a_board_is_not_seen_is_told_of_every_picture_in_one_clean_sentence():
    sought = seek_plane(BOARD, [("a.png", GREY), ("b.png", np.zeros_like(GREY))], CAMERA)
    assert sought.plane is None
    assert [str(note) for note in sought.notes] == [
        "The board wall is not used: a.png: the picture is of one grey (levels 120 to 120); "
        "b.png: the picture is all black."
    ]
    (left_out,) = seek_plane(BOARD, [("a.png", GREY), ("b.png", shown())], CAMERA).notes
    assert str(left_out) == (
        "A picture of the board wall is not used: a.png: the picture is of one grey (levels 120 to 120)."
    )


@pytest.mark.parametrize("side", [0, 320])
def test_of_two_boards_that_look_alike_that_in_its_region_is_seen(side):
    places = {0: pose(10, 30, 5, (40, 25), 600, (-55, 0)), 320: pose(-20, -30, -8, (40, 25), 620, (60, 10))}
    both = np.minimum(*(render(CAMERA, where, rectangle(80.0, 50.0), blur=0.9) for where in places.values()))
    region = ((side, 0), (side + 320, 0), (side + 320, 458), (side, 458))
    sought = seek_plane(BoardOf("wall", RECTANGLE, TRUE, region_px=region), [("both.png", both)], CAMERA)
    assert sought.plane is not None, sought.notes
    where = places[side]
    assert sought.plane.pi @ where.translation == pytest.approx(1, abs=2e-3)


def test_a_region_outside_of_the_picture_is_told():
    region = ((700, 0), (900, 0), (900, 100))
    sought = seek_plane(BoardOf("wall", BOARD.target, TRUE, region_px=region), [("a.png", shown())], CAMERA)
    assert [str(note) for note in sought.notes] == [
        "The board wall is not used: a.png: the region to look in lies outside of the picture of 640 × 458 pixels."
    ]
