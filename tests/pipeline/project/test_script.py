"""What was done in a project, saved as a script: the same commands, and the same bytes when it is run elsewhere."""

import ast
import json
import runpy
import subprocess
import sys
from dataclasses import replace
from datetime import date
from pathlib import Path

import pytest

from core.checks.artefact_check import Artefact
from core.cli import main
from core.errors import InputError
from core.files.project.data import ProjectFile, ReportChoices
from core.files.project.folder import create_project, read_project, results_folder, write_project
from core.files.project.keys import finished
from core.files.results.artefact_register import register_in
from core.files.results.rig_history import history_file
from core.inspect.plan.feature_spec import FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan
from core.pipeline.project.inspection import measure_features
from core.pipeline.project.interim_check import compare_with_artefact
from core.pipeline.project.report import make_report
from core.pipeline.project.script import write_script
from core.pipeline.steps.validity import history_name, history_of
from core.pipeline.steps.workspace import read_calibration
from tests.pipeline.project.test_measuring import MEASURED
from tests.simulated import copy_of


@pytest.fixture(scope="module")
def with_everything(done, tmp_path_factory) -> Path:
    """A saved project with everything done, and its own words in the report."""
    folder = copy_of(done.folder, tmp_path_factory.mktemp("with_everything") / "project")
    info = replace(done.project.info, part='Block "A"', serial="7", notes="seen")
    plan = InspectionPlan(features=(FeatureSpec(name="top", kind="plane"),))
    changed = replace(done.project, info=info, inspection=plan, report=ReportChoices(paper="Letter", language="de"))
    create_project(folder, ProjectFile(changed))
    measure_features(folder, changed)
    make_report(folder, changed)
    return folder


@pytest.fixture
def project(with_everything, tmp_path) -> Path:
    """A copy of it."""
    return copy_of(with_everything, tmp_path / "a block's project")


def commands(script: Path) -> list[list[str]]:
    """The words of every command in a script, which must be Python."""
    calls = [node for node in ast.walk(ast.parse(script.read_text(encoding="utf-8"))) if isinstance(node, ast.Call)]
    told = [call for call in calls if isinstance(call.func, ast.Name) and call.func.id == "trisect"]
    return [[ast.literal_eval(word) for word in call.args] for call in told]


def test_every_step_that_was_done_is_a_command_with_what_it_was_told(project, tmp_path):
    said = commands(write_script(project, tmp_path / "session.py"))
    assert [words[0] for words in said] == ["import", "camera", "planes", "scan", "gauge", "inspect", "report"]
    told = {words[0]: words for words in said}
    assert told["inspect"][-2:] == ["--plan", "plan.toml"]
    for option, value in (("--part", 'Block "A"'), ("--serial", "7"), ("--paper", "Letter"), ("--language", "de")):
        assert told["report"][told["report"].index(option) + 1] == value
    settings = json.loads((results_folder(project) / "run.json").read_text())["settings"]
    assert ("--skew" in told["camera"]) == settings["camera"]["skew"]
    assert float(told["scan"][told["scan"].index("--sigma-cut") + 1]) == settings["scan"]["sigma_cut_mm"]


def test_pictures_left_out_and_stated_stripes_are_told_as_they_were_and_not_as_chosen_now(project, tmp_path):
    run = results_folder(project) / "run.json"
    record = json.loads(run.read_text())
    record["settings"]["camera"]["excluded"] = ["camera/view01.png"]
    record["settings"]["planes"]["stripe"] = {"width_px": 4.5, "contrast": 60.0}
    run.write_text(json.dumps(record))
    told = {words[0]: words for words in commands(write_script(project, tmp_path / "session.py"))}
    assert told["camera"][-2:] == ["--exclude", "camera/view01.png"]
    assert told["planes"][-4:] == ["--stripe-width", "4.5", "--contrast", "60.0"]
    assert "--stripe-width" not in told["scan"]


def compared(folder):
    """The project after its thickness was compared with one of its artefacts, and with one of the user's own."""
    file = read_project(folder)
    own = Artefact("own", 50.1, 0.0003, 3.0, kind="block")
    project = replace(
        file.project,
        info=replace(file.project.info, air_celsius=21.5),
        artefacts=(Artefact("GB 7", 50.0, 0.0004, due=date(2030, 1, 2)), Artefact("B 9", 9.0, 0.001, kind="sphere")),
    )
    write_project(folder, replace(file, project=project))
    compare_with_artefact(folder, project, project.artefacts[0])
    return project, compare_with_artefact(folder, project, own)


