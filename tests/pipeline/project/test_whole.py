"""The whole job in one go: the results of every button pressed in turn, and where it stops for somebody to decide."""

from contextlib import contextmanager, nullcontext
from dataclasses import replace

import pytest

from core.errors import Cancelled
from core.files.project.data import Accepted, ProjectFile
from core.files.project.folder import results_folder
from core.files.project.keys import STEPS, finished
from core.files.step_graph import CALIBRATED, GRAPH, IN_PROJECT, READJUST
from core.inspect.plan.feature_spec import Auto, FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan
from core.messages import Message
from core.pipeline.project import whole
from core.pipeline.project.whole import Stop, _Work, measure_all
from core.pipeline.run import _Run
from core.second_process import SecondProcess
from tests.simulated import contents, copy_of

WHY = Message("whole.enough", "That is enough.")

BALL_ON_A_BLOCK = InspectionPlan((FeatureSpec("ball", "sphere", (Auto(1),)),))


@pytest.fixture
def folder(done, tmp_path):
    return copy_of(done.folder, tmp_path / "project")


@pytest.fixture
def file(done):
    """The project with every step done."""
    results = {}
    for step in ("camera", "planes", "scan", "gauge", "report"):
        results[step] = finished(step, done.project, results)
    return ProjectFile(done.project, results)


@pytest.fixture
def begun(done, file):
    """The project with accepted calibrations and nothing else."""
    return ProjectFile(done.project, {step: file.results[step] for step in ("camera", "planes")})


def changed(file, **changes):
    return replace(file, project=replace(file.project, **changes))


def steps_done(folder, file):
    """What the job does, step by step, and where it stops."""
    seen, before = [], set(file.results.items())

    def watch(after):
        seen.extend(step for step in STEPS if step in after.results and (step, after.results[step]) not in before)
        before.update(after.results.items())

    return measure_all(folder, file, watch=watch), seen


@pytest.mark.accuracy
def test_it_gives_what_every_step_by_itself_gives_byte_for_byte(done, tmp_path):
    fresh = replace(done.project, accepted=Accepted())
    (tmp_path / "fresh").mkdir()
    job, seen = steps_done(tmp_path / "fresh", ProjectFile(fresh))
    assert job.stop is None
    assert job.file.project == done.project
    assert seen == ["camera", "planes", "scan", "gauge", "report"]
    for name in ("camera.json", "planes.json", "cloud.ply", "mesh.ply", "gauge.json"):
        mine, theirs = results_folder(tmp_path / "fresh") / name, results_folder(done.folder) / name
        assert mine.read_bytes() == theirs.read_bytes(), name
    assert (results_folder(tmp_path / "fresh") / "report.pdf").read_bytes().startswith(b"%PDF")


def test_what_is_up_to_date_is_not_done_again(folder, file):
    job, seen = steps_done(folder, file)
    assert job.stop is None
    assert job.file == file
    assert seen == []


def test_another_nominal_value_measures_the_thickness_and_makes_the_report_only(folder, file, monkeypatch):
    monkeypatch.setattr(whole, "make_report", lambda *_: None)
    gauge = replace(file.project.rig.gauge, nominal_mm=50.01)
    job, seen = steps_done(folder, changed(file, rig=replace(file.project.rig, gauge=gauge)))
    assert job.stop is None
    assert seen == ["gauge", "report"]


@pytest.mark.parametrize("step", CALIBRATED)
def test_a_calibration_that_was_rejected_is_left_to_somebody(step, done, folder, file, monkeypatch):
    monkeypatch.setattr(whole, "find_views", lambda *_: done.seen)
    monkeypatch.setattr(whole, "find_poses", lambda *_: done.poses)
    accepted = replace(done.project.accepted, **{step: ""})
    rejected = frozenset({getattr(done.project.accepted, step)})
    job, seen = steps_done(folder, changed(file, accepted=accepted, rejected=rejected))
    assert job.stop.page == step
    assert job.stop.why.code == "whole.calibration_was_rejected"
    assert job.file.project.accepted == accepted
    assert seen == []


