"""Calibrations, and pictures without a target: processor time, as ratios to OpenCV."""

from __future__ import annotations

import cv2
import numpy as np

from core.calibrate.camera.calibration import calibrate_camera
from core.calibrate.fan.calibration import FanOptions, fit_fan
from core.calibrate.fan.poses.plane_pose import measure_plane_pose
from core.image.targets import Checkerboard, CircleGrid, TargetNotFound, detect
from tests.benchmarks.conftest import processor_ms, table
from tests.calibrate.camera_views import TRUTH, synthetic_views
from tests.calibrate.fan_scenes import ALPHA, CAMERA, GRID, features, poses
from tests.calibrate.fan_scenes import Noise as StripeNoise
from tests.image.rendered_targets import Noise, circles, pose, render, rig


def test_the_camera_from_fourteen_views(capsys):
    views = synthetic_views(15)
    points = [view.points.astype(np.float32) for view in views]
    seen = [view.uv.astype(np.float32) for view in views]
    ours = processor_ms(lambda: calibrate_camera(views, TRUTH.image_size), 2)
    theirs = processor_ms(lambda: cv2.calibrateCamera(points, seen, TRUTH.image_size, None, None), 2)
    rows = {
        "camera, with covariance and cross-validation": f"{ours / 1e3:6.2f} s",
        "OpenCV's calibrateCamera": f"{theirs / 1e3:6.2f} s   ({ours / theirs:.1f} x)",
    }
    table(capsys, "The camera from 14 views", rows)


def test_the_light_planes_from_121_poses(capsys):
    """121 pictures took 250 to 300 s of processor time once; 30 s are allowed."""
    seen = features(poses(121, 1), StripeNoise(), 1, points=GRID)
    few = features(poses(14, 1), StripeNoise(), 1, points=GRID)
    many_ms, few_ms = (
        processor_ms(lambda each=each: fit_fan(each, CAMERA, FanOptions(3, ALPHA)), 1) for each in (seen, few)
    )
    rows = {
        "121 poses": f"{many_ms / 1e3:6.2f} s   (allowed: 30 s; {many_ms / few_ms / 121 * 14:.1f} x for each pose)",
        "14 poses": f"{few_ms / 1e3:6.2f} s",
    }
    table(capsys, "The light planes", rows)


def test_the_pictures_of_121_poses_of_a_circle_grid(capsys):
    """Grid, stripe, and whether the grid stood still, in pairs of 640 × 458 px; of the 30 s that the step may take."""
    grid, camera = CircleGrid(7, 7, 12.0), rig(1 / 6)
    pairs = []
    for seed, (tilt, turn) in enumerate(((-25, 40), (10, -30), (35, 5), (-5, 15))):
        at = pose(tilt, turn, 20, (36, 36), 380)
        pairs.append(
            [
                render(camera, at, circles(grid.points, 3.5), noise=Noise(0.7, seed), stripes=stripes)
                for stripes in ([(0.3, 1, 330, 1.5, 150)], [])
            ]
        )
    for on, off in pairs[:1]:
        measure_plane_pose("first", on, off, grid, camera)

    def measure():
        for on, off in pairs:
            assert measure_plane_pose("pose", on, off, grid, camera).centrelines

    ours = processor_ms(measure, 2) / len(pairs)
    rows = {"121 pairs": f"{121 * ours / 1e3:6.2f} s   ({ours:.0f} ms each)"}
    table(capsys, "Pictures of a 7 × 7 circle grid with a laser line", rows)


TIMES_AS_LONG = 4.0
"""Of OpenCV's search for a board that is not there, at most; it was 13 times once."""


def test_a_picture_of_noise_without_a_board(capsys):
    random = np.random.default_rng(1)
    noise = random.normal(110, 25, (1374, 1920)).clip(0, 255).astype(np.uint8)
    board = Checkerboard(17, 12, 10.0)

    def search():
        try:
            detect(board, noise, "noise.png")
        except TargetNotFound:
            return
        raise AssertionError("a board in noise")

    ours = processor_ms(search, 1)
    theirs = processor_ms(lambda: cv2.findChessboardCornersSB(noise, (16, 11)), 1)
    rows = {
        "no board is known": f"{ours:6.0f} ms",
        "OpenCV's SB detector": f"{theirs:6.0f} ms   ({ours / theirs:.1f} x)",
    }
    table(capsys, "A picture of noise, 1920 × 1374 px", rows)
    assert ours < TIMES_AS_LONG * theirs
