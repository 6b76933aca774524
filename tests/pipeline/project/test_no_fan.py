"""A set without a fan, opened as a project: its scan is measured with camera and known planes, and shown."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from core.acquire.settings import SourceSettings
from core.acquire.source import SourceChoice
from core.calibrate.results import NO_FAN
from core.cli.measuring import rig_history
from core.cli.recording import request
from core.files.pictures import read_picture
from core.files.project.data import Project, ProjectFile
from core.files.project.folder import create_project, project_from_set, results_folder
from core.files.recording.recording_set import open_set
from core.pipeline.live.preview import ScanPreviewer
from core.pipeline.project.calibration import accept_camera, find_views, solve_views
from core.pipeline.project.details import show_frame, show_scan
from core.pipeline.project.measuring import measure_scan
from core.pipeline.steps.gauge_step import gauge_step
from core.pipeline.steps.master_step import measured_master
from core.pipeline.steps.workspace import Workspace, read_calibration
from core.scan.preview.shown import FramePreview
from core.simulate.effects.boards import BoardsBeside
from core.simulate.recording import simulate_set
from core.simulate.scenario import Scenario

CORNER = Scenario(
    scale=0.25, frames=12, camera_views=8, seed=3, fan_lines=0, boards=BoardsBeside(corner=True, kind="rectangle")
)


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Project]:
    """The project with its camera accepted."""
    base = tmp_path_factory.mktemp("corner")
    simulate_set(CORNER, base / "set")
    made = project_from_set(base / "set", "Corner")
    made = replace(made, options=replace(made.options, sigma_cut_mm=0.5))
    create_project(base / "project", ProjectFile(made))
    id_ = accept_camera(base / "project", made, solve_views(base / "project", made, find_views(base / "project", made)))
    return base / "project", replace(made, accepted=replace(made.accepted, camera=id_))


@pytest.fixture(scope="module")
def watched(project: tuple[Path, Project]) -> list[FramePreview]:
    """What was shown of the frames while the scan was measured."""
    shown: list[FramePreview] = []
    measure_scan(*project, watch=shown.append)
    return shown


def test_a_scan_is_measured_with_camera_and_boards_and_shows_them(
    project: tuple[Path, Project], watched: list[FramePreview]
) -> None:
    folder, made = project
    assert not (folder / "results" / "planes.json").exists()
    assert len(watched) == CORNER.frames and all(one.centrelines and not one.hints for one in watched)
    assert {one.reason for one in watched} == {None}
    look = show_scan(folder)
    assert len(look) > 1000 and look.problems == ()
    assert sorted(look.known_planes) == ["far", "near"]
    assert all(outline.shape[1] == 2 for outline in look.known_planes.values())
    stages = show_frame(folder, made, "scan/frame0005.png")
    assert stages.sweep and stages.fan == () and stages.seen is None and stages.reason is None


@pytest.mark.usefixtures("watched")
def test_the_camera_alone_is_the_calibration_of_a_rig_without_a_fan(project: tuple[Path, Project]) -> None:
    folder, made = project
    results, as_set = results_folder(folder), folder.parent / "set"
    assert read_calibration(results).fan is NO_FAN and read_calibration(results).id.startswith(made.accepted.camera)
    history, _ = rig_history(as_set, results)
    assert history.checks == ()
    gauge = gauge_step(Workspace.open(open_set(as_set), results))
    master = measured_master(folder, None, folder)
    assert master.measured_mm == gauge.thickness_mm and master.same_calibration
    wanted = request(as_set, "scan", SourceChoice("simulated", ""), results, SourceSettings(), ".png")
    assert wanted.camera is not None and wanted.fan is not None and not wanted.fan.lines
    reader = ScanPreviewer(wanted.camera, wanted.fan, has_fan=wanted.rig.has_fan)
    reader.read_reference(read_picture(as_set / "scan" / "reference.png"))
    assert reader.fan_lines == ((),)
