import numpy as np
import pytest

from core.scan.known_planes.known_plane import Control, KnownPlane
from core.scan.plane_check import check_by_planes
from core.scan.reconstruct import reconstruct
from core.simulate.scenario import Scenario
from tests.scan.centreline_scan import ExactScan

SD_MM = 0.005
"""How well the plate's place is known, and its tilts over 100 mm."""


@pytest.fixture(scope="module")
def exact():
    return ExactScan.of(Scenario(scale=0.5, frames=30))


def plate(exact, name="plate", *, off_mm=0.0):
    """A part of the table as a known plane, `off_mm` farther away than it is."""
    normal, point = (np.array(exact.figures[f"table_{one}"]) for one in ("normal", "point"))
    pi = normal / (normal @ point)
    size = np.linalg.norm(pi)
    factor = SD_MM * size * np.column_stack([pi, [0.01, 0, 0], [0, 0.01, 0]])
    width, height = exact.rig.camera.image_size
    outline = np.array([[0.55, 0.05], [0.98, 0.05], [0.98, 0.95], [0.55, 0.95]]) * [width, height]
    none = np.zeros((3, 3))
    return KnownPlane(name, pi / (1 + off_mm * size), outline, factor @ factor.T, none, np.zeros((3, 10)))


def checked(exact, plane):
    camera, fan = exact.rig.camera, exact.rig.fan
    scan = reconstruct(exact.measured(1), camera, fan, planes=[plane])
    assert scan.planes[0].points > 100
    return check_by_planes(scan, camera, Control(fan, (plane,)), [])


def test_a_board_where_it_is_passes(exact):
    found = checked(exact, plate(exact))
    assert found.passed
    assert found.note.code == "scan.checked_by_planes"
    assert abs(found.planes[0].mm) < 0.03


def test_a_board_off_by_a_fifth_of_a_millimetre_is_told_with_its_size(exact):
    found = checked(exact, plate(exact, off_mm=0.2))
    assert not found.passed
    assert found.note.code == "scan.planes_disagree"
    assert abs(found.planes[0].mm) == pytest.approx(0.2, abs=0.06)
