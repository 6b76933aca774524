"""From *Stop* to the verdict: what is left to do of 300 live frames of 2.6 MP, each looked at as it was recorded."""

from __future__ import annotations

import resource
import time
from dataclasses import replace
from pathlib import Path

import cv2

from core.files.project.data import Accepted, Project
from core.files.project.folder import project_from_set
from core.pipeline.compile_ahead import compile_ahead
from core.pipeline.live.recorded_features import RecordedFeatures
from core.pipeline.project.calibration import (
    accept_camera,
    accept_planes,
    accepted_camera,
    find_poses,
    find_views,
    solve_poses,
    solve_views,
)
from core.pipeline.project.interim_check import check_rig
from core.pipeline.project.watched_scan import measure_watched
from core.pipeline.project.workspace import project_set
from core.progress import silent
from core.simulate.recording import simulate_set
from core.simulate.sample import sample_scenario, sample_set
from core.stage_times import StageTimes
from tests.benchmarks.conftest import table

FRAMES = 300
FEWEST = 0.02
"""Share of the whole from which on a stage has a row of its own."""


def processor_s() -> float:
    """Processor time in s of this process and of those it has started and ended."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


def ready_to_scan(recorded: Path, folder: Path) -> Project:
    """A project with accepted calibrations, whose rig has been checked today."""
    project = project_from_set(recorded, "After Stop")
    camera = solve_views(folder, project, find_views(folder, project))
    project = replace(project, accepted=Accepted(accept_camera(folder, project, camera)))
    poses = find_poses(folder, project)
    fan = solve_poses(folder, project, poses)
    planes = accept_planes(folder, project, fan, poses)
    project = replace(project, accepted=replace(project.accepted, planes=planes))
    assert check_rig(folder, project).passed
    return project


def looked_at(folder: Path, project: Project) -> RecordedFeatures:
    """The frames looked at on the way, as a live scan has it done; *Stop* comes next."""
    found = project_set(folder, project)
    settings, camera = project.options.for_scan, accepted_camera(folder, project)
    scan = found.folders["scan"]
    features = RecordedFeatures(scan, ".png", found.rig, camera, settings, lambda: len(found.frames))
    for frame in found.frames:
        features.add(frame.stem)
    while features.unseen:
        time.sleep(0.05)
    return features


def read_by_opencv(folder: Path, project: Project) -> float:
    """Processor time in s of reading all frames and smoothing them once."""
    began = time.process_time()
    for path in project_set(folder, project).frames:
        picture = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
        assert picture is not None
        cv2.GaussianBlur(picture, (0, 0), 2.0)
    return time.process_time() - began


def test_after_stop_the_result_is_there(tmp_path, capsys):
    """What the window does between *Stop* and the verdict."""
    recorded, folder = tmp_path / "set", tmp_path / "project"
    scenario = replace(sample_scenario(), frames=FRAMES, check_poses=3)
    simulate_set(scenario, recorded, calibration_from=sample_set())
    folder.mkdir()
    compile_ahead(silent)
    project = ready_to_scan(recorded, folder)
    features = looked_at(folder, project)
    began, since = processor_s(), time.perf_counter()
    features.finish()
    assert features.wait(600.0)
    kept_s, times = processor_s() - began, StageTimes()
    summary = measure_watched(folder, project, times)
    spent, wall = processor_s() - began, time.perf_counter() - since
    assert summary.gauge is not None and summary.gauge.verdict is not None
    opencv = read_by_opencv(folder, project)
    rows = {
        step: f"{seconds:8.2f} s   {seconds / spent:4.0%}"
        for step, seconds in {"crossings, kept": kept_s, **times.seconds()}.items()
        if seconds >= FEWEST * spent
    }
    table(
        capsys,
        f"From Stop to the verdict: {FRAMES} live frames of 2.6 MP, processor time of both processes",
        {
            **rows,
            "all": f"{spent:8.2f} s          {spent / opencv:.2f} of OpenCV's reading and smoothing every frame",
            "OpenCV: reading and smoothing every frame": f"{opencv:8.2f} s",
            "time it took": f"{wall:8.2f} s          (required: 5 s on 2 quiet cores)",
        },
    )