def test_artefacts_and_what_was_compared_with_them_are_in_the_script(project, tmp_path):
    changed, last = compared(project)
    script = write_script(project, tmp_path / "session.py")
    told = {words[0]: words for words in commands(script)}
    assert list(told)[-2:] == ["artefact", "report"]
    assert told["artefact"][-4:] == ["--id", "own", "--celsius", "21.5"], "of one thickness the last comparison counts"
    text = runpy.run_path(str(script))["FILES"]["set/artefacts.toml"]
    (tmp_path / "artefacts.toml").write_text(text)
    assert register_in(tmp_path) == {one.id: one for one in (*changed.artefacts, last.artefact)}


def test_a_camera_of_another_program_is_taken_from_its_file(project, tmp_path):
    run = results_folder(project) / "run.json"
    record = json.loads(run.read_text())
    record["settings"]["camera"] = {"imported": "/lab/camera.yaml", "skew": False}
    run.write_text(json.dumps(record))
    said = commands(write_script(project, tmp_path / "session.py"))
    assert said[1] == ["import-camera", "/lab/camera.yaml", "--out", "results"]
    assert [words[0] for words in said].count("camera") == 0


def test_what_no_command_takes_is_said_beside_it(project, done, tmp_path):
    text = write_script(project, tmp_path / "session.py").read_text(encoding="utf-8")
    assert "no option of the command: remarks" in text
    assert "recorded live" not in text
    inside = copy_of(Path(done.project.sources.scan), project / "recordings" / "one")
    changed = replace(done.project, sources=replace(done.project.sources, scan="recordings/one"))
    write_project(project, ProjectFile(changed))
    text = write_script(project, tmp_path / "session.py").read_text(encoding="utf-8")
    assert inside.is_dir() and "recorded live into this project; the pictures are used as they are: scan" in text


def test_what_was_changed_since_is_said(project, tmp_path):
    file = read_project(project)
    done = finished("scan", file.project, {})
    write_project(project, replace(file, results={"scan": done}))
    assert "changed since" not in write_script(project, tmp_path / "session.py").read_text(encoding="utf-8")
    gauge = replace(file.project.rig.gauge, nominal_mm=20.0)
    options = replace(file.project.options, sigma_cut_mm=0.2)
    changed = replace(file.project, rig=replace(file.project.rig, gauge=gauge), options=options)
    write_project(project, ProjectFile(changed, {"scan": done}))
    assert "changed since scan was done" in write_script(project, tmp_path / "session.py").read_text(encoding="utf-8")


def test_a_project_with_nothing_measured_has_no_script(done, tmp_path):
    create_project(tmp_path / "new", ProjectFile(done.project))
    with pytest.raises(InputError, match="nothing has been measured"):
        write_script(tmp_path / "new", tmp_path / "session.py")


def test_the_command_writes_the_same_script(project, tmp_path, capsys):
    with pytest.raises(SystemExit) as end:
        main(["script", str(project), "--out", str(tmp_path / "one.py")])
    assert not end.value.code
    assert (tmp_path / "one.py").read_bytes() == write_script(project, tmp_path / "two.py").read_bytes()


@pytest.mark.accuracy
def test_the_script_gives_the_same_bytes_in_an_empty_folder(project, tmp_path):
    _, check = compared(project)
    script = write_script(project, tmp_path / "session.py")
    calibration, rig = read_calibration(results_folder(project)), read_project(project).project.rig
    history_file(history_name(rig, calibration.id)).unlink()
    (tmp_path / "empty").mkdir()
    subprocess.run([sys.executable, str(script)], cwd=tmp_path / "empty", check=True)
    for name in MEASURED:
        assert (tmp_path / "empty" / "results" / name).read_bytes() == (results_folder(project) / name).read_bytes()
    there, here = (
        json.loads((folder / "inspection.json").read_text())
        for folder in (tmp_path / "empty" / "results", results_folder(project))
    )
    assert there["characteristics"] == here["characteristics"]
    assert [one.of_artefact for one in history_of(rig, calibration.id).checks] == [check], "and so is the history"
    assert (tmp_path / "empty" / "results" / "report.pdf").stat().st_size > 0
