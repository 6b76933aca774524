"""What the steps of a project work on: its pictures as one recording set, and its results.

All steps of a project (`project_calibration`, `project_measuring`, `project_report`) can be called in another process:
their arguments and results can be pickled. What takes long takes a `progress` last.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from core.calibrate.drift import NO_DRIFT
from core.files.atomic import make_inner_folder
from core.files.project.data import Project
from core.files.project.folder import RESULTS, source_folder
from core.files.recording.recording_set import RecordingSet, gather_set
from core.files.recording.rig import Rig
from core.pipeline.steps.workspace import Workspace


def project_set(folder: Path, project: Project) -> RecordingSet:
    """Make one recording set of a project's pictures, with the names they would have in the folder of a set.

    Raises
    ------
    InputError
        If pictures of one part are not all of one size, or one folder is to be two parts.
    """
    sources = project.sources
    names = (sources.camera, sources.planes, sources.scan, sources.check)
    camera, planes, scan, check = (source_folder(folder, name) for name in names)
    return gather_set(rig_in_its_air(project), camera, planes, scan, project.info.name, check)


def rig_in_its_air(project: Project) -> Rig:
    """Copy a project's rig, with temperatures of check and scan that are not stated set to the air's.

    Only where the calibration's temperature or a drift is stated.
    """
    rig, celsius = project.rig, project.info.air_celsius
    air = rig.air
    if air.calibrated is None and rig.drift == NO_DRIFT:
        return rig
    checked, scanned = (celsius if one is None else one for one in (air.checked, air.scanned))
    return replace(rig, air=replace(air, checked=checked, scanned=scanned))


def part_name(project: Project) -> str:
    """Return the part's name, or the project's name where the part has none."""
    return project.info.part or project.options.part or project.info.name


def project_workspace(folder: Path, project: Project) -> Workspace:
    """Make the workspace of a project: its pictures as a recording set, and its folder of results.

    InputError as `project_set` and `Workspace.open`.
    """
    return Workspace.open(project_set(folder, project), make_inner_folder(folder, RESULTS), part_name(project))
