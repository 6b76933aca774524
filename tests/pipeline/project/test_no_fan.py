"""A set without a fan, opened as a project: its scan is measured with camera and known planes, and shown."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from core.files.project.data import Project, ProjectFile
from core.files.project.folder import create_project, project_from_set
from core.pipeline.project.calibration import accept_camera, find_views, solve_views
from core.pipeline.project.details import show_frame, show_scan
from core.pipeline.project.measuring import measure_scan
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


def test_a_scan_is_measured_with_camera_and_boards_and_shows_them(project: tuple[Path, Project]) -> None:
    folder, made = project
    watched: list[FramePreview] = []
    summary = measure_scan(folder, made, watch=watched.append)
    assert summary.points > 1000 and not (folder / "results" / "planes.json").exists()
    assert len(watched) == CORNER.frames and all(one.centrelines and not one.hints for one in watched)
    assert {one.reason for one in watched} == {None}
    look = show_scan(folder)
    assert len(look) == summary.points and look.problems == ()
    assert sorted(look.known_planes) == ["far", "near"]
    assert all(outline.shape[1] == 2 for outline in look.known_planes.values())
    stages = show_frame(folder, made, "scan/frame0005.png")
    assert stages.sweep and stages.fan == () and stages.seen is None and stages.reason is None
