"""The plan of a project: the numbers of `trisect inspect`, written among the results."""

import json
import shutil
from dataclasses import fields, is_dataclass, replace

import numpy as np
import pytest

from core.errors import InputError
from core.files.plan.plan_file import write_plan
from core.files.plan.translation import plan_tables
from core.files.project.data import ProjectFile
from core.files.project.folder import create_project, results_folder
from core.files.results.shown_file import read_shown, write_shown
from core.inspect.plan.feature_kind import FeatureKind
from core.inspect.plan.feature_spec import Auto, FeatureSpec, Filters, Section
from core.inspect.plan.inspection_plan import InspectionPlan
from core.model import Pose
from core.pipeline.project import inspection as project_inspection
from core.pipeline.project.inspection import look_at_features, measure_features
from core.pipeline.project.report import project_content
from core.pipeline.steps.inspect_step import inspect_step
from core.pipeline.steps.master_step import measured_master

PLAN = InspectionPlan(
    (
        FeatureSpec("table", "plane", (Auto(1),)),
        FeatureSpec("top", "plane", (Auto(2),)),
        FeatureSpec("height", "distance", of=("top", "table")),
        FeatureSpec("ball", "sphere", (Auto(1),)),
    )
)


@pytest.fixture
def folder(done, tmp_path):
    shutil.copytree(done.folder, tmp_path / "copy")
    return tmp_path / "copy"


def test_it_gives_the_numbers_of_the_command_line_and_writes_the_same_file(done, folder, tmp_path):
    shown = measure_features(folder, replace(done.project, inspection=PLAN))
    results = results_folder(folder)
    mine = json.loads((results / "inspection.json").read_text())
    write_plan(tmp_path / "plan.toml", PLAN)
    inspect_step(results, PLAN, tmp_path, tmp_path)
    assert mine == json.loads((tmp_path / "inspection.json").read_text())
    height = next(one for one in shown.features if one.name == "height")
    assert height.rows[0].value == pytest.approx(50.0, abs=3 * height.rows[0].u + 0.2)


def test_looking_writes_nothing(done, folder):
    look_at_features(folder, replace(done.project, inspection=PLAN))
    assert not (results_folder(folder) / "inspection.json").exists()


def drawn(value):
    """Everything in it, arrays by their values."""
    if isinstance(value, np.ndarray):
        return (str(value.dtype), value.tolist())
    if isinstance(value, tuple):
        return [drawn(one) for one in value]
    if is_dataclass(value):
        return {one.name: drawn(getattr(value, one.name)) for one in fields(value)}
    return value


def test_what_was_kept_of_another_inspection_is_not_drawn(done, folder):
    project = replace(done.project, inspection=PLAN)
    measure_features(folder, project)
    other = InspectionPlan(PLAN.features[:1])
    assert [one.name for one in look_at_features(folder, replace(project, inspection=other)).features] == ["table"]
    results = results_folder(folder)
    inspect_step(results, other, folder, results)  # the command line writes inspection.json, and draws nothing
    assert len(look_at_features(folder, project).features) == len(PLAN.features)
    (results / "shown.npz").write_bytes(b"damaged")
    assert len(look_at_features(folder, project).features) == len(PLAN.features)


def test_what_cannot_be_measured_says_why_and_the_rest_is_measured(done, folder):
    plan = InspectionPlan((*PLAN.features[:3], FeatureSpec("far plane", "plane", (Auto(9),))))
    shown = measure_features(folder, replace(done.project, inspection=plan))
    assert shown.features[3].problem and not shown.features[3].rows
    assert shown.features[2].rows


