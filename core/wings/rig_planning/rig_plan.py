"""What a rig will measure, foretold for the window: rows in its language, and the σ of every place in the picture."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from core.files.atomic import write_text
from core.files.project.data import Project
from core.files.recording.recording_set import CHECK, RIG
from core.files.recording.rig import rig_tables
from core.files.toml_text import toml_text
from core.inspect.results import GaugeResult
from core.model import Camera, Fan
from core.model.arrays import Array
from core.pipeline.project.details import accepted_calibration
from core.pipeline.project.results import load_results
from core.pipeline.project.workspace import project_set, rig_in_its_air
from core.progress import Progress, silent
from core.report.wording import Words
from core.settings.options import Options
from core.wings.rig_planning.plan_step import PlanResult, plan, write_plan
from core.wings.rig_planning.plan_words import plan_rows
from core.wings.rig_planning.prediction.design import RANGES

PLANNED_RIG = "planned-rig.toml"
"""The rig that was planned, with what was known of it, beside its plan: to be changed and planned again."""


@dataclass(frozen=True, eq=False, slots=True)
class ForetoldRig:
    """Prediction of a rig, to be shown.

    Parameters
    ----------
    rows
        Name and value of each thing that is foretold.
    sigma_mm
        (H, W) standard uncertainty of a depth in mm, own and common part together; NaN where nothing is measured.
    image_size
        Width and height of the whole picture in pixels, which the map covers.
    result
        The plan itself, to be written.
    rig
        The rig.toml of a rig that has none of its own: that of a project.
    """

    rows: list[tuple[str, str]]
    sigma_mm: Array
    image_size: tuple[int, int]
    result: PlanResult
    rig: str = ""


def foretell_rig(rig: Path, language: str, progress: Progress = silent, options: Options | None = None) -> ForetoldRig:
    """Predict what the planned rig in a rig.toml will measure, worded in `language` for the window.

    Raises
    ------
    InputError
        If the file cannot be read, or the rig cannot measure a block.
    """
    result = plan(rig, options=options, progress=progress)
    sigma = result.largest.sigma
    return ForetoldRig(
        plan_rows(result, Words.of(language)), np.hypot(sigma.own, sigma.common), result.design.pixels, result
    )


def foretell_project(folder: Path, project: Project, language: str, progress: Progress = silent) -> ForetoldRig:
    """Predict what the rig of a project will measure; what the project does not know is as in the paper's rig.

    Targets, laser, part and stability are those of the project; camera and distance of the laser those of the accepted
    calibrations; distance and height of the part as they were measured; as many pictures as there are.

    Raises
    ------
    InputError
        If a file of the project is damaged, or the rig cannot measure a block.
    """
    text = toml_text({**rig_tables(rig_in_its_air(project)), "plan": _known(folder, project)})
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as place:
        file = Path(place) / RIG
        write_text(file, text, sync=False)
        foretold = foretell_rig(file, language, progress, project.options)
    return replace(foretold, rig=text)


def write_foretold(foretold: ForetoldRig, folder: Path) -> Mapping[str, Path]:
    """Write plan.json and sigma.png of a prediction into `folder`, and a project's rig as planned-rig.toml."""
    files = dict(write_plan(foretold.result, folder))
    if foretold.rig:
        files["rig"] = folder / PLANNED_RIG
        write_text(files["rig"], foretold.rig)
    return files


def _known(folder: Path, project: Project) -> dict[str, Any]:
    """The table [plan] of what is known of a project's rig."""
    camera, fan, _ = accepted_calibration(folder, project)
    gauge = load_results(folder).gauge
    known = {**_of_camera(camera), **_of_fan(fan), **_of_part(gauge, project), **_counts(folder, project)}
    return {name: value for name, value in known.items() if name not in RANGES or _possible(name, value)}


def _possible(name: str, value: float) -> bool:
    low, high, _ = RANGES[name]
    return low <= value <= high


def _of_camera(camera: Camera | None) -> dict[str, Any]:
    if camera is None:
        return {}
    focal = float(np.sqrt(camera.matrix[0, 0] * camera.matrix[1, 1]))
    return {"pixels": list(camera.image_size), "focal_px": round(focal, 2)}


def _of_fan(fan: Fan | None) -> dict[str, Any]:
    """How far from the optical axis the line in which the planes meet passes, where it crosses the picture's middle."""
    if fan is None or len(fan.pis) < 2:
        return {}
    middle = fan.pis.mean(axis=0)
    across = np.linalg.svd(fan.pis - middle)[2][0]
    along = int(np.argmax(np.abs(np.cross(middle, across)[:2])))  # of the picture's x and y, what it runs along
    point = np.linalg.solve(np.array([middle, across, np.eye(3)[along]]), [1.0, 0.0, 0.0])
    return {"baseline_mm": round(abs(float(point[1 - along])), 2)}


def _of_part(gauge: GaugeResult | None, project: Project) -> dict[str, Any]:
    """How far what the part stands on is along the optical axis; its thickness where no nominal one is stated."""
    if gauge is None:
        return {}
    stated = project.rig.gauge is not None and project.rig.gauge.nominal_mm is not None
    height = {} if stated else {"heights_mm": [round(max(gauge.thickness_mm, 1.0), 2)]}
    return {"distance_mm": round(1.0 / float(gauge.lower.plane.pi[2]), 1), **height}


def _counts(folder: Path, project: Project) -> dict[str, Any]:
    recording_set = project_set(folder, project)
    pictures = {
        "views": ("camera", recording_set.camera),
        "poses": ("planes", recording_set.planes),
        "sweeps": ("scan", recording_set.frames),
    }
    counts = {name: len(there) - len(project.options.excluded_in(part)) for name, (part, there) in pictures.items()}
    return {**counts, "check_poses": len(recording_set.check) - len(project.options.excluded_in(CHECK))}
