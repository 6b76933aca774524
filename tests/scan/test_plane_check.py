import numpy as np
import pytest
from scipy.special import chdtri

from core.calibrate.change import changes
from core.scan.known_planes.known_plane import Control, KnownPlane
from core.scan.known_planes.plane_deviations import followed_by_planes
from core.scan.plane_check import DISAGREES, SEES, _told, check_by_planes
from core.scan.plane_points import with_plane_points
from core.scan.reconstruct import reconstruct
from core.simulate.scenario import Scenario
from tests.scan.centreline_scan import ExactScan

SD_MM = 0.005
"""How well the plate's place is known, and its tilts over 100 mm."""


@pytest.fixture(scope="module")
def exact():
    return ExactScan.of(Scenario(scale=0.5, frames=30))


def plate(exact, name="plate", *, off_mm=0.0, sd_mm=SD_MM):
    """A part of the table as a plane known to `sd_mm`, `off_mm` farther away than it is."""
    normal, point = (np.array(exact.figures[f"table_{one}"]) for one in ("normal", "point"))
    pi = normal / (normal @ point)
    size = np.linalg.norm(pi)
    factor = sd_mm * size * np.column_stack([pi, [0.01, 0, 0], [0, 0.01, 0]])
    width, height = exact.rig.camera.image_size
    outline = np.array([[0.55, 0.05], [0.98, 0.05], [0.98, 0.95], [0.55, 0.95]]) * [width, height]
    none = np.zeros((3, 3))
    return KnownPlane(name, pi / (1 + off_mm * size), outline, factor @ factor.T, none, np.zeros((3, 10)))


def checked(exact, plane):
    camera, fan = exact.rig.camera, exact.rig.fan
    features = exact.measured(1)
    scan, control = with_plane_points(reconstruct(features, camera, fan), features, camera, Control(fan, (plane,)))
    assert scan.planes[0].points > 100
    return check_by_planes(
        scan, camera, control, [], followed_by_planes(changes(camera, fan), camera, control, scale_sd=0.0)
    )


def test_a_board_where_it_is_passes(exact):
    found = checked(exact, plate(exact))
    assert found.passed, found.sees
    assert found.note.code == "scan.checked_by_planes"
    assert abs(found.planes[0].mm) < 0.03


def test_a_board_off_by_a_fifth_of_a_millimetre_is_told_with_its_size(exact):
    found = checked(exact, plate(exact, off_mm=0.2))
    assert not found.passed
    assert found.note.code == "scan.planes_disagree"
    assert abs(found.planes[0].mm) == pytest.approx(0.2, abs=0.06)


@pytest.mark.parametrize("sd_mm", [0.5, 5.0])
def test_a_board_that_is_hardly_known_agrees_but_is_no_check(exact, sd_mm):
    found = checked(exact, plate(exact, off_mm=sd_mm, sd_mm=sd_mm))
    assert found.agrees and not found.passed
    assert found.note.code == "scan.planes_see_little"
    assert found.sees < 0.2
    assert f"it would show {100 * found.sees:.0f} %, of which a check has to show {100 * SEES:.0f} %" in str(found.note)


def test_the_probability_of_telling_a_change_is_that_of_draws():
    rng = np.random.default_rng(4)
    for sizes in ([0.0, 0.0, 0.0], [1.3, 2.3, 7.3], [0.3, 1.0, 2.0, 4.0, 10.0, 30.0]):
        drawn = rng.normal(size=(200_000, len(sizes))) ** 2 @ (1 + np.array(sizes) ** 2)
        told = np.mean(drawn > chdtri(len(sizes), DISAGREES))
        assert _told(np.diag(sizes)) == pytest.approx(told, abs=0.004)
