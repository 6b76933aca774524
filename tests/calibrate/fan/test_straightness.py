"""Lines that are no planes of light: told with their direction, and uncertain by what was seen of it."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from core.calibrate.board_shape import TRUE, BoardTolerance
from core.calibrate.deviations import calibration_deviations
from core.calibrate.fan.calibration import fit_fan
from core.calibrate.results import CameraCalibration, FanCalibration
from core.model import LightPlane
from tests.calibrate.fan.test_calibration import THREE
from tests.calibrate.fan_scenes import CAMERA, GRID, PAPER, Noise, bowed, features, poses

BOW = 5e-5
"""In 1/mm: 0.25 mm from the middle of a stripe to its ends."""


@cache
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


SLIGHT = BOW / 3
"""A bow that a plate of usual flatness may have."""
UNSTATED = BoardTolerance()


@cache
def of_square(bow: float, seed: int = 1, target: BoardTolerance = UNSTATED) -> FanCalibration:
    """With a black square, whose corners do not tell whether its plate is bowed."""
    return fit_fan(features(poses(9, seed), Noise(), seed, bow=bow), CAMERA, replace(THREE, target=target))


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.accuracy)])
def test_a_bow_that_may_be_the_plates_or_the_lights_is_told(seed):
    """The plate's flatness is not stated: a bowed one explains the stripes, and then the light was called straight."""
    codes = {note.code for note in of_square(SLIGHT, seed).notes}
    assert "fan.bow_or_bend" in codes
    assert "fan.bow_or_bend" not in {note.code for note in of_square(0.0, seed).notes}
    assert "fan.bow_or_bend" not in {note.code for note in of_square(SLIGHT, seed, TRUE).notes}


def test_a_plate_whose_corners_show_it_bowed_is_not_blamed_on_the_laser():
    seen = features(poses(9, 5), Noise(), 5, points=GRID, shape=bowed(0.3, 0.3, 0.0))
    fan = fit_fan(seen, CAMERA, replace(THREE, target=BoardTolerance(0.3, 0.0)))
    assert "fan.bow_or_bend" not in {note.code for note in fan.notes}
    assert fan.bends is None


def off_light(fan: FanCalibration, bow: float) -> list[tuple[np.ndarray, np.ndarray]]:
    """For each line what its plane, and plane and bend together, are off the light in mm, on stripes 540 mm away."""
    known = CameraCalibration(CAMERA, np.zeros((10, 10)), (), 0.0, 0.0, 1.0, 1.0, 0.0)
    (bent,) = (one.fan for one in calibration_deviations(known, fan) if one.source == "bend")
    found = []
    for line, pi in enumerate(PAPER):
        x = np.linspace(-45, 45, 13)
        lit = 1 + np.linalg.norm(pi) * bow * x**2
        points = np.column_stack([x, (lit - pi[0] * x - pi[2] * 540.0) / pi[1], np.full(len(x), 540.0)])
        assert np.abs(LightPlane(pi).distances(points)).max() == pytest.approx(bow * 45**2)
        rays = CAMERA.rays(CAMERA.project(points))
        plane, both = (
            1 / np.einsum("mi,mi->m", one.pis_at(np.full(len(rays), line), rays), rays) - points[:, 2]
            for one in (fan.fan, bent)
        )
        found.append((plane, both))
    return found


def test_the_deviation_of_bowed_light_is_where_the_light_truly_is():
    """Plane and bend together meet the light; the plane alone is far off."""
    for plane, both in off_light(fitted(BOW), BOW):
        assert np.abs(plane).max() > 4 * np.abs(both).max()


def test_so_it_is_where_a_bowed_plate_was_taken_for_it():
    """Its bend; how far off and tilted it is all at once is the noise of four corners, which the covariance holds."""
    for plane, both in off_light(of_square(SLIGHT), SLIGHT):
        bends = [np.polyfit(np.arange(len(off)), off, 2)[0] for off in (plane, both)]
        assert abs(bends[0]) > 4 * abs(bends[1])
