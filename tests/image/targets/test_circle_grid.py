"""Circle grids against the analytic truth of rendered pictures, and in real ones."""

import cv2
import numpy as np
import pytest

from core.image.targets import CircleGrid, TargetNotFound, camera_shift, detect
from core.image.targets.ellipses import centre_shift, fit_dark_ellipses
from core.image.targets.target_view import OtherBoard
from tests.image.rendered_targets import Noise, circles, pose, render, rig
from tests.shared import REAL_SETS

GRID = CircleGrid(7, 7, 12.0)
CAMERA = rig(1 / 6)
STEEP = pose(-25, 40, 20, (36, 36), 380)
LINELIGHT = REAL_SETS / "linelight"


def nearest(view, true):
    """Errors (N, 2) of a view of a grid that may be numbered from another of its corners."""
    index = np.linalg.norm(view.uv[:, None] - true[None], axis=2).argmin(axis=1)
    assert len(set(index)) == len(view.uv)
    return view.uv - true[index]


@pytest.mark.parametrize("camera", [CAMERA, None], ids=["rays", "pixels"])
def test_centres_are_true_although_perspective_shifts_the_ellipses(camera):
    errors = nearest(
        detect(GRID, render(CAMERA, STEEP, circles(GRID.points, 3.5), noise=Noise(0.5)), camera=camera),
        CAMERA.project_pose(STEEP, GRID.points),
    )
    assert np.sqrt(np.mean(errors**2)) < 0.015
    assert np.abs(errors.mean(axis=0)).max() < 0.005


def test_the_shift_of_an_ellipse_is_that_of_the_middle_of_its_widest_chord():
    homography = np.array([[900.0, 20.0, 300.0], [-30.0, 700.0, 200.0], [0.2, 0.35, 1.0]])
    centre, radius = np.array([[0.3, -0.2]]), 0.15
    angle = np.linspace(0, 2 * np.pi, 20001)
    rim = centre + radius * np.column_stack([np.cos(angle), np.sin(angle)])
    image = np.column_stack([rim, np.ones(len(rim))]) @ homography.T
    image = image[:, :2] / image[:, 2:]
    middle = (image.min(axis=0) + image.max(axis=0)) / 2  # of the box around an ellipse: its centre
    true = np.append(centre[0], 1.0) @ homography.T
    assert centre_shift(homography, centre, radius)[0] == pytest.approx(middle - true[:2] / true[2], abs=1e-4)


def test_an_asymmetric_grid_is_found_in_its_order():
    grid = CircleGrid(4, 11, 8.0, asymmetric=True)
    where = pose(10, -15, 92, (28, 40), 420)
    view = detect(grid, render(CAMERA, where, circles(grid.points, 3.0), noise=Noise(1)))
    assert np.abs(view.uv - CAMERA.project_pose(where, grid.points)).max() < 0.06


def test_a_circle_under_a_stripe_is_kept_true_or_left_out():
    picture = render(CAMERA, STEEP, circles(GRID.points, 3.5), noise=Noise(0.5), stripes=[(0.3, 1, 330, 1.5, 150)])
    view = detect(GRID, picture)
    assert len(view.uv) >= 40
    assert np.abs(nearest(view, CAMERA.project_pose(STEEP, GRID.points))).max() < 0.15


def test_a_grid_of_another_size_or_a_part_of_it_is_named():
    picture = render(CAMERA, STEEP, circles(GRID.points, 3.5), samples=3)
    with pytest.raises(OtherBoard, match="shows 7 × 7 circles, not 6 × 6") as told:
        detect(CircleGrid(6, 6, 12.0), picture)
    assert told.value.counted == (7, 7)
    with pytest.raises(OtherBoard, match="shows 7 × 7 circles, not 8 × 7"):
        detect(CircleGrid(8, 7, 12.0), picture)
    with pytest.raises(TargetNotFound, match="round dark spots are seen, but no 7 × 7 grid"):
        detect(GRID, np.ascontiguousarray(picture[:, :330]))


@pytest.mark.parametrize(("columns", "rows"), [(4, 10), (5, 11), (4, 12)])
def test_a_moved_grid_counted_wrongly_is_counted(columns, rows):
    grid = CircleGrid(4, 11, 8.0, asymmetric=True)
    picture = render(CAMERA, pose(10, -15, 92, (28, 40), 420), circles(grid.points, 3.0), noise=Noise(1))
    with pytest.raises(OtherBoard) as told:
        detect(CircleGrid(columns, rows, 8.0, asymmetric=True), picture)
    assert told.value.counted == (4, 11)


@pytest.mark.parametrize("cut", [-40, -30, -20, -15, -5])
def test_a_grid_that_goes_on_beyond_the_picture_is_not_counted(cut):
    facing = pose(0, 0, 0, (36, 36), 380)
    picture = render(CAMERA, facing, circles(GRID.points, 3.5), samples=3)
    last = round(float(CAMERA.project_pose(facing, GRID.points[6:7])[0, 0]))
    with pytest.raises(TargetNotFound, match="round dark spots are seen, but no 7 × 7 grid"):
        detect(GRID, np.ascontiguousarray(picture[:, : last + cut]))


@pytest.mark.accuracy
@pytest.mark.skipif(not LINELIGHT.is_dir(), reason="the real pictures of linelight are not on this machine")
def test_linelight_is_found_in_all_poses_with_the_laser_on_and_off():
    grid = CircleGrid(7, 7, 37.5)
    uv = []
    for k in range(12):
        off = cv2.imread(str(LINELIGHT / "calib_picture" / f"calib{k}.jpg"), cv2.IMREAD_GRAYSCALE)
        on = cv2.imread(str(LINELIGHT / "light_picture" / f"light{k}.jpg"), cv2.IMREAD_GRAYSCALE)
        view = detect(grid, off, f"calib{k}.jpg")
        assert len(view.uv) == 49
        assert camera_shift(view, detect(grid, on, f"light{k}.jpg")) < 0.05
        uv.append(view.uv.astype(np.float32))
    rms, matrix, *_ = cv2.calibrateCamera([grid.points.astype(np.float32)] * 12, uv, (1920, 1080), None, None)
    assert rms < 0.0986  # what OpenCV's blob centres give
    assert matrix[[0, 1], [0, 1]] == pytest.approx([1144.4393, 1142.4883], abs=1.5)


def test_outlines_found_together_are_those_found_each_alone_and_a_hidden_one_spoils_no_other():
    picture = render(CAMERA, STEEP, circles(GRID.points, 3.5), noise=Noise(0.5))
    centres = CAMERA.project_pose(STEEP, GRID.points)
    radii = np.linspace(6.0, 9.0, len(centres))  # true are some 7.7 px: each finds its own way there
    hidden = 24
    u, v = centres[hidden].astype(int)
    picture[v - 9 : v + 10, u - 9 : u + 10] = 120
    together = fit_dark_ellipses(picture, centres, radii)
    assert [ellipse is None for ellipse in together] == [index == hidden for index in range(len(centres))]
    for index in (0, 20, 48):
        (alone,) = fit_dark_ellipses(picture, centres[[index]], radii[[index]])
        assert together[index].centre == pytest.approx(alone.centre, abs=1e-9)
        assert together[index].shape @ together[index].shape.T == pytest.approx(alone.shape @ alone.shape.T, abs=1e-8)
        assert together[index].sigma == pytest.approx(alone.sigma, rel=1e-9)
