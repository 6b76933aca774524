"""Whether the fan's stripes are skewed otherwise in a scan than in its calibration, and what that may do."""

from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.fan.calibration import FanOptions, fit_fan
from core.scan.changed_section import LEAST, ChangedSection, Section, changed_section
from tests.calibrate.fan_scenes import ALPHA, CAMERA, Noise, features, poses

SCATTER, GRAIN = 0.3, 20
"""Of a stripe's skewness, alike over so many points."""


@pytest.fixture(scope="module")
def seen():
    """The stripes of nine poses, and the fan by them."""
    found = features(poses(9, 2), Noise(), 2)
    return [pose.centrelines for pose in found], fit_fan(found, CAMERA, FanOptions(3, ALPHA)).fan


def skewed(lines, fan, skewness, rng, turned=False):
    """The lines with sections that reach away from the camera, and scatter; with `turned` normals."""
    found = []
    for line in lines:
        grains = rng.normal(skewness, SCATTER, len(line) // GRAIN + 1)
        away = -np.sign(
            np.einsum("i,nij,nj->n", fan.pis[1][:2], CAMERA.ray_jacobian(CAMERA.rays(line.uv)), line.normal)
        )
        line = replace(line, skewness=away * np.repeat(grains, GRAIN)[: len(line)])
        found.append(replace(line, normal=-line.normal, skewness=-line.skewness) if turned else line)
    return tuple(found)


def judged(seen, then, now, seed, turned=False):
    poses, fan = seen
    rng = np.random.default_rng(seed)
    calibrated = [skewed(lines, fan, skewness, rng) for lines, skewness in zip(poses, then, strict=True)]
    return changed_section(calibrated, skewed(poses[0] + poses[1], fan, now, rng, turned), CAMERA, fan)


@pytest.mark.parametrize("seeds", [range(8), pytest.param(range(8, 40), marks=pytest.mark.accuracy)])
def test_what_calibration_and_scan_have_in_common_is_no_change(seen, seeds):
    for seed in seeds:
        assert judged(seen, [0.4] * 9, 0.4, seed) is Section.SAME


@pytest.mark.parametrize("turned", [False, True])
def test_stripes_that_reach_further_to_one_side_than_then_are_told_whichever_way_their_normals_point(seen, turned):
    found = judged(seen, [0.1] * 9, 0.5, 1, turned)
    assert found.skewness == pytest.approx(0.5, abs=4 * found.error)
    assert found.then == pytest.approx(0.1, abs=4 * found.error)
    width = np.median([line.width.mean() for line in seen[0][0]])
    assert found.shift_px == pytest.approx(0.8 * np.cbrt(0.4) * width, rel=0.1)
    assert found.note.code == "scan.section_changed"


def test_what_the_poses_differ_by_among_themselves_is_chance(seen):
    rng = np.random.default_rng(3)
    then = rng.normal(0, 0.2, 9)
    assert judged(seen, then, 0.3, 4) is Section.SAME
    assert isinstance(judged(seen, [0.0] * 9, 0.3, 4), ChangedSection)


def test_a_change_too_small_to_matter_is_no_change(seen):
    assert judged(seen, [0.0] * 9, 0.5 * LEAST, 5) is Section.SAME


def test_of_a_few_poses_it_is_not_known(seen):
    poses, fan = seen
    assert changed_section(poses[:2], poses[0], CAMERA, fan) is Section.NOT_KNOWN
    assert changed_section([], poses[0], CAMERA, fan) is Section.NOT_KNOWN
    assert changed_section(poses, (), CAMERA, fan) is Section.NOT_KNOWN


def test_the_displaced_fan_is_that_of_stripes_half_as_far_aside_as_they_may_be(seen):
    poses, fan = seen
    found = judged(seen, [0.0] * 9, 0.5, 6)
    lines = poses[0] + poses[1]
    displaced = found.deviation(lines, CAMERA, fan)
    assert displaced.source == "skewed fan"
    assert displaced.camera is CAMERA
    for line in lines:
        moved = replace(line, uv=line.uv + found.shift_px / 2 * line.normal)
        rays, there = (CAMERA.rays(each.uv) for each in (line, moved))
        by_picture = np.abs((there - rays) @ fan.pis[1])
        by_plane = np.abs(rays @ (displaced.fan.pis[1] - fan.pis[1]))
        assert by_plane == pytest.approx(by_picture, rel=0.3)
