"""Pictures that show no target: each gets its sentence."""

import cv2
import numpy as np
import pytest

from core.image.targets import BlackSquare, Charuco, Checkerboard, CircleGrid, TargetNotFound, detect

TARGETS = [Checkerboard(17, 12, 10.0), Charuco(9, 7, 10.0, 7.0), CircleGrid(7, 7, 12.0), BlackSquare(60.0)]
SHAPE = (1374, 1920)


def noise(levels):
    return np.random.default_rng(0).integers(*levels, SHAPE).astype(np.uint8)


@pytest.mark.parametrize("target", TARGETS, ids=lambda target: type(target).__name__)
@pytest.mark.parametrize(
    ("levels", "sentence"),
    [
        ((0, 4), "the picture is all black; expose longer"),
        ((252, 256), "the picture is all white; expose shorter"),
        ((100, 104), r"the picture is of one grey \(levels 100 to 103\)"),
    ],
    ids=["black", "white", "grey"],
)
def test_an_empty_picture_is_named_for_what_it_is(target, levels, sentence):
    with pytest.raises(TargetNotFound, match=f"view03.png: {sentence}"):
        detect(target, noise(levels), "view03.png")


def test_a_black_sixteen_bit_picture_is_black_and_a_twelve_bit_one_is_not():
    with pytest.raises(TargetNotFound, match="all black"):
        detect(TARGETS[3], noise((0, 100)).astype(np.uint16))
    with pytest.raises(TargetNotFound, match="no black square"):
        detect(TARGETS[3], noise((0, 256)).astype(np.uint16) * 16)


@pytest.mark.accuracy
@pytest.mark.parametrize("target", TARGETS, ids=lambda target: type(target).__name__)
def test_noise_and_blotches_hold_no_target(target):
    random = np.random.default_rng(1)
    blotches = cv2.GaussianBlur(random.normal(128, 1500, SHAPE), (0, 0), 12).clip(0, 255).astype(np.uint8)
    for picture in (random.normal(110, 25, SHAPE).clip(0, 255).astype(np.uint8), blotches):
        with pytest.raises(TargetNotFound, match=r"^view03.png: .*(no |No ).*;"):
            detect(target, picture, "view03.png")


def test_pictures_of_the_wrong_kind_are_a_programming_error():
    for picture in (np.zeros((5, 5, 3), np.uint8), np.zeros((5, 5)), np.zeros((0, 5), np.uint8)):
        with pytest.raises(ValueError, match="a picture must be"):
            detect(TARGETS[0], picture)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Checkerboard(2, 6, 10.0),
        lambda: Checkerboard(9, 6, 0.0),
        lambda: CircleGrid(7, 1, 5.0),
        lambda: BlackSquare(float("nan")),
    ],
)
def test_absurd_targets_are_refused(make):
    with pytest.raises(ValueError, match=r"at least|must be positive"):
        make()
