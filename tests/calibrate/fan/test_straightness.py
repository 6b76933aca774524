"""Lines that are no planes of light: told with their direction, and uncertain by what was seen of it."""

import numpy as np
import pytest

from core.calibrate.deviations import calibration_deviations
from core.calibrate.fan.calibration import fit_fan
from core.calibrate.results import CameraCalibration, FanCalibration
from core.model import LightPlane
from tests.calibrate.fan.test_calibration import THREE
from tests.calibrate.fan_scenes import CAMERA, GRID, PAPER, Noise, features, poses

BOW = 5e-5
"""In 1/mm: 0.25 mm from the middle of a stripe to its ends."""


def fitted(bow: float, seed: int = 1) -> FanCalibration:
    return fit_fan(features(poses(9, seed), Noise(), seed, points=GRID, bow=bow), CAMERA, THREE)


def told(fan: FanCalibration) -> list:
    return [note for note in fan.notes if note.code in ("fan.lines_bent", "fan.lines_wavy")]


@pytest.mark.parametrize(("bow", "where"), [(BOW, "away from"), (-BOW, "towards")])
def test_bowed_lines_are_told_with_size_and_direction(bow, where):
    (note,) = told(fitted(bow))
    assert note.code == "fan.lines_bent"
    assert 0.15 < note.values["mm"] < 0.3
    assert note.values["rms"] > 3 * note.values["expected"]
    assert where in str(note)


@pytest.mark.accuracy
def test_lines_that_are_planes_are_not_accused():
    accused = [seed for seed in range(12) if told(fitted(0.0, seed))]
    assert len(accused) <= 1


def test_bowed_lines_are_not_taken_for_poses_that_scatter():
    assert not any(note.code == "fan.poses_scatter" for note in fitted(BOW).notes)


def test_the_deviation_of_bowed_light_is_where_the_light_truly_is():
    """On rays of stripes 540 mm away, plane and bend together meet the light; the plane alone is far off."""
    fan = fitted(BOW)
    known = CameraCalibration(CAMERA, np.zeros((10, 10)), (), 0.0, 0.0, 1.0, 1.0, 0.0)
    (bent,) = (one.fan for one in calibration_deviations(known, fan) if one.source == "bend")
    for line, pi in enumerate(PAPER):
        x = np.linspace(-45, 45, 13)
        lit = 1 + np.linalg.norm(pi) * BOW * x**2
        points = np.column_stack([x, (lit - pi[0] * x - pi[2] * 540.0) / pi[1], np.full(len(x), 540.0)])
        rays = CAMERA.rays(CAMERA.project(points))
        off = [
            1 / np.einsum("mi,mi->m", one.pis_at(np.full(len(rays), line), rays), rays) - points[:, 2]
            for one in (fan.fan, bent)
        ]
        assert np.abs(off[0]).max() > 4 * np.abs(off[1]).max()
        assert np.abs(LightPlane(pi).distances(points)).max() == pytest.approx(BOW * 45**2)
