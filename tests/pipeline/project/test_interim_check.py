"""The checks of a project's rig: by pictures of the day and by known artefacts, on rendered pictures."""

import shutil
from dataclasses import replace

import pytest

from core.checks.artefact_check import Artefact
from core.errors import Cancelled, InputError
from core.files.project.calibration_store import history, store_camera, store_planes
from core.files.project.data import Accepted
from core.files.project.folder import project_from_set
from core.files.results.check_file import read_check
from core.inspect.plan.feature_spec import FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan
from core.pipeline.project.inspection import measure_features
from core.pipeline.project.interim_check import (
    accept_readjustment,
    artefact_checks,
    check_history,
    check_rig,
    comparable_lengths,
    compare_with_artefact,
    propose_project_readjustment,
    show_check,
)
from core.pipeline.project.workspace import project_set
from core.pipeline.steps.workspace import read_calibration
from core.settings.options import Options
from tests.pipeline.steps.test_check_step import RIG, prepared
from tests.simulated import copy_of


@pytest.fixture(scope="module")
def unchanged(tmp_path_factory):
    return prepared(tmp_path_factory, "checked-unchanged", RIG)


@pytest.fixture(scope="module")
def turned(tmp_path_factory):
    return prepared(tmp_path_factory, "checked-turned", replace(RIG, turned_urad=400.0))


def opened(made, folder):
    """A project on that set with its calibrations accepted."""
    known = read_calibration(made / "out")
    camera = store_camera(folder, known.camera, Options().run_settings("camera"))
    fan = store_planes(folder, known.fan, known.camera.camera, ())
    project = project_from_set(made / "set", "Block")
    return replace(project, accepted=Accepted(camera, fan))


def test_a_project_made_of_a_set_checks_by_its_pictures_of_the_day(unchanged, tmp_path):
    project = opened(unchanged, tmp_path)
    assert show_check(tmp_path) is None
    check = check_rig(tmp_path, project)
    assert check.passed and check.used == 2
    assert check.calibration_id == f"{project.accepted.camera}-{project.accepted.planes}"
    assert show_check(tmp_path) == check == read_check(tmp_path / "check" / "check.json")
    assert [pair.name for pair in project_set(tmp_path, project).check] == ["check00", "check01"], (
        "the scan has them, too"
    )


def test_a_check_that_is_cancelled_keeps_the_one_before(unchanged, tmp_path):
    project = opened(unchanged, tmp_path)
    check = check_rig(tmp_path, project)

    def cancel(*_):
        raise Cancelled

    with pytest.raises(Cancelled):
        check_rig(tmp_path, project, cancel)
    assert show_check(tmp_path) == check


def test_the_thickness_of_a_project_is_compared_with_an_artefact_and_the_rig_remembers(done, tmp_path):
    folder, gauge = copy_of(done.folder, tmp_path / "project"), done.summary.gauge
    assert artefact_checks(folder, done.project) == ()
    block = Artefact("GB 7", gauge.thickness_mm - 0.5 * gauge.U_mm, 0.0004)
    check = compare_with_artefact(folder, done.project, block)
    assert check.verdict == "passed" and check.e_n == pytest.approx(0.5, abs=0.01)
    compare_with_artefact(folder, done.project, replace(block, id="GB 8", value_mm=gauge.thickness_mm + 1))
    assert [(one.artefact.id, one.verdict) for one in artefact_checks(folder, done.project)] == [("GB 8", "failed")]


def test_a_step_of_a_project_is_compared_by_its_features(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    assert comparable_lengths(folder) == {"block": ("",), "sphere": (), "step": ()}
    plan = InspectionPlan((FeatureSpec("stairs", "steps"), FeatureSpec("block", "thickness")))
    shown = measure_features(folder, replace(done.project, inspection=plan))
    (height,) = shown.features[0].rows
    lengths = {"block": ("", "block thickness"), "sphere": (), "step": ("stairs height 1",)}
    assert comparable_lengths(folder) == lengths
    step = Artefact("S 50", height.value - 0.5 * height.U, 0.0004, kind="step")
    check = compare_with_artefact(folder, done.project, step, "stairs height 1")
    assert (check.verdict, check.characteristic) == ("passed", "stairs height 1")
    block = compare_with_artefact(folder, done.project, Artefact("GB 50", 40.0, 0.0004), "block thickness")
    assert (block.verdict, block.characteristic) == ("failed", "block thickness")
    kept = [(one.artefact, one.verdict) for one in artefact_checks(folder, done.project)]
    assert kept == [(block.artefact, "failed"), (step, "passed")], "two lengths of one scan"


def test_artefacts_beside_the_rig_come_into_its_project(unchanged, tmp_path):
    made = shutil.copytree(unchanged / "set", tmp_path / "set")
    (made / "artefacts.toml").write_text('[[artefact]]\nid = "GB 7"\nvalue_mm = 50.0\nU_mm = 0.0004\n')
    assert project_from_set(made, "Block").artefacts == (Artefact("GB 7", 50.0, 0.0004),)


@pytest.mark.accuracy
def test_a_readjustment_is_kept_beside_the_calibration_it_began_with(turned, tmp_path):
    project = opened(turned, tmp_path)
    proposed = propose_project_readjustment(tmp_path, project)
    assert [entry.kind for entry in history(tmp_path)].count("planes") == 1, "nothing is kept before it is accepted"
    id_ = accept_readjustment(tmp_path, project, proposed)
    adjusted = replace(project, accepted=replace(project.accepted, planes=id_))
    assert {entry.id for entry in history(tmp_path)} == {project.accepted.camera, project.accepted.planes, id_}
    with pytest.raises(InputError, match="these very pictures"):
        check_rig(tmp_path, adjusted)
    with pytest.raises(InputError, match="another calibration"):
        accept_readjustment(tmp_path, adjusted, proposed)
    assert not check_rig(tmp_path, project).passed, "what was accepted before is there as it was"
    assert [one.verdict for one in check_history(tmp_path, project).checks] == ["failed"]
    assert check_history(tmp_path, adjusted).checks == ()
