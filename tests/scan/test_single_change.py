"""Which single change of the rig explains that crossings disagree: the true one is among those named."""

from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.camera.reprojection import camera_of, parameters_of
from core.calibrate.change import displaced_fan, laser_of
from core.scan.between_frames import Between
from core.scan.features.extraction import ScanFeatures
from core.scan.reconstruct import reconstruct
from core.scan.single_change import Changed, Explanation, explain_by_change
from core.scan.standstill import RigidInterval
from core.scan.sweeps.fan_lines import FanLines
from core.scan.sweeps.locate import numbered
from core.simulate.scenario import Scenario
from tests.scan.centreline_scan import ExactScan


@pytest.fixture(scope="module")
def exact():
    return ExactScan.of(Scenario(height_mm=50.0, seed=4, scale=0.35, frames=24))


@pytest.fixture(scope="module")
def measured(exact):
    return exact.measured(1)


def explained(exact, features: ScanFeatures, camera, fan) -> Explanation | None:
    crossings, line = numbered(features.crossings, FanLines.settled_as(exact.fan_line))
    return explain_by_change(crossings, line, camera, fan)


def calibrated_with(exact, step: dict[int, float]):
    """The camera as it would be calibrated before its parameters changed by minus these steps."""
    here = parameters_of(exact.rig.camera)
    for place, size in step.items():
        here[place] += size
    return camera_of(here, exact.rig.camera.image_size)


@pytest.mark.parametrize(
    ("axis", "shift", "what"),
    [(0, 40.0, Changed.PICTURE_ALONG_U), (0, -25.0, Changed.PICTURE_ALONG_U), (1, 12.0, Changed.PICTURE_ALONG_V)],
)
def test_a_picture_read_out_elsewhere_on_the_sensor_is_named_with_its_shift(exact, measured, axis, shift, what):
    found = explained(exact, measured, calibrated_with(exact, {3 + axis: -shift}), exact.rig.fan)
    (picture,) = [one for one in found.changes if one.what == what]
    assert picture.size[0] == pytest.approx(shift, abs=2.0)
    assert f"about {abs(picture.size[0]):.2g} px" in str(found.note)


def test_a_picture_shifted_along_both_axes_is_named_without_a_number(exact, measured):
    found = explained(exact, measured, calibrated_with(exact, {3: 30.0, 4: -20.0}), exact.rig.fan)
    assert Changed.PICTURE in [one.what for one in found.changes] and "the picture shifted" in str(found.note)


@pytest.mark.parametrize("axis", [0, 2])  # a turn about the other one changes no crossing
def test_a_laser_that_turned_is_among_those_named(exact, measured, axis):
    fan = displaced_fan(exact.rig.fan, np.radians(0.8) * np.eye(3)[axis], laser_of(exact.rig.fan))
    found = explained(exact, measured, exact.rig.camera, fan)
    assert Changed.FAN in [one.what for one in found.changes]


def test_a_lens_focused_anew_is_among_those_named(exact, measured):
    focal = 0.03 * exact.rig.camera.matrix[0, 0]
    found = explained(exact, measured, calibrated_with(exact, {0: -focal, 1: -focal}), exact.rig.fan)
    (focus,) = [one for one in found.changes if one.what == Changed.FOCUS]
    assert focus.size[0] == pytest.approx(0.03, abs=0.004)


@pytest.mark.parametrize("seed", range(4))
def test_of_a_rig_as_calibrated_no_change_is_named(exact, seed):
    assert explained(exact, exact.measured(seed), exact.rig.camera, exact.rig.fan) is None


def test_what_no_change_of_the_rig_explains_is_not_blamed_on_one(exact, measured):
    rng = np.random.default_rng(1)
    table = measured.crossings
    wrong = rng.random(len(table)) < 0.5
    scattered = replace(
        measured, crossings=replace(table, uv=table.uv + 4 * wrong[:, None] * rng.normal(size=table.uv.shape))
    )
    assert explained(exact, scattered, exact.rig.camera, exact.rig.fan) is None


def test_a_scan_solved_all_the_same_proves_nothing_and_says_what_changed_in_place_of_the_hand(exact, measured):
    camera = calibrated_with(exact, {3: -4.0, 4: -4.0})
    scan = reconstruct(measured, camera, exact.rig.fan, fan_lines=FanLines.settled_as(exact.fan_line))
    assert scan.rig_changed
    codes = {note.code for note in scan.notes}
    assert "scan.explained_by_change" in codes and not codes & {"scan.crossings_scatter", "scan.fan_disagrees"}


def test_what_a_change_explains_and_the_fans_light_denies_as_a_movement_costs_no_frame(exact, measured, monkeypatch):
    """Crossings alone would see a movement in the middle, as they may where the rig changed; the fan lay still."""
    half, still = len(measured.frames) // 2, np.zeros(12)
    lit = replace(measured, frames=tuple(replace(one, fan_shifts_px=still) for one in measured.frames))

    def seen(crossings, *_):
        early = (crossings.a < half) & (crossings.with_fan | (crossings.b < half))
        return RigidInterval(early, (Between(half - 1, half),), known=True)

    monkeypatch.setattr("core.scan.reconstruct.largest_rigid_interval", seen)
    camera = calibrated_with(exact, {3: -4.0, 4: -4.0})
    scan = reconstruct(lit, camera, exact.rig.fan, fan_lines=FanLines.settled_as(exact.fan_line))
    assert scan.rig_changed and not scan.movements and "scan.moved" not in {note.code for note in scan.notes}
    assert len(scan.sweep_frames) == len(measured.frames)
