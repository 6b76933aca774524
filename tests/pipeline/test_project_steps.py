"""The steps of a project: the same numbers as the command line, and old or new results, never both."""

import json
import pickle
import shutil
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from pypdf import PdfReader

from core.calibrate.results import LEFT_OUT
from core.errors import Cancelled, InputError
from core.files.project import Accepted, ProjectInfo, ReportChoices
from core.files.rig import GaugeSpec
from core.pipeline import project_steps
from core.pipeline.project_steps import (
    accept_fan,
    find_poses,
    load_results,
    make_report,
    measure_gauge,
    measure_scan,
    results_folder,
    solve_poses,
    solve_views,
)
from tests.simulated import SMALL, copy_of

MEASURED = ("camera.json", "planes.json", "planes.npz", "cloud.ply", "mesh.ply", "scan.npz", "gauge.json", "gauge.npz")


def contents(folder):
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


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
    assert done.summary.no_gauge == ""
    assert all(path.exists() for path in done.summary.files.values())
    assert {"cloud", "mesh", "gauge", "run"} <= set(done.summary.files)


def test_every_frame_is_shown_in_the_order_of_the_recording(done):
    assert [preview.name for preview in done.watched] == [frame.name for frame in done.summary.frames]
    assert sum(len(preview.points) for preview in done.watched) > 0


def test_what_goes_between_processes_can_be_pickled(done):
    for value in (done.project, done.seen, done.camera, done.poses, done.fan, done.summary, load_results(done.folder)):
        assert pickle.loads(pickle.dumps(value)) is not None
    for name in project_steps.__all__:
        function = getattr(project_steps, name)
        if callable(function):
            assert pickle.loads(pickle.dumps(function)) is function


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
    assert told["calibration uncertainty"] > 100
    assert told["report"] >= 6


def test_without_an_accepted_camera_the_fan_cannot_be_looked_at(done):
    project = replace(done.project, accepted=Accepted())
    with pytest.raises(InputError, match="no calibration of the camera is accepted"):
        find_poses(done.folder, project)
    with pytest.raises(InputError, match="accepted"):
        measure_scan(done.folder, project)


