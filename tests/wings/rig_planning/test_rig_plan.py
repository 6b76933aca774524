"""The rig of a project is planned as far as it is known: from what is stated, calibrated and measured."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from core.files.project.data import Project, new_project
from core.files.project.folder import read_project
from core.pipeline.project.details import accepted_calibration
from core.pipeline.project.workspace import project_set
from core.settings.options import Options
from core.simulate.rig import pencil_fan
from core.wings.rig_planning import rig_plan
from core.wings.rig_planning.prediction.design import Design
from core.wings.rig_planning.prediction.from_rig import read_design
from core.wings.rig_planning.rig_plan import ForetoldRig, foretell_project, write_foretold

CUT_MM = 0.123


@pytest.fixture
def planned(monkeypatch: pytest.MonkeyPatch) -> list[Design]:
    """Planning takes no time: the designs that were asked for."""
    asked: list[Design] = []

    def plan(rig: Path, language: str, progress: Any, options: Options) -> ForetoldRig:
        assert options.sigma_cut_mm == CUT_MM, "points are left out as in the project's scan"
        asked.append(read_design(rig))
        return ForetoldRig([], np.zeros((1, 1)), (1, 1), None)  # type: ignore[arg-type]

    monkeypatch.setattr(rig_plan, "foretell_rig", plan)
    return asked


def cut(project: Project) -> Project:
    return replace(project, options=replace(project.options, sigma_cut_mm=CUT_MM))


def test_what_a_measured_project_shows_of_its_rig_is_planned(
    planned: list[Design], finished_project_folder: Path
) -> None:
    project = cut(read_project(finished_project_folder).project)
    foretell_project(finished_project_folder, project, "en")
    (design,) = planned
    camera, fan, _ = accepted_calibration(finished_project_folder, project)
    assert camera is not None and fan is not None
    assert design.pixels == camera.image_size
    assert design.focal_px == pytest.approx(float(np.sqrt(camera.matrix[0, 0] * camera.matrix[1, 1])), rel=1e-3)
    assert design.baseline_mm == pytest.approx(Design().baseline_mm, abs=3), "the simulated rig is the paper's"
    assert design.distance_mm == pytest.approx(Design().distance_mm, abs=5)
    recording_set = project_set(finished_project_folder, project)
    assert (design.views, design.poses, design.sweeps) == (
        len(recording_set.camera),
        len(recording_set.planes),
        len(recording_set.frames),
    )
    assert (design.camera_target, design.plane_target) == (project.rig.camera_target, project.rig.plane_target)


def test_pictures_left_out_do_not_count_and_a_stated_thickness_goes_before_a_measured_one(
    planned: list[Design], finished_project_folder: Path
) -> None:
    project = cut(read_project(finished_project_folder).project)
    recording_set = project_set(finished_project_folder, project)
    out = frozenset({f"camera/{recording_set.camera[0].name}"})
    foretell_project(finished_project_folder, replace(project, options=replace(project.options, excluded=out)), "en")
    assert planned[0].views == len(recording_set.camera) - 1
    stated = project.rig.gauge.nominal_mm if project.rig.gauge is not None else None
    assert stated is not None and planned[0].heights_mm == (stated,)


def test_of_a_project_with_nothing_measured_only_what_is_stated_is_known(planned: list[Design], tmp_path: Path) -> None:
    project = cut(new_project("New"))
    foretell_project(tmp_path, project, "en")
    paper = Design()
    assert (planned[0].pixels, planned[0].baseline_mm, planned[0].views) == (
        paper.pixels,
        paper.baseline_mm,
        paper.views,
    )


def test_the_distance_of_the_fan_is_that_of_the_line_in_which_its_planes_meet() -> None:
    assert rig_plan._of_fan(pencil_fan())["baseline_mm"] == pytest.approx(Design().baseline_mm, abs=0.1)


def test_the_planned_rig_is_written_beside_its_plan(
    planned: list[Design], finished_project_folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rig_plan, "write_plan", lambda result, folder: {})
    project = cut(read_project(finished_project_folder).project)
    files = write_foretold(foretell_project(finished_project_folder, project, "en"), tmp_path)
    assert list(files) == ["rig"] and read_design(files["rig"]) == planned[0]
