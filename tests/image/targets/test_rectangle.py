"""Printed rectangles, dark throughout and outlined, against the analytic truth of rendered pictures."""

import math

import numpy as np
import pytest

from core.image.targets import Rectangle, TargetNotFound, detect, estimate_pose
from core.image.targets.rectangle import blur_reach
from tests.image.rendered_targets import Noise, pose, rectangle, render, rig

CAMERA = rig(1 / 6)
SIZE = (80.0, 50.0)
POSES = {
    "frontal": pose(0, 0, 3, (40, 25), 400),
    "tilted": pose(30, -12, 12, (40, 25), 380, (20, -15)),
    "steep": pose(-20, 40, -30, (40, 25), 400),
    "upright": pose(15, 10, 80, (40, 25), 400),
}


def shown(where, line, **how):
    return render(CAMERA, where, rectangle(*SIZE, line), **({"blur": 0.9} | how))


def error_of(view, where, target):
    """Against the true corners; a rectangle looks the same turned by half a turn."""
    true = CAMERA.project_pose(where, target.points)
    turned = np.concatenate([np.roll(true[k : k + 4], 2, axis=0) for k in range(0, len(true), 4)])
    return min((view.uv - true, view.uv - turned), key=lambda error: np.abs(error).max())


@pytest.mark.parametrize("line", [0.0, 10.0, 4.0, 2.0])
def test_errors_of_the_corners_are_as_large_as_stated(line):
    """A line of 2 mm is three pixels wide: its edges reach across it."""
    target, square, count = Rectangle(*SIZE, line), 0.0, 0
    for seed, where in enumerate(POSES.values()):
        view = detect(target, shown(where, line, noise=Noise(3, seed), samples=5), camera=CAMERA)
        error = error_of(view, where, target)
        assert np.abs(error).max() < 0.1
        assert np.diag(view.covariance).reshape(-1, 2).mean(axis=1) == pytest.approx(view.sigma**2)
        square, count = square + (view.whitened(error) ** 2).sum(), count + error.size
    assert 0.6 < math.sqrt(square / count) < 1.3


def test_an_outline_thin_beside_its_blur_looks_wider_evenly_so_its_pose_is_true():
    where, target = POSES["tilted"], Rectangle(*SIZE, 1.0)
    view = detect(target, shown(where, 1.0), camera=CAMERA)
    error = error_of(view, where, target)
    assert np.abs(error).max() > 0.1
    assert (view.whitened(error) ** 2).mean() < 3
    assert np.linalg.norm(estimate_pose(view, CAMERA).pose.translation - where.translation) < 60
    middle = error.reshape(2, 4, 2).mean(axis=0)
    assert np.abs(middle).max() < 0.25 * np.abs(error).max()


@pytest.mark.parametrize(("width", "blur"), [(2.0, 1.0), (3.0, 1.0), (6.0, 1.5), (9.0, 1.0)])
def test_how_far_a_lines_edges_reach_across_it_is_told_by_its_depth_and_slope(width, blur):
    x = np.linspace(-width / 2 - 6 * blur, width / 2 + 6 * blur, 100_001)
    edge = np.vectorize(lambda t: math.erf(t / blur / math.sqrt(2)) / 2)
    depth = edge(x + width / 2) - edge(x - width / 2)
    slope = np.gradient(depth, x)
    apart = x[slope.argmin()] - x[slope.argmax()]
    seen = depth.max() / (math.sqrt(2 * math.pi) * slope.max())
    assert blur_reach(apart, seen) == pytest.approx((apart - width) / 2, abs=1e-3)


def test_the_width_is_told_by_the_camera_where_perspective_turns_the_sides_lengths_over():
    where = pose(62, 0, 88, (40, 25), 420)
    picture = shown(where, 0.0)
    target = Rectangle(*SIZE)
    assert np.abs(error_of(detect(target, picture, camera=CAMERA), where, target)).max() < 0.1
    assert np.abs(error_of(detect(target, picture), where, target)).max() > 5
    true = CAMERA.project_pose(where, target.points) + 3.0
    given = Rectangle(*SIZE, corners_px=tuple((u, v) for u, v in true))
    assert np.abs(error_of(detect(given, picture), where, target)).max() < 0.5


def test_which_side_is_the_width_is_not_guessed_where_both_are_nearly_alike():
    where = pose(3, 2, 20, (20, 20), 700)
    picture = render(CAMERA, where, rectangle(40.01, 40.0), blur=0.9, noise=Noise(3))
    with pytest.raises(TargetNotFound, match="not which of its sides is the width; state its corners_px"):
        detect(Rectangle(40.01, 40.0), picture, camera=CAMERA)


@pytest.mark.parametrize("line", [0.0, 4.0])
def test_laser_stripes_hardly_move_the_corners(line):
    where, target = POSES["tilted"], Rectangle(*SIZE, line)
    stripes = [(0.15, 1, c, 1.5, 150) for c in (225, 250, 275)]
    view = detect(target, shown(where, line, stripes=stripes, noise=Noise(1)), camera=CAMERA)
    assert np.abs(error_of(view, where, target)).max() < 0.06


def test_of_two_alike_it_is_told_that_there_are_two_and_either_is_found_where_it_is_said_to_be():
    left, right = pose(10, 10, 5, (40, 25), 600, (-55, 0)), pose(-20, 15, -8, (40, 25), 620, (60, 10))
    for line in (0.0, 6.0):
        both = np.minimum(shown(left, line), shown(right, line))
        target = Rectangle(*SIZE, line)
        with pytest.raises(TargetNotFound, match=r"2 rectangles of like size are seen.*region_px, or corners_px"):
            detect(target, both, "wall.png", CAMERA)
        for where, region in ((left, (0, 320)), (right, (320, 640))):
            within = [(region[0], 0), (region[1], 0), (region[1], 458), (region[0], 458)]
            view = detect(target, both, camera=CAMERA, region_px=within)
            assert np.abs(error_of(view, where, target)).max() < 0.06
            near = CAMERA.project_pose(where, Rectangle(*SIZE).points) + [4.0, -4.0]
            given = Rectangle(*SIZE, line, tuple((u, v) for u, v in near))
            assert np.abs(error_of(detect(given, both, camera=CAMERA), where, target)).max() < 0.06


@pytest.mark.parametrize(
    ("target", "picture", "said"),
    [
        (Rectangle(*SIZE), np.full((300, 400), 180, np.uint8), "of one grey"),
        (Rectangle(*SIZE), render(CAMERA, POSES["frontal"], rectangle(*SIZE, 4.0)), "no dark rectangle on a light"),
        (Rectangle(*SIZE, 4.0), render(CAMERA, POSES["frontal"], rectangle(*SIZE)), "no rectangle outlined in dark"),
        (Rectangle(*SIZE, 0.5), render(CAMERA, POSES["frontal"], rectangle(*SIZE, 1.0)), "1.0 px wide in the picture"),
        (Rectangle(*SIZE, 6.0), render(CAMERA, POSES["frontal"], rectangle(*SIZE, 4.0)), "do not fit its size_mm"),
        (
            Rectangle(*SIZE),
            render(CAMERA, pose(0, 0, 3, (40, 25), 400, (-150, 0)), rectangle(*SIZE)),
            "only a part of the rectangle",
        ),
    ],
)  # fmt: skip
def test_what_a_wrong_picture_shows_is_told(target, picture, said):
    with pytest.raises(TargetNotFound, match=said):
        detect(target, picture, camera=CAMERA)