def test_a_fan_of_other_settings_than_those_in_force_is_not_accepted(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    project = done.with_options(excluded=frozenset({"planes/pose02"}))
    before = contents(folder)
    with pytest.raises(InputError, match="solve the laser planes again"):
        accept_fan(folder, project, done.fan, done.poses)
    assert contents(folder) == before


def test_a_cancelled_measurement_leaves_the_old_results_whole(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    before = contents(folder)
    project = done.with_options(excluded=frozenset({"scan/frame0000.png"}))
    stages = []

    def note(step, done, total):
        if step not in stages:
            stages.append(step)

    measure_scan(copy_of(done.folder, tmp_path / "other"), project, note)
    for stage in stages:

        def stop(step, done, total, stage=stage):
            if step == stage:
                raise Cancelled

        with pytest.raises(Cancelled):
            measure_scan(folder, project, stop)
        assert contents(folder) == before, stage


def test_a_new_measurement_replaces_all_old_results_but_the_report(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    results = results_folder(folder)
    report = (results / "report.pdf").read_bytes()
    (results / ".new").mkdir()
    (results / ".new" / "cloud.ply").write_bytes(b"of a run that was killed")
    before = contents(results)
    left_out = frozenset({"scan/frame0000.png", "scan/frame0003.png"})
    summary = measure_scan(folder, done.with_options(excluded=left_out))
    after = contents(results)
    assert after["cloud.ply"] != before["cloud.ply"]
    assert after["gauge.json"] != before["gauge.json"]
    assert after["report.pdf"] == report
    assert set(after) == set(before) - {".new/cloud.ply"}
    assert {frame.name for frame in summary.frames if frame.reason == LEFT_OUT} == left_out


def test_frames_left_out_keep_the_numbers_of_the_others(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    summary = measure_scan(folder, done.with_options(excluded=frozenset({"scan/frame0001.png"})))
    assert [frame.index for frame in summary.frames] == list(range(SMALL.frames))
    left_out = summary.frames[1]
    assert (left_out.name, left_out.used, left_out.reason) == ("scan/frame0001.png", False, LEFT_OUT)
    results = load_results(folder)
    assert 1 not in results.cloud.frame
    for frame in summary.frames:
        assert np.count_nonzero(results.cloud.frame == frame.index) == frame.points
    assert any("frame0001.png" in note for note in summary.notes)
    inputs = json.loads((results_folder(folder) / "run.json").read_text())["inputs"]
    assert "scan/frame0001.png" not in inputs


def test_all_frames_left_out_is_said_before_the_work(done):
    names = frozenset(frame.name for frame in done.summary.frames)
    with pytest.raises(InputError, match="left out by hand"):
        measure_scan(done.folder, done.with_options(excluded=names))


def test_a_scan_without_two_parallel_faces_is_no_error(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    far = np.array([[0.0, 0.0], [3.0, 0.0], [0.0, 3.0]])
    project = replace(done.project, rig=replace(done.project.rig, gauge=GaugeSpec(50.0, 0.2, far, far + 5)))
    summary = measure_scan(folder, project)
    assert summary.gauge is None
    assert summary.no_gauge.startswith("No thickness was measured")
    assert summary.no_gauge in summary.notes
    assert not (results_folder(folder) / "gauge.json").exists()
    assert make_report(folder, project).exists()


def test_the_thickness_alone_is_measured_again_with_another_nominal_value(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    project = replace(done.project, rig=replace(done.project.rig, gauge=GaugeSpec(45.0, 0.1)))
    gauge = measure_gauge(folder, project)
    assert gauge.thickness_mm == done.summary.gauge.thickness_mm
    assert gauge.verdict == "not conforming"


def test_the_report_prints_what_the_project_says(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    info = ProjectInfo(
        "job", part="Endmass 7", serial="S-17", operator="Ada", customer="Babbage Ltd", laboratory="Room 12",
        air_celsius=20.5, notes="Seen through glass.",
    )  # fmt: skip
    project = replace(done.project, info=info, report=ReportChoices(frozenset({"inputs", "no such section"})))
    text = "\n".join(page.extract_text() for page in PdfReader(str(make_report(folder, project))).pages)
    for words in ("Endmass 7", "S-17", "Ada", "Babbage Ltd", "Room 12", "20.5", "Seen through glass."):
        assert words in text


def test_a_report_that_is_cancelled_leaves_the_old_one(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    before = contents(folder)

    def stop(step, done, total):
        if done == total - 1:
            raise Cancelled

    with pytest.raises(Cancelled):
        make_report(folder, done.project, stop)
    assert contents(folder) == before


def test_results_are_loaded_as_they_were_measured(done):
    results = load_results(done.folder)
    assert len(results.cloud) == done.summary.points
    assert len(results.mesh.triangles) == done.summary.triangles
    assert results.gauge.thickness_mm == done.summary.gauge.thickness_mm
    assert results.frames == done.summary.frames
    assert results.calibration_id == done.summary.calibration_id
    assert results.notes == done.summary.notes
    assert results.problems == ()


def test_results_that_do_not_belong_together_are_not_loaded(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    camera = results_folder(folder) / "camera.json"
    camera.write_text(camera.read_text().replace('"k1": ', '"k1": 1'))
    results = load_results(folder)
    assert results.camera is not None
    assert (results.fan, results.cloud, results.gauge, results.frames) == (None, None, None, ())
    assert "calibrated again" in results.problems[0]


def test_a_project_without_results_loads_nothing_and_complains_of_nothing(tmp_path):
    results = load_results(tmp_path)
    assert (results.cloud, results.gauge, results.problems, dict(results.files)) == (None, None, (), {})


def test_a_view_left_out_has_no_part_in_the_camera_but_its_residuals_are_known(done):
    name = done.seen.views[2].name
    without = solve_views(done.folder, done.with_options(excluded=frozenset({name})), done.seen)
    view = without.views[2]
    assert (view.view.name, view.used, view.reason) == (name, False, LEFT_OUT)
    assert np.isfinite(view.residuals).all()
    assert 0 < view.rms_px < 1
    assert [v.view.name for v in without.views] == [v.view.name for v in done.camera.views]
    assert not np.array_equal(without.camera.matrix, done.camera.camera.matrix)
    alone = replace(done.seen, views=tuple(one for one in done.seen.views if one.name != name))
    assert np.array_equal(without.camera.matrix, solve_views(done.folder, done.project, alone).camera.matrix)
    assert any("left out by hand" in note for note in without.notes)


def test_too_few_views_left_says_so(done):
    names = frozenset(one.name for one in done.seen.views[2:])
    with pytest.raises(InputError, match=r"only 2 of 8 views are not left out by hand"):
        solve_views(done.folder, done.with_options(excluded=names), done.seen)


def test_a_pose_left_out_has_no_part_in_the_fan_and_says_so(done):
    without = solve_poses(done.folder, done.with_options(excluded=frozenset({"planes/pose02"})), done.poses)
    pose = without.poses[2]
    assert (pose.name, pose.used, pose.reason) == ("pose02", False, LEFT_OUT)
    assert pose.pose.translation[2] > 100
    rest = tuple(pose for pose in done.poses if pose.name != "pose02")
    assert np.array_equal(without.fan.pis, solve_poses(done.folder, done.project, rest).fan.pis)


def test_a_fan_need_not_be_a_pencil(done, tmp_path):
    project = done.with_options(constrain_fan=False)
    free = solve_poses(done.folder, project, done.poses)
    assert np.array_equal(free.fan.pis, free.free.pis)
    assert free.verdict.endswith("as asked")
    assert free.constraint_suits == done.fan.constraint_suits
    folder = copy_of(done.folder, tmp_path / "project")
    project = replace(project, accepted=replace(project.accepted, fan=accept_fan(folder, project, free, done.poses)))
    summary = measure_scan(folder, project)
    assert summary.gauge.thickness_mm == pytest.approx(50.0, abs=3 * summary.gauge.U_mm)


def test_killed_in_the_middle_of_replacing_leaves_no_mixture(done, tmp_path, monkeypatch):
    folder = copy_of(done.folder, tmp_path / "project")
    old = contents(results_folder(folder))
    project = done.with_options(excluded=frozenset({"scan/frame0000.png"}))
    measure_scan(copy_of(done.folder, tmp_path / "other"), project)
    new = contents(results_folder(tmp_path / "other"))
    monkeypatch.setattr(shutil, "rmtree", lambda *_, **__: None)
    real, moves = type(folder).replace, []

    def pulled(path, target):
        if target.parent == results_folder(folder):
            moves.append(target.name)
            if len(moves) == 4:
                raise KeyboardInterrupt
        return real(path, target)

    monkeypatch.setattr(type(folder), "replace", pulled)
    with pytest.raises(KeyboardInterrupt):
        measure_scan(folder, project)
    left = {name: data for name, data in contents(results_folder(folder)).items() if "/" not in name}
    assert set(left) == {"camera.json", "planes.json", "planes.npz", "report.pdf"}
    assert all(left[name] in (new[name], old[name]) for name in left)
    assert load_results(folder).cloud is None
