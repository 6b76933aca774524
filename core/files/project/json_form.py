"""project.json as text: readable by people, the same bytes for the same project, checked key by key."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict
from datetime import datetime
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from core import __version__
from core.calibrate.camera_options import CameraOptions
from core.errors import InputError
from core.files.complaints import complaint
from core.files.inspection_plan_translation import plan_of, plan_tables
from core.files.json_text import read_json, to_json
from core.files.options import Options
from core.files.project_data import (
    Accepted,
    Done,
    KeptStudy,
    Project,
    ProjectFile,
    ProjectInfo,
    Repeat,
    ReportChoices,
    Sources,
)
from core.files.project_tables import OptionsTable, ProjectTables
from core.files.rig import rig_of, rig_tables
from core.image.stripe import StripeSettings

SCHEMA = 5
"""Raised with every change of the keys: an older program then says that the project is too new for it."""

MIGRATIONS: Mapping[int, Callable[[dict[str, Any]], dict[str, Any]]] = {
    1: lambda tables: {**tables, "rejected": []},
    2: lambda tables: tables,  # language and template of the report, which have defaults
    3: lambda tables: tables,  # the plan of the inspection, which may be empty
    4: lambda tables: tables,  # studies, which may be none
}
"""By schema: the tables as the next schema has them, from those of this one."""

_TODO = "open a version in backups, or make a new project"


class NewerProject(InputError):
    """The project was written by a newer program: nothing is wrong with it."""


def project_text(file: ProjectFile, path: Path) -> str:
    """What project.json says of `file`.

    Raises
    ------
    InputError
        If a value is not what it must be, so that the file could not be read again; `path` is for the complaint.
    """
    project = file.project
    tables = {
        "schema_version": SCHEMA,
        "version": __version__,
        "created": _stamp(file.created),
        "saved": _stamp(file.saved),
        "info": asdict(project.info),
        "rig": rig_tables(project.rig),
        "sources": asdict(project.sources),
        "options": _options_table(project.options),
        "accepted": asdict(project.accepted),
        "rejected": sorted(project.rejected),
        "repeats": [{**asdict(repeat), "measured_at": _stamp(repeat.measured_at)} for repeat in project.repeats],
        "report": {**asdict(project.report), "hidden": sorted(project.report.hidden)},
        "inspection": plan_tables(project.inspection),
        "studies": [asdict(study) for study in project.studies],
        "results": {step: _done_table(done) for step, done in sorted(file.results.items())},
    }
    _checked(tables, path)
    return to_json(tables)


def read_project_text(path: Path) -> ProjectFile:
    """Read what :func:`project_text` wrote to `path`.

    Raises
    ------
    InputError
        If it is missing or damaged, was written by a newer program, or has an unknown key or a wrong value; names the
        file and the field.
    """
    tables = read_json(path, todo=_TODO)
    if not isinstance(tables, dict) or type(tables.get("schema_version")) is not int:  # true would count as 1
        raise InputError("this is no project: there is no schema version in it", where=path, todo=_TODO)
    schema = tables["schema_version"]
    if schema > SCHEMA:
        raise NewerProject(
            f"the project was written by a newer program (schema version {schema}, this program knows up to {SCHEMA})",
            where=path,
            todo="open it with a newer version of Trisect",
        )
    while schema < SCHEMA:
        if schema not in MIGRATIONS:
            raise InputError(
                f"schema_version is {schema}, not a whole number from 1 to {SCHEMA}", where=path, todo=_TODO
            )
        tables = MIGRATIONS[schema](tables)
        schema += 1
    return _project_file(_checked({**tables, "schema_version": SCHEMA}, path), path)


def _checked(tables: Mapping[str, Any], path: Path) -> ProjectTables:
    try:
        return ProjectTables.model_validate(tables)
    except ValidationError as error:
        raise complaint(path, error, ProjectTables) from error


def _project_file(file: ProjectTables, path: Path) -> ProjectFile:
    report, repeats = file.report, file.repeats
    project = Project(
        info=ProjectInfo(**dict(file.info)),
        rig=rig_of(file.rig, path, within="rig."),
        sources=Sources(**dict(file.sources)),
        options=_options(file.options),
        accepted=Accepted(**dict(file.accepted)),
        rejected=frozenset(file.rejected),
        repeats=tuple(Repeat(**dict(repeat)) for repeat in repeats),
        report=ReportChoices(**{**dict(report), "hidden": frozenset(report.hidden)}),
        inspection=plan_of(file.inspection, path),
        studies=tuple(KeptStudy(**dict(study)) for study in file.studies),
    )
    results = {step: Done(done.key, done.rests_on, done.at) for step, done in file.results.items()}
    return ProjectFile(project, results, file.created, file.saved)


def _options(table: OptionsTable) -> Options:
    camera = CameraOptions(**{**dict(table.camera), "fixed": frozenset(table.camera.fixed)})
    stripe = StripeSettings(table.stripe.width_px, table.stripe.contrast) if table.stripe else None
    return Options(**{**dict(table), "camera": camera, "stripe": stripe, "excluded": frozenset(table.excluded)})


def _options_table(options: Options) -> dict[str, Any]:
    table = asdict(options)
    table["camera"]["fixed"] = sorted(options.camera.fixed)
    return {**table, "excluded": sorted(options.excluded)}


def _done_table(done: Done) -> dict[str, Any]:
    return {"key": done.key, "rests_on": dict(sorted(done.rests_on.items())), "at": _stamp(done.at)}


def _stamp(time: datetime | None) -> str | None:
    """A time with its zone; one without is local."""
    if time is None:
        return None
    return (time if time.tzinfo else time.astimezone()).isoformat()
