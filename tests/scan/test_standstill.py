"""Scans during which the object moves: found from crossings between early and late frames alone, and mended."""

from functools import cache

import numpy as np
import pytest

from core.errors import InputError
from core.scan.features.frames import CrossingUse
from core.scan.reconstruct import reconstruct
from core.scan.records import MOVED_FRAME
from core.scan.standstill import SCORE_LIMIT, find_movement
from core.scan.sweeps.fan_lines import FanLines
from core.scan.sweeps.locate import numbered
from core.simulate.scenario import Scenario
from tests.scan.centreline_scan import ExactScan

ASIDE = (0.3, 0.0, 0.0)


@cache
def exact(kind, moved=None, scale=0.5):
    return ExactScan.of(Scenario(object=kind, scale=scale), moved=moved)


def movement(scan, seed):
    features = scan.measured(seed, smoothed=False)
    crossings, line = numbered(features.crossings, FanLines.settled_as(scan.fan_line))
    return find_movement(crossings, line, scan.rig.camera, scan.rig.fan)


@pytest.fixture(scope="module")
def moved():
    scan = exact("mask", (40, ASIDE), 0.35)
    return scan, reconstruct(scan.measured(2), scan.rig.camera, scan.rig.fan)


@pytest.mark.parametrize(
    "kind",
    [
        "block",
        *(
            pytest.param(kind, marks=pytest.mark.accuracy)
            for kind in ("mask", "narrow-block", "steps", "sphere", "plane")
        ),
    ],
)
def test_a_scan_at_rest_is_not_suspected(kind):
    assert movement(exact(kind), 1) is None


@pytest.mark.accuracy
@pytest.mark.parametrize(("kind", "frame"), [("mask", 15), ("mask", 45), ("sphere", 30)])
def test_a_shift_of_three_tenths_is_found_and_so_is_its_frame(kind, frame):
    found = movement(exact(kind, (frame, ASIDE)), 1)
    assert found is not None
    assert found.score > 2 * SCORE_LIMIT
    assert found.when == (frame - 1, frame)


@pytest.mark.accuracy
def test_the_larger_part_is_used_and_the_rest_says_why(moved):
    _, result = moved
    assert set(result.sweep_frames.tolist()) <= set(range(40))
    assert [frame.used for frame in result.frames[40:]] == [False] * 20
    assert {frame.reason for frame in result.frames[40:]} == {MOVED_FRAME}
    assert "moved between frame0039 and frame0040" in " ".join(map(str, result.notes))
    late = result.crossings.a >= 40
    assert np.all(result.crossing_reasons[late] == CrossingUse.MOVED)
    assert np.all(result.crossing_weights[late] == 0)
    assert dict(result.frames[50].left_out_reasons).keys() == {CrossingUse.MOVED}


def test_what_is_left_measures_as_well_as_a_scan_at_rest(moved):
    scan, result = moved
    swept = np.flatnonzero(result.cloud.sweep >= 0)
    rays = scan.rig.camera.rays(result.cloud.uv[swept])
    true = 1 / np.einsum("ni,ni->n", rays, scan.pis[result.cloud.frame[swept]])
    errors = result.cloud.points[swept, 2] - true
    assert np.median(np.abs(errors) / result.cloud.sigma[swept]) < 1.2


def test_too_little_left_is_refused_in_one_sentence():
    scan = ExactScan.of(Scenario(object="sphere", scale=0.5, frames=22), moved=(11, (0.3, 0.8, 0.0)))
    with pytest.raises(InputError, match="moved between frame0010 and frame0011, and too few frames are left"):
        reconstruct(scan.measured(1), scan.rig.camera, scan.rig.fan)


def test_a_lifted_block_gives_the_block_of_the_reference():
    """Two parallel planes shifted along their normal can not be told from other light planes, and need not be."""
    scan = exact("block", (30, (0.0, 0.0, -0.3)), 0.35)
    result = reconstruct(scan.measured(1), scan.rig.camera, scan.rig.fan)
    up, foot = scan.scene.pose_cam_table.rotation[:, 2], scan.scene.pose_cam_table.translation
    late = (result.cloud.frame >= 30) & (result.cloud.sweep >= 0)
    height = (result.cloud.points[late] - foot) @ up
    assert np.median(height[height > 40]) == pytest.approx(50.0, abs=0.08)  # of the reference, not 50.3


@pytest.mark.accuracy
def test_scans_at_rest_stay_far_below_the_limit():
    for kind in ("block", "steps", "sphere", "mask"):
        assert [movement(exact(kind), seed) for seed in (2, 3)] == [None] * 2
