import cv2
import numpy as np
import pytest

from core.image.sharpness import edge_blur_px
from core.image.targets import Checkerboard, CircleGrid
from tests.image.rendered_targets import Noise, checkers, circles, pose, render, rig

PIXEL = np.sqrt(1 / 12)
"""σ of averaging over a pixel's area."""


def checkerboard(blur=0.7, **how):
    board, camera = Checkerboard(8, 6, 20.0), rig()
    where = pose(12, -8, 5, (70, 50), 600)
    return render(camera, where, checkers(8, 6, 20.0), blur=blur, **how), camera.project_pose(where, board.points)


@pytest.mark.parametrize("blur", [0.7, 1.5, 3.0])
@pytest.mark.parametrize("noise", [0.0, 3.0])
def test_the_blur_of_a_checkerboard_is_measured(blur, noise):
    assert edge_blur_px(*checkerboard(blur, noise=Noise(noise))) == pytest.approx(np.hypot(blur, PIXEL), rel=0.15)


@pytest.mark.parametrize("blur", [0.7, 2.0])
def test_the_blur_of_circles_is_measured(blur):
    grid, camera, where = CircleGrid(8, 6, 20.0), rig(), pose(10, 15, 0, (70, 50), 600)
    picture = render(camera, where, circles(grid.points, 6.0), blur=blur)
    assert edge_blur_px(picture, camera.project_pose(where, grid.points)) == pytest.approx(
        np.hypot(blur, PIXEL), rel=0.15
    )


@pytest.mark.parametrize("direction", [0, 45, 90])
def test_a_smear_in_any_direction_counts_as_blur(direction):
    picture, uv = checkerboard()
    smear = np.zeros((11, 11), np.float32)
    step = np.array([np.sin(np.radians(direction)), np.cos(np.radians(direction))])
    for t in np.linspace(-4, 4, 33):
        i, j = np.rint(5 + t * step).astype(int)
        smear[i, j] = 1
    assert edge_blur_px(cv2.filter2D(picture, -1, smear / smear.sum()), uv) > 1.6 * edge_blur_px(picture, uv)


def test_blur_of_16_bit_pictures_is_the_same():
    eight, uv = checkerboard()
    sixteen = eight.astype(np.uint16) * 256
    assert edge_blur_px(sixteen, uv) == pytest.approx(edge_blur_px(eight, uv), rel=0.03)


def test_an_empty_picture_has_no_edges():
    assert np.isnan(edge_blur_px(np.full((200, 200), 80, np.uint8), np.array([[100.0, 100.0]])))


def test_laser_lines_over_half_of_the_marks_do_not_pass_for_blur():
    v, u = np.mgrid[:300, :300].astype(np.float64)
    square = (abs(u - 150) < 60) & (abs(v - 150) < 60)
    plate = cv2.GaussianBlur(np.where(square, 10.0, 90.0), (0, 0), 1.2)
    marks = np.array([[90.0, 90.0], [210.0, 90.0], [210.0, 210.0], [90.0, 210.0]])
    assert edge_blur_px(plate, marks) == pytest.approx(1.2, rel=0.1)
    line = np.exp(-0.5 * ((v - 75 - 0.06 * (u - 150)) / 2.0) ** 2)
    assert edge_blur_px(plate + 1.5 * plate * line, marks) == pytest.approx(1.2, rel=0.15)
