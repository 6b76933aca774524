"""A laser or lens whose light reaches further to one side than at the calibration: is U true, and is it told?

Whole sets at half the full size, measured as a user would with one calibration, and references of many seeds.
"""

from dataclasses import replace

import pytest

from core.files.recording.features_file import read_poses
from core.files.recording.recording_set import open_set
from core.files.results.planes_file import planes_id
from core.inspect.conformity import Verdict
from core.pipeline.steps.workspace import Workspace
from core.scan.changed_section import Section, changed_section
from core.scan.features.reference import read_reference
from core.simulate.effects.laser import LaserEffects
from core.simulate.effects.lens import LensEffects
from core.simulate.recording import scan_of
from core.simulate.scenario import Scenario
from tests.accuracy.twin import calibrated_once, measure

SET = Scenario(scale=0.5, frames=36, camera_views=10, plane_poses=8)
TOLD = "inspection.section_has_changed"


@pytest.fixture(scope="module")
def calibrated(tmp_path_factory):
    return calibrated_once(tmp_path_factory, SET)


@pytest.mark.accuracy
@pytest.mark.parametrize(("shoulder", "seed"), [(0.1, 2), (0.3, 3)])
def test_a_laser_with_a_shoulder_that_it_had_not_is_told_and_its_error_within_u(shoulder, seed, calibrated, tmp_path):
    laser = LaserEffects(shoulder=shoulder)
    gauge = measure(replace(SET, seed=seed, laser=laser), tmp_path, calibrated).gauge
    error = gauge.thickness_mm - 50.0
    print(f"{1e3 * error:+.0f} ± {1e3 * gauge.U_mm:.0f} µm, {gauge.verdict}")
    assert abs(error) <= gauge.U_mm
    assert TOLD in {note.code for note in gauge.notes}
    assert gauge.verdict != Verdict.CONFORMING


@pytest.mark.accuracy
@pytest.mark.parametrize(
    "otherwise", [{}, {"gloss": 3.0}, {"inner_share": 0.35, "inner_mm": 1.2}, {"lens": LensEffects(aperture_mm=6.0)}]
)
def test_no_part_and_no_focus_is_taken_for_such_a_change(otherwise, calibrated):
    work = Workspace.open(open_set(calibrated / "set"), calibrated / "out")
    known = work.calibration()
    poses = [pose.centrelines for pose in read_poses(work.path("poses"), planes_id(known.fan.fan))]
    for seed in range(1, 4 if otherwise else 9):
        stage, _, _ = scan_of(replace(SET, seed=seed, frames=3, **otherwise))
        fan = read_reference(stage.reference()).fan
        assert changed_section(poses, fan, known.camera.camera, known.fan.fan) is Section.SAME
