"""A scan measured in a project: the numbers of the command line, and old or new results, never both."""

import json
import pickle
import shutil
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from core.errors import Cancelled, InputError
from core.files.project.folder import results_folder
from core.files.project.view_file import read_view, write_view
from core.files.recording.rig import GaugeSpec
from core.image.exclusion import Exclusion
from core.inspect.shown.seen_from import SeenFrom
from core.pipeline.project.measuring import measure_gauge, measure_scan
from core.pipeline.project.report import make_report
from core.pipeline.project.results import load_results
from tests.simulated import SMALL, contents, copy_of

MEASURED = ("camera.json", "planes.json", "planes.npz", "cloud.ply", "mesh.ply", "scan.npz", "gauge.json", "gauge.npz")


def test_a_project_measures_the_same_bytes_as_the_command_line(done, measured):
    results = results_folder(done.folder)
    for name in MEASURED:
        assert (results / name).read_bytes() == (measured / name).read_bytes(), name


def test_the_record_names_the_same_inputs_settings_notes_and_frames_as_the_command_lines(done, measured):
    mine = json.loads((results_folder(done.folder) / "run.json").read_text())
    theirs = json.loads((measured / "run.json").read_text())
    for key in ("inputs", "settings", "notes", "frames"):
        assert mine[key] == theirs[key], key


def test_the_summary_says_what_the_files_say(done):
    assert len(done.summary.frames) == SMALL.frames
    assert done.summary.gauge.thickness_mm == pytest.approx(50.0, abs=2 * done.summary.gauge.U_mm)
    assert done.summary.no_gauge is None
    assert all(path.exists() for path in done.summary.files.values())
    assert {"cloud", "mesh", "gauge", "run"} <= set(done.summary.files)


def test_every_frame_is_shown_in_the_order_of_the_recording(done):
    assert [preview.name for preview in done.watched] == [frame.name for frame in done.summary.frames]
    assert sum(len(preview.points) for preview in done.watched) > 0


def test_what_goes_between_processes_can_be_pickled(done):
    for value in (done.project, done.seen, done.camera, done.poses, done.fan, done.summary, load_results(done.folder)):
        assert pickle.loads(pickle.dumps(value)) is not None


def test_every_stage_asks_often_enough_whether_to_stop(done):
    told = Counter(done.told)
    assert told["camera views"] > SMALL.camera_views
    assert told["plane poses"] > SMALL.plane_poses
    assert told["frames"] > SMALL.frames
    assert told["crossings"] >= 3
    assert told["network"] > 12
    assert told["normals"] >= 6
    assert told["fusion"] >= 3
    assert told["mesh"] >= 4
    assert told["calibration uncertainty"] > 10, "after each displaced calibration, and while one is waited for"
    assert told["report"] >= 6


def noted(stages):
    """A progress that puts the name of every stage into `stages`."""
    return lambda step, done, total: stages.add(step)


@pytest.mark.accuracy
def test_a_cancelled_measurement_leaves_the_old_results_whole(done, tmp_path):
    """In every stage; those that need no picture come sooner where another cut is asked for."""
    folder = copy_of(done.folder, tmp_path / "project")
    before = contents(folder)
    tried = set()
    for number, changes in enumerate(({"sigma_cut_mm": 0.2}, {"excluded": frozenset({"scan/frame0000.png"})})):
        project, stages = done.with_options(**changes), set()
        measure_scan(copy_of(done.folder, tmp_path / str(number)), project, noted(stages))
        for stage in stages - tried:

            def stop(step, done, total, stage=stage):
                if step == stage:
                    raise Cancelled

            with pytest.raises(Cancelled):
                measure_scan(folder, project, stop)
            assert contents(folder) == before, stage
        tried |= stages
    assert {"frames", "network", "mesh"} < tried


