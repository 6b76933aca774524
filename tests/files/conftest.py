"""Results of every kind, made up, for the files that hold them."""

import numpy as np
import pytest

from core.calibrate.results import CameraCalibration, FanCalibration, PlanePose, ViewQuality
from core.image.targets.target_view import TargetView
from core.inspect.causes import cause_named
from core.inspect.results import Contribution, Face, GaugeResult
from core.messages import plain
from core.model import Camera, Fan, LightPlane, Pose
from core.scan.surface.cloud import FAN, Cloud


def square(rng, size, scale):
    root = rng.normal(size=(size, size)) * scale
    return root @ root.T


@pytest.fixture
def camera():
    matrix = np.array([[2495.1, 0.4 / 3, 960.2], [0, 2494.7, 687.1], [0, 0, 1]])
    rng = np.random.default_rng(0)
    view = TargetView(rng.normal(size=(6, 3)) * [50, 50, 0], rng.uniform(0, 900, (6, 2)), np.full(6, 0.03), "a.png")
    good = ViewQuality(
        view, Pose.from_vector([0.1, 0.2, 0.3, 1, 2, 600]), rng.normal(size=(6, 2)), 0.1, 0.09, 0.3, True,
        counted=np.array([True] * 5 + [False]),
    )  # fmt: skip
    lost = ViewQuality(
        TargetView(np.zeros((2, 3)), np.ones((2, 2)), np.ones(2), "b.png"),
        Pose.identity(), np.full((2, 2), np.nan), np.nan, np.nan, np.nan, False, plain("too few corners"),
    )  # fmt: skip
    return CameraCalibration(
        Camera((1920, 1374), matrix, np.array([-0.1, 0.09, 1e-4, -2e-4])),
        square(rng, 10, 0.1), (good, lost), 0.11, 0.09, 0.8, 0.7, np.nan, (plain("Tilt more."),),
    )  # fmt: skip


@pytest.fixture
def fan():
    rng = np.random.default_rng(1)
    planes = tuple(LightPlane(np.array([0.001 + 0.0002 * k, 0.0003, 0.0015])) for k in range(3))
    poses = (PlanePose("p1", Pose.identity(), 0.05, (np.zeros((4, 3)),), (np.zeros(4),), 0.02, True),)
    return FanCalibration(
        Fan(planes, square(rng, 9, 1e-8)), Fan(planes), (0.01, 0.02, 0.03), (0.087, 0.087), (0.086, 0.088), 0.02, True,
        plain("The constraint suits this laser."), poses, (plain("note"),),
    )  # fmt: skip


@pytest.fixture
def cloud():
    rng = np.random.default_rng(2)
    count = 50
    normals = rng.normal(size=(count, 3))
    return Cloud(
        points=rng.normal(size=(count, 3)) + [0, 0, 700],
        uv=rng.uniform(0, 900, (count, 2)),
        sigma=rng.uniform(0.01, 0.05, count),
        intensity=rng.uniform(0, 255, count),
        frame=np.arange(count) - 1,
        sweep=np.where(np.arange(count) % 2, np.arange(count), FAN - 2),
        normals=normals / np.linalg.norm(normals, axis=1)[:, None],
    )


@pytest.fixture
def gauge(cloud):
    def face(indices, depth):
        plane = LightPlane.from_normal([0, 0, 1.0], depth)
        return Face(plane, indices, -plane.distances(cloud.points[indices]), 0.03, 0.01)

    return GaugeResult(
        49.987, 0.012, 2.0, face(np.arange(20), 650.0), face(np.arange(25, 50), 700.0), 1e-4,
        (Contribution(cause_named("camera"), 0.01),), 50.0, 0.2,
        np.array([0, 0, 1.0]), plain("the rule"), (plain("a note"),),
        doubts=(),
    )  # fmt: skip
