"""The simulator of centrelines itself: its curves are where the light is, its noise is what it says."""

import numpy as np
import pytest

from core.simulate.scenario import Scenario
from tests.scan.centreline_scan import ExactScan, Noise


@pytest.fixture(scope="module")
def exact():
    return ExactScan.of(Scenario(scale=0.5, frames=24))


def test_the_light_lies_on_its_planes_and_on_the_faces(exact):
    camera, up = exact.rig.camera, exact.scene.pose_cam_table.rotation[:, 2]
    heights = set()
    for pi, curves in zip(exact.pis, exact.sweeps, strict=True):
        for curve in curves:
            assert 1 / (camera.rays(curve.uv) @ pi) == pytest.approx(curve.points[:, 2], abs=1e-6)
            height = (curve.points - exact.scene.pose_cam_table.translation) @ up
            assert np.ptp(height) < 1e-6 or np.ptp(height) > 1  # level faces, or walls
            heights.add(round(float(height.mean()), 3))
    assert {0.0, 50.0} <= heights


def test_the_fan_lights_table_and_block_with_every_line(exact):
    for line in range(3):
        faces = [curve.face for curve, of in zip(exact.fan, exact.fan_line, strict=True) if of == line]
        assert len(faces) >= 3
        assert len(set(faces)) == 2


def test_the_same_seed_gives_the_same_scan(exact):
    a, b, c = (exact.measured(seed) for seed in (1, 1, 2))
    assert np.array_equal(a.crossings.uv, b.crossings.uv)
    assert not np.array_equal(a.fan[0].uv, c.fan[0].uv)


def test_noise_is_as_large_and_as_long_as_stated(exact):
    noise = Noise(0.1, 0.05, 8.0)
    curve = max(exact.fan, key=lambda one: len(one.uv))
    rng = np.random.default_rng(1)
    off = np.array([((curve.measured(0.1, 8.0, rng).uv - curve.uv) * curve.normal).sum(axis=1) for _ in range(200)])
    assert off.std() == pytest.approx(0.1, rel=0.03)
    length = len(curve.uv)
    assert off.mean(axis=1).std() == pytest.approx(0.1 * np.sqrt(8.0 / length), rel=0.15)
    fan = exact.measured(1, noise, smoothed=False).fan
    assert {float(piece.sigma[0]) for piece in fan} == {0.05}


def test_an_object_that_moves_takes_its_light_with_it_and_leaves_the_table(exact):
    moved = ExactScan.of(Scenario(scale=0.5, frames=24), moved=(12, (0.0, 0.0, -0.3)))
    up, table = exact.scene.pose_cam_table.rotation[:, 2], exact.scene.pose_cam_table.translation
    for frame, curves in enumerate(moved.sweeps):
        heights = np.unique(np.round([float(((c.points - table) @ up).max()) for c in curves], 2))
        expected = 50.0 if frame < 12 else 50.0 - 0.3 * up[2]
        assert heights.max() in (0.0, pytest.approx(expected, abs=0.01))


@pytest.mark.parametrize("kind", ["sphere", "mask", "steps"])
def test_other_objects_are_lit_and_seen(kind):
    scan = ExactScan.of(Scenario(object=kind, scale=0.25, frames=3))
    camera = scan.rig.camera
    for pi, curves in zip(scan.pis, scan.sweeps, strict=True):
        assert curves
        for curve in curves:
            assert 1 / (camera.rays(curve.uv) @ pi) == pytest.approx(curve.points[:, 2], abs=0.05)
