"""Other light than the laser's, on the plate and beside it, does not count as its stripes."""

import numpy as np
import pytest

from core.calibrate.fan.calibration import FanOptions, fit_fan
from core.calibrate.fan.poses.plane_pose import measure_plane_pose
from core.calibrate.fan.poses.plate import Plate
from core.calibrate.fan.poses.stripe_lines import straight_lines
from core.image.stripes.centreline import Centreline
from core.image.targets import BlackSquare, Checkerboard
from core.image.targets.target_view import TargetView
from core.model import Pose
from tests.calibrate import fan_scenes
from tests.calibrate.fan.poses.test_plane_pose import CAMERA, POSE, TARGET, Pair, misses_px, render
from tests.calibrate.fan.test_calibration import worst_mm
from tests.calibrate.fan_scenes import ALPHA, PAPER

U, V = np.meshgrid(np.arange(CAMERA.image_size[0]), np.arange(CAMERA.image_size[1]))


def band(start: tuple[float, float], end: tuple[float, float], sigma: float, height: float) -> np.ndarray:
    """A stripe between two points, its ends sharp."""
    along = np.subtract(end, start)
    length = np.hypot(*along)
    along = along / length
    at = np.stack([U, V], axis=-1) - start
    across = at @ [-along[1], along[0]]
    place = at @ along
    return np.where((place > 0) & (place < length), height * np.exp(-0.5 * (across / sigma) ** 2), 0.0)


def cluttered(pair: Pair, pose: Pose, seed: int) -> Pair:
    """A plate on a bright bench: moved cables beside it in the fan's picture; on it specks, a faint line and a glow."""
    rays = CAMERA.rays(np.column_stack([U.ravel(), V.ravel()]).astype(float))
    normal = pose.rotation[:, 2]
    points = rays * (normal @ pose.translation / (rays @ normal))[:, None]
    off_centre = np.abs(((points - pose.translation) @ pose.rotation)[:, :2] - 30.0).max(axis=1).reshape(U.shape)
    bench = np.where(off_centre > 82.0, 60.0, 0.0)
    rng = np.random.default_rng(seed)
    middle = CAMERA.project_pose(pose, [[30.0, 30.0, 0.0]])[0]
    bottom, right = V.max(), U.max()
    light = band((20, bottom - 12), (right - 20, bottom - 6), 1.6, 110.0)
    for reach in (100, 130, 160):
        light += 90 * np.exp(-0.5 * ((np.hypot(U, V) - reach) / 1.5) ** 2)
        light += 90 * np.exp(-0.5 * ((np.hypot(U - right, V - bottom) - reach) / 1.5) ** 2)
    light *= off_centre > 84.0
    light += band((middle[0] - 90, middle[1] - 80), (middle[0] + 90, middle[1] + 75), 1.5, 9.0)
    light += band((middle[0] + 60, middle[1] - 90), (middle[0] + 75, middle[1] + 90), 9.0, 40.0)
    for _ in range(60):
        start = middle + rng.uniform(-110, 110, 2)
        turn = rng.uniform(0, np.pi)
        light += band(start, start + rng.uniform(10, 30) * np.array([np.cos(turn), np.sin(turn)]), 1.3, 12.0)
    on, off = (
        np.clip(np.round(picture), 0, 255).astype(np.uint8) for picture in (pair.on + light + bench, pair.off + bench)
    )
    return Pair(on, off)


@pytest.mark.accuracy
@pytest.mark.parametrize("seed", [1, 2])
def test_clutter_adds_no_line_and_takes_none_away(seed):
    clean = render(POSE, seed=seed)
    spoilt = cluttered(clean, POSE, seed)
    alone = measure_plane_pose("p", clean.on, clean.off, TARGET, CAMERA)
    features = measure_plane_pose("p", spoilt.on, spoilt.off, TARGET, CAMERA)
    false = [line for line in features.centrelines if np.median(misses_px(type(features)("", None, (line,)))) > 1.5]
    assert len(false) <= 1
    assert len(straight_lines(features.centrelines, CAMERA)) <= 3
    found = sum(len(line) for line in features.centrelines) - sum(map(len, false))
    assert found > 0.9 * sum(len(line) for line in alone.centrelines)


@pytest.mark.accuracy
def test_planes_from_cluttered_pictures_are_those_of_clean_ones():
    features = []
    for number, pose in enumerate(fan_scenes.poses(4, 3)):
        pair = cluttered(render(pose, seed=10 + number), pose, number)
        features.append(measure_plane_pose(f"p{number}", pair.on, pair.off, TARGET, CAMERA))
    assert worst_mm(fit_fan(features, CAMERA, FanOptions(3, ALPHA)).fan.pis, PAPER) < 0.2


def view_of(target, points=None) -> TargetView:
    points = target.points if points is None else points
    return TargetView(
        points, CAMERA.project_pose(POSE, points), np.full(len(points), 0.02), placed=points is target.points
    )


def places(x_mm: float, y_mm: float) -> np.ndarray:
    return CAMERA.project_pose(POSE, [[x_mm, y_mm, 0.0]])


@pytest.mark.parametrize(("target", "edge_mm"), [(BlackSquare(60.0), 60.0), (Checkerboard(9, 7, 10.0), 90.0)])
def test_the_plate_ends_at_its_margin(target, edge_mm):
    plate = Plate(target, view_of(target), CAMERA, 20.0)
    assert plate.contains(places(edge_mm + 19.0, 10.0)).all()
    assert not plate.contains(places(edge_mm + 21.0, 10.0)).any()
    unstated = Plate(target, view_of(target), CAMERA, None)
    assert unstated.contains(places(edge_mm + 9.0, 10.0)).all()


def test_a_part_of_a_board_may_be_any_part_of_it():
    board = Checkerboard(9, 7, 10.0)
    part = board.points.reshape(7, 9, 3)[:, :5].reshape(-1, 3).copy()
    plate = Plate(board, view_of(board, part), CAMERA, 5.0)
    for x in (-45.0, 85.0):
        assert plate.contains(places(x, 10.0)).all()
    assert not plate.contains(places(10.0, 80.0)).any()


def test_what_is_outside_the_plate_is_not_looked_at():
    plate = Plate(TARGET, view_of(TARGET), CAMERA, None)
    outside = plate.outside((CAMERA.image_size[1], CAMERA.image_size[0]))
    uv = np.column_stack([U.ravel(), V.ravel()]).astype(float)
    held = plate.contains(uv).reshape(U.shape)
    assert not (outside & held).any()
    assert 0 < outside.mean() < 1


@pytest.mark.parametrize(("correlation_px", "lines"), [(4.3, 1), (8.0, 0)])
def test_two_short_pieces_of_a_narrow_line_are_a_line(correlation_px: float, lines: int) -> None:
    """Of a stripe 1 px wide 43 points in two squares say as much as 80 of one twice as wide."""
    rng = np.random.default_rng(5)
    pieces = []
    for start, count in ((200.0, 21), (300.0, 22)):
        along = np.arange(count, dtype=float)
        uv = np.column_stack([start + along, 150.0 + 0.1 * (start + along) + rng.normal(0, 0.05, count)])
        uv = CAMERA.pixels(CAMERA.rays(uv)[:, :2])
        normal = np.tile([0.1, -1.0] / np.hypot(0.1, 1.0), (count, 1))
        one = np.ones(count)
        pieces.append(Centreline(uv, normal, 0.4 * one, 90 * one, 0.05 * one, one > 2, correlation_px))
    assert len(straight_lines(pieces, CAMERA)) == lines
