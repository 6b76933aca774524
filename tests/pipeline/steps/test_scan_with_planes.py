"""A scan solved with fan and known planes: which boards check the fan, which are left out of that, and what is told.

Exact light on the twin's objects, with noise; parts of the table are the boards.
"""

from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.results import NO_FAN, CameraCalibration, FanCalibration
from core.model import Fan
from core.pipeline.steps.scan.judgement import solved_scan
from core.pipeline.steps.workspace import Calibration
from core.progress import silent
from core.scan.known_planes.known_plane import KnownPlane
from core.scan.method import ReconstructOptions
from core.simulate.scenario import Scenario
from tests.scan.centreline_scan import ExactScan

SD_MM = 0.003
"""How well a board's place is known, and its tilts over 100 mm."""
RIGHT, LEFT = (0.60, 0.05, 0.98, 0.95), (0.02, 0.05, 0.35, 0.95)
UPPER_LEFT, LOWER_LEFT = (0.02, 0.05, 0.35, 0.50), (0.02, 0.50, 0.35, 0.95)
"""Parts of the picture: left, top, right, bottom."""


@pytest.fixture(scope="module")
def exact():
    return ExactScan.of(Scenario(scale=0.25, frames=40))


@pytest.fixture(scope="module")
def features(exact):
    return exact.measured(1)


def board(exact, name, place, *, off_mm=0.0, **known):
    """A part of the table that is seen at `place`, `off_mm` farther away than it is."""
    normal, point = (np.array(exact.figures[f"table_{one}"]) for one in ("normal", "point"))
    pi = normal / (normal @ point)
    size = np.linalg.norm(pi)
    factor = SD_MM * size * np.column_stack([pi, [0.01, 0, 0], [0, 0.01, 0]])
    left, top, right, bottom = place
    corners = np.array([[left, top], [right, top], [right, bottom], [left, bottom]]) * exact.rig.camera.image_size
    none = np.zeros((3, 3))
    return KnownPlane(name, pi / (1 + off_mm * size), corners, factor @ factor.T, none, np.zeros((3, 10)), **known)


def calibration(exact, *planes):
    fan = Fan(exact.rig.fan.planes, np.zeros((3 * exact.rig.fan.lines,) * 2))
    camera = CameraCalibration(exact.rig.camera, np.zeros((10, 10)), (), 0.1, 0.1, 1.0, 0.5, 0.01)
    known = FanCalibration(fan, fan, (), (), (), 0.0, None, None, (), scale_assumed=False, flatness_assumed=False)
    return Calibration(camera, known, planes)


def solved(features, calibration):
    return solved_scan(features, calibration, ReconstructOptions(), silent)


def used(found):
    assert found.calibration.planes == (), "none is tied to beside a fan"
    return [plane.name for plane in found.check.planes]


def codes(found):
    return [note.code for note in found.notes]


def test_boards_that_agree_are_used_and_are_the_check(exact, features):
    found = solved(features, calibration(exact, board(exact, "right", RIGHT), board(exact, "left", LEFT)))
    assert used(found) == ["right", "left"] and codes(found) == ["scan.checked_by_planes"]
    assert found.checked and found.disagreement is None


def test_a_board_that_no_sweep_meets_is_left_out_and_told(exact, features):
    nowhere = board(exact, "nowhere", (0.0, 0.0, 0.01, 0.01))
    found = solved(features, calibration(exact, board(exact, "right", RIGHT), nowhere))
    assert used(found) == ["right"]
    assert codes(found) == ["scan.board_not_met", "scan.checked_by_planes"]


def test_one_of_three_boards_that_is_off_is_left_out_alone(exact, features):
    off = board(exact, "off", RIGHT, off_mm=0.4)
    found = solved(
        features, calibration(exact, board(exact, "upper", UPPER_LEFT), board(exact, "lower", LOWER_LEFT), off)
    )
    assert used(found) == ["upper", "lower"]
    assert codes(found) == ["scan.board_off", "scan.checked_by_planes"]
    assert found.checked and found.disagreement is None


def test_a_single_board_that_is_off_leaves_the_fan_alone_and_proves_nothing(exact, features):
    found = solved(features, calibration(exact, board(exact, "off", RIGHT, off_mm=0.4)))
    assert codes(found) == ["scan.planes_disagree"]
    assert not found.checked and found.disagreement == found.notes[0]


@pytest.mark.parametrize("off_mm", [0.0, 20.0, -20.0])
def test_a_board_moves_no_number_of_the_scan_wherever_it_lies(exact, features, off_mm):
    alone = solved(features, calibration(exact))
    found = solved(features, calibration(exact, board(exact, "beside", RIGHT, off_mm=off_mm)))
    assert codes(found) == ["scan.planes_disagree" if off_mm else "scan.checked_by_planes"]
    assert np.array_equal(found.scan.pis, alone.scan.pis)
    assert np.array_equal(found.scan.covariance, alone.scan.covariance)
    assert np.array_equal(found.scan.crossing_weights, alone.scan.crossing_weights)


def test_light_on_a_part_before_the_board_does_not_count(exact, features):
    """In every sixth frame it lies on the part alone."""
    lit = board(exact, "right", RIGHT)
    frames = tuple(
        replace(one, centrelines=tuple(_aside(line, lit, 40.0) for line in one.centrelines)) if k % 6 == 0 else one
        for k, one in enumerate(features.frames)
    )
    found = solved(replace(features, frames=frames), calibration(exact, lit))
    assert codes(found) == ["scan.checked_by_planes"]
    assert found.scan.planes[0].left_out > 10


def _aside(line, plane, px):
    """The light of a line on a plane `px` aside, as something before it has it."""
    low, high = plane.outline.min(axis=0), plane.outline.max(axis=0)
    on = ((line.uv > low) & (line.uv < high)).all(axis=1)
    return replace(line, uv=line.uv + px * on[:, None] * line.normal)


def test_without_a_fan_only_boards_that_sweeps_meet_make_the_size_unconfirmed(exact):
    met, nowhere = board(exact, "met", RIGHT), board(exact, "nowhere", LEFT, scale_assumed=True)
    without_fan = replace(calibration(exact), fan=NO_FAN)
    assert without_fan.with_planes((met, nowhere)).fan.scale_assumed
    assert not without_fan.with_planes((met, nowhere)).with_planes((met,)).fan.scale_assumed