def test_what_is_drawn_is_of_the_scan_and_kept_so_that_it_need_not_be_measured_again(done, folder, monkeypatch):
    across = Section(
        (
            (0.0, done.camera.camera.image_size[1] / 2),
            (done.camera.camera.image_size[0] - 1.0, done.camera.camera.image_size[1] / 2),
        )
    )
    plan = InspectionPlan(
        (
            FeatureSpec("cut", "section", section=across),
            FeatureSpec("far plane", "plane", (Auto(9),)),
        )
    )
    project = replace(done.project, inspection=plan)
    shown = measure_features(folder, project)
    cut, _ = shown.features
    assert not cut.problem
    assert np.all(np.diff(cut.profile.position) >= 0) and len(cut.profile.position) == len(cut.profile.height)
    assert np.all(np.diff(cut.profile.mean_position) > 0)
    line, unseen = cut.profile.mean_line, 3 * across.step_mm
    joined = np.diff(line[0])
    assert np.nanmax(joined) <= unseen and len(line[1]) == len(line[0]), "no line where nothing was seen"
    assert np.isnan(line[0]).sum() == (np.diff(cut.profile.mean_position) > unseen).sum()
    monkeypatch.setattr(project_inspection, "inspect", lambda *_: pytest.fail("measured again"))
    assert drawn(look_at_features(folder, project)) == drawn(shown)


def test_part_coordinates_are_kept_with_what_is_drawn(done, folder):
    project = replace(done.project, inspection=InspectionPlan(PLAN.features[:1]))
    shown, path = measure_features(folder, project), results_folder(folder) / "inspection.json"
    assert shown.pose_camera_part is None
    pose = Pose.from_vector([0.1, -0.2, 3.0, 1.0, 2.0, 500.0])
    write_shown(path, replace(shown, pose_camera_part=pose))
    kept = read_shown(path, plan_tables(project.inspection)).pose_camera_part
    assert np.array_equal(kept.rotation, pose.rotation) and np.array_equal(kept.translation, pose.translation)


def test_after_an_edit_only_what_it_changed_is_measured_and_the_file_is_as_if_all_were(done, folder, monkeypatch):
    measured, memory = [], {}

    def counted(measure):
        def count(spec, scene):
            measured.append(spec.name)
            return measure(spec, scene)

        return count

    load = FeatureKind.measure.fget
    monkeypatch.setattr(FeatureKind, "measure", property(lambda kind: counted(load(kind))))
    measure_features(folder, replace(done.project, inspection=PLAN), memory=memory)
    assert measured == ["table", "top", "ball", "height"]
    table, top, *others = PLAN.features
    edited = replace(PLAN, features=(table, replace(top, filters=Filters(outliers=3.0)), *others))
    measured.clear()
    again = measure_features(folder, replace(done.project, inspection=edited), memory=memory)
    assert measured == ["top", "height"]
    written = (results_folder(folder) / "inspection.json").read_text()
    whole = measure_features(folder, replace(done.project, inspection=edited))
    assert drawn(again) == drawn(whole)
    assert (results_folder(folder) / "inspection.json").read_text() == written


def test_the_report_has_the_thickness_beside_the_features_and_none_that_were_taken_out(done, folder):
    project = replace(done.project, inspection=InspectionPlan(PLAN.features[:1]))
    measure_features(folder, project)
    names = [one.name for one in project_content(folder, project).characteristics]
    assert names == ["thickness", "table flatness"]
    measure_features(folder, replace(project, inspection=InspectionPlan()))
    assert [one.name for one in project_content(folder, done.project).characteristics] == ["thickness"]


def test_without_a_scan_it_is_one_sentence(done, tmp_path):
    with pytest.raises(InputError, match="scan"):
        measure_features(tmp_path, replace(done.project, inspection=PLAN))


def test_a_master_is_taken_from_a_project_as_it_was_measured(done, folder):
    project = replace(done.project, info=replace(done.project.info, part="Block 50", serial="no. 7"))
    create_project(folder, ProjectFile(project))
    thickness = done.summary.gauge
    master = measured_master(folder, 50.0, folder)
    assert (master.name, master.measured_mm) == ("Block 50 no. 7", thickness.thickness_mm)
    assert [u for _, u in master.budget] == [row.u_mm for row in thickness.budget] and master.same_calibration
    assert [one.fact for one in master.doubts] == [one.fact for one in thickness.doubts]
    assert measured_master(results_folder(folder), None).measured_mm == master.measured_mm
    with pytest.raises(InputError, match="no length was measured"):
        measured_master(folder.parent, 50.0)