def test_a_calibration_that_is_called_bad_is_left_to_somebody(done, folder, file, monkeypatch):
    bad = Message("camera.bad_fit", "The calibration is bad.")
    monkeypatch.setattr(whole, "find_views", lambda *_: done.seen)
    monkeypatch.setattr(whole, "solve_views", lambda *_: done.camera)
    monkeypatch.setattr(whole, "bad_fit", {done.camera: bad}.get)
    job, seen = steps_done(folder, changed(file, accepted=Accepted()))
    assert (job.stop.page, job.stop.why) == ("camera", bad)
    assert job.file.project.accepted == Accepted()
    assert seen == []


def test_without_pictures_it_stops_where_they_are_missing_and_says_so(folder, begun):
    sources = replace(begun.project.sources, scan="")
    job, seen = steps_done(folder, changed(begun, sources=sources))
    assert job.stop.page == "scan"
    assert str(job.stop.why).endswith(".")
    assert seen == []


def test_a_feature_that_cannot_be_measured_stops_it_once_and_is_then_reported(folder, file):
    asked = changed(file, inspection=BALL_ON_A_BLOCK)
    job, seen = steps_done(folder, asked)
    assert job.stop.page == "inspect"
    assert job.stop.why.code == "whole.feature_not_measured"
    assert "ball" in str(job.stop.why)
    assert seen == ["inspection"]
    again, seen = steps_done(folder, job.file)
    assert again.stop is None
    assert seen == ["report"]


def test_what_was_done_before_it_is_cancelled_is_known(done, folder, begun, monkeypatch):
    monkeypatch.setattr(whole, "measure_scan", lambda *_, **__: done.summary)  # whose results are in the folder
    last = []

    def stop_in_the_report(step, _done, _total):
        if last:
            raise Cancelled

    with pytest.raises(Cancelled):
        measure_all(folder, begun, progress=stop_in_the_report, watch=last.append)
    assert {"scan", "gauge"} <= last[-1].results.keys()
    assert measure_all(folder, last[-1]).file.results.keys() == {"camera", "planes", "scan", "gauge", "report"}


@pytest.mark.parametrize("step", ["planes", "scan"])
def test_a_second_process_takes_part_of_what_is_worth_it(step, folder, file, monkeypatch):
    given = []
    monkeypatch.setattr(whole, "second_process", lambda _: nullcontext("beside"))
    monkeypatch.setattr(whole._Work, "planes", lambda work: given.append(work._beside) or Stop("planes", WHY))
    monkeypatch.setattr(whole._Work, "scan", lambda work: given.append(work._beside) or Stop("scan", WHY))
    results = {name: done for name, done in file.results.items() if name != step}
    assert measure_all(folder, replace(file, results=results)).stop.page == step
    assert given == ["beside"]


def test_none_is_started_where_nothing_is_to_be_calibrated_or_scanned(folder, file, monkeypatch):
    monkeypatch.setattr(whole, "second_process", None)
    monkeypatch.setattr(whole, "make_report", lambda *_: None)
    results = {name: done for name, done in file.results.items() if name != "report"}
    assert measure_all(folder, replace(file, results=results)).stop is None


def test_a_second_process_that_is_killed_stops_it_with_one_sentence_and_leaves_the_old_results(
    folder, begun, monkeypatch
):
    @contextmanager
    def killed(modules):
        with SecondProcess(modules) as process:
            process._process.kill()
            yield process

    monkeypatch.setattr(whole, "second_process", killed)
    before = contents(results_folder(folder))
    job, seen = steps_done(folder, begun)
    assert job.stop.page == "scan"
    assert "second process" in str(job.stop.why) and str(job.stop.why).count(".") == 1
    assert seen == []
    assert contents(results_folder(folder)) == before


@pytest.mark.parametrize(
    ("place", "steps"),
    [(_Run, [step for step in GRAPH if not step.on_request or step.name in ("gauge", READJUST)]), (_Work, IN_PROJECT)],
    ids=["set", "project"],
)
def test_a_place_has_a_method_of_the_name_of_each_step_that_it_may_want(place, steps):
    assert [step.name for step in steps if not callable(getattr(place, step.name, None))] == []
