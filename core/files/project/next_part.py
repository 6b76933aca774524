"""The next part of a series: a project with the calibrations, plan and report of another, and nothing of its part."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from core.errors import InputError
from core.files.atomic import folder_beside, make_folder
from core.files.project.calibration_store import FOLDER as CALIBRATIONS
from core.files.project.data import Project, ProjectFile, Sources
from core.files.project.folder import create_project, read_project, require_free, source_folder
from core.files.project.keys import relocated
from core.files.project.report_template import logo_beside
from core.files.project.witness import Signed, Written, witnessed
from core.files.reading import resolved
from core.files.results.nominal_surface import nominal_names
from core.held_files import rename
from core.inspect.plan.feature_spec import FaceAt, Polygon
from core.messages import Message
from core.progress import Progress, silent, steps

KEPT = ("camera", "planes")
"""Results that hold for the next part, too."""


def next_part(
    folder: Path, to: Path, serial: str, operator: str, by: Signed | None = None, progress: Progress = silent
) -> Path:
    """Make the project `to` for the next part of the series in the project `folder`, and return its path.

    Taken over: rig, settings, accepted calibrations and their history, the pictures of calibration and check where they
    lie, features with their limits, the report's choices and template; by a wing, the people and their roles. Left
    behind: the recording and everything measured on it, temperatures, notes, repeats and studies.

    Parameters
    ----------
    folder, to
        The project that is there, and the folder to be made: whole or not at all.
    serial, operator
        Of the next part, and of who measures it; neither may be empty.
    by
        Who has signed in, for those who witness it.

    Raises
    ------
    InputError
        If `to` is there already, serial number or operator are empty, a file cannot be read, or nothing can be written.
    """
    require_free(to)
    if not serial.strip() or not operator.strip():
        raise InputError(
            Message("project.next_part_unnamed", "serial number and operator must be given: the report needs both"),
            where=to,
        )
    file = read_project(folder)
    copied = list(_copied(folder, file.project))
    with folder_beside(to) as beside:
        made = make_folder(beside / to.name)
        create_project(made, _renewed(folder, file, serial.strip(), operator.strip(), to.name))
        with witnessed(made, Written("next part", by=by, of=folder)):
            for path in steps(copied, progress, "copying", len(copied)):
                place = made / path.relative_to(resolved(folder))
                place.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(path, place)
        rename(made, to)
    return to


def _renewed(folder: Path, file: ProjectFile, serial: str, operator: str, name: str) -> ProjectFile:
    """Project and results as they are for the next part."""
    own = {stored: source_folder(folder, stored) for stored in _stored(file.project.sources)}
    file = relocated(file, {stored: str(resolved(place)) for stored, place in own.items() if place is not None})
    before = file.project
    info = replace(
        before.info, name=name, serial=serial, operator=operator, air_celsius=None, part_celsius=None, notes=""
    )
    kept = frozenset(one for one in before.options.excluded if not one.startswith("scan/"))
    after = replace(
        before,
        info=info,
        rig=replace(
            before.rig,
            part=replace(before.rig.part, celsius=None, u_celsius=None),
            air=replace(before.rig.air, scanned=None),
            simulated=None,
        ),
        sources=replace(before.sources, scan=""),
        options=replace(before.options, excluded=kept),
        repeats=(),
        studies=(),
    )
    return ProjectFile(after, {step: done for step, done in file.results.items() if step in KEPT})


def _stored(sources: Sources) -> Iterator[str]:
    yield from (one for one in (sources.camera, sources.planes, sources.check) if one)


def _copied(folder: Path, project: Project) -> Iterator[Path]:
    """Files of the project that the next part needs: calibrations, and those that plan and report name."""
    home = resolved(folder)
    yield from sorted(path for path in (home / CALIBRATIONS).rglob("*") if path.is_file())
    for stored in (*nominal_names(project.inspection), project.report.template):
        path = resolved(home / stored) if stored else home
        if path.is_file() and path.is_relative_to(home):
            yield path
            if stored == project.report.template and (logo := logo_beside(path)) is not None:
                yield logo


def drawn_in_picture(project: Project) -> bool:
    """Whether the project has faces or sections in px of the picture, which hold only for a part in the same place."""
    gauge, features = project.rig.gauge, project.inspection.features
    polygons = gauge is not None and (gauge.upper_polygon_px is not None or gauge.lower_polygon_px is not None)
    regions = [region for feature in features for region in feature.regions]
    pixels = any(isinstance(one, Polygon) or (isinstance(one, FaceAt) and one.at_px is not None) for one in regions)
    return polygons or pixels or any(one.section is not None and one.section.line_px is not None for one in features)