def test_a_new_measurement_replaces_all_old_results_but_the_report(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    results = results_folder(folder)
    report = (results / "report.pdf").read_bytes()
    (results / ".new").mkdir()
    (results / ".new" / "cloud.ply").write_bytes(b"of a run that was killed")
    before = contents(results)
    write_view(folder, SeenFrom(np.eye(3), np.zeros(3), 50.0, 1.5), "the scan of another part")
    left_out = frozenset({"scan/frame0000.png", "scan/frame0003.png"})
    summary = measure_scan(folder, done.with_options(excluded=left_out))
    after = contents(results)
    assert after["cloud.ply"] != before["cloud.ply"]
    assert after["gauge.json"] != before["gauge.json"]
    assert after["report.pdf"] == report
    assert read_view(folder) is None, "it was of another part"
    assert set(after) == set(before) - {".new/cloud.ply"}
    assert {frame.name for frame in summary.frames if frame.reason == Exclusion.BY_HAND.message} == left_out


@pytest.mark.accuracy
def test_frames_left_out_keep_the_numbers_of_the_others(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    summary = measure_scan(folder, done.with_options(excluded=frozenset({"scan/frame0001.png"})))
    assert [frame.index for frame in summary.frames] == list(range(SMALL.frames))
    left_out = summary.frames[1]
    assert (left_out.name, left_out.used, left_out.reason) == ("scan/frame0001.png", False, Exclusion.BY_HAND.message)
    results = load_results(folder)
    assert 1 not in results.cloud.frame
    for frame in summary.frames:
        assert np.count_nonzero(results.cloud.frame == frame.index) == frame.points
    assert any("frame0001.png" in str(note) for note in summary.notes)
    inputs = json.loads((results_folder(folder) / "run.json").read_text())["inputs"]
    assert "scan/frame0001.png" not in inputs


def test_all_frames_left_out_is_said_before_the_work(done, tmp_path):
    names = frozenset(frame.name for frame in done.summary.frames)
    with pytest.raises(InputError, match="left out by hand"):
        measure_scan(copy_of(done.folder, tmp_path / "project"), done.with_options(excluded=names))


@pytest.mark.accuracy
def test_a_scan_without_two_parallel_faces_is_no_error(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    far = np.array([[0.0, 0.0], [3.0, 0.0], [0.0, 3.0]])
    project = replace(done.project, rig=replace(done.project.rig, gauge=GaugeSpec(50.0, 0.2, far, far + 5)))
    summary = measure_scan(folder, project)
    assert summary.gauge is None
    assert str(summary.no_gauge).startswith("No thickness was measured")
    assert summary.no_gauge in summary.notes
    assert not (results_folder(folder) / "gauge.json").exists()
    assert make_report(folder, project).exists()


def test_the_thickness_alone_is_measured_again_with_another_nominal_value(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    project = replace(done.project, rig=replace(done.project.rig, gauge=GaugeSpec(45.0, 0.1)))
    gauge = measure_gauge(folder, project)
    assert gauge.thickness_mm == done.summary.gauge.thickness_mm
    assert gauge.verdict == "not conforming"


def test_killed_in_the_middle_of_replacing_leaves_no_mixture(done, tmp_path, monkeypatch):
    folder = copy_of(done.folder, tmp_path / "project")
    old = contents(results_folder(folder))
    project = done.with_options(sigma_cut_mm=0.2)
    monkeypatch.setattr(shutil, "rmtree", lambda *_, **__: None)
    real, moves = type(folder).replace, []

    def pulled(path, target):
        if target.parent == results_folder(folder):
            moves.append(target.name)  # the first: calibrations are what they were, and stay
            raise KeyboardInterrupt
        return real(path, target)

    monkeypatch.setattr(type(folder), "replace", pulled)
    with pytest.raises(KeyboardInterrupt):
        measure_scan(folder, project)
    left = {name: data for name, data in contents(results_folder(folder)).items() if "/" not in name}
    assert moves == ["scan.npz"]
    assert set(left) == {"camera.json", "planes.json", "planes.npz", "report.pdf"}
    assert all(left[name] == old[name] for name in left), "calibrations are those the scan was measured with before"
    assert load_results(folder).cloud is None
