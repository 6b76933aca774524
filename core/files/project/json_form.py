"""project.json as text: readable by people, the same bytes for the same project, checked key by key."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, fields
from datetime import datetime
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, create_model

from core import __version__
from core.errors import InputError
from core.files.complaints import checked_json
from core.files.json_text import to_json
from core.files.plan.tables import PlanTables
from core.files.plan.translation import plan_of, plan_tables
from core.files.project.data import (
    EARLIER_CALIBRATIONS,
    Accepted,
    Done,
    Id,
    KeptStudy,
    Project,
    ProjectFile,
    ProjectInfo,
    Repeat,
    ReportChoices,
    Sources,
)
from core.files.reading import read_json
from core.files.recording.rig import RigTables, Table, rig_of, rig_tables
from core.files.results.artefact_register import ArtefactTable
from core.files.tables import TIME_WORDS, Finite, Time, kept
from core.messages import Message
from core.settings.options import Options
from core.settings.setting import Choice, Kind, Names, Number, Row, Values, Whether, rows, rows_within


def _all_checked(settings: Sequence[Row]) -> dict[str, Any]:
    return {row.key: _checked(row) for row in settings if row.setting.in_file}


def _checked(row: Row) -> tuple[Any, Any]:
    """What a file may hold of a setting, and how it is told so."""
    kind = row.setting.kind
    allowed: Any
    if isinstance(kind, Values):
        if kind.optional:
            return kind.type | None, Field(default=row.default, description=kind.stated)
        within = create_model(f"{kind.type.__name__}Table", __base__=Table, **_all_checked(rows_within(row)))
        return within, within()
    if isinstance(kind, Number):
        allowed = Annotated[float, Field(gt=kind.above, le=kind.most, allow_inf_nan=False)]
    elif isinstance(kind, Choice):
        if kind.type is not None:
            return kind.type, Field(default=row.default, strict=False, description=kind.stated)
        if True in kind.values:  # true, false, or as it is best
            return bool | None, row.default
        allowed = Literal[kind.values]
    elif isinstance(kind, Names):
        allowed = frozenset[Annotated[str, Field(pattern=kind.pattern)]]
    else:
        return (bool if isinstance(kind, Whether) else str), row.default
    return allowed, Field(default=row.default, description=kind.stated)


OptionsTable = create_model("OptionsTable", __base__=Table, **_all_checked(rows(Options)))
"""Under "options"."""


class ProjectTables(Table):
    """Tables of project.json."""

    schema_version: int
    version: str = ""
    created: Time | None = Field(default=None, description=TIME_WORDS)
    saved: Time | None = Field(default=None, description=TIME_WORDS)
    info: ProjectInfo = Field(description="a table of name, part, …")
    rig: RigTables = Field(description="a table as in rig.toml")
    sources: Sources = Sources()
    options: OptionsTable = OptionsTable()  # type: ignore[valid-type]
    accepted: Accepted = Accepted()
    rejected: frozenset[Id] = Field(default=frozenset(), description="a list of ids of calibrations")
    repeats: tuple[Repeat, ...] = ()
    report: ReportChoices = ReportChoices()
    inspection: PlanTables = PlanTables()
    studies: tuple[KeptStudy, ...] = ()
    artefacts: tuple[ArtefactTable, ...] = ()
    callouts: dict[str, tuple[Finite, Finite]] = Field(
        default_factory=dict, description="a table of two numbers each, in pixels"
    )
    plate_beside: bool | None = Field(default=None, description="true, false or null")
    results: dict[str, Done] = Field(default_factory=dict)


_EARLIER_STEPS = {"inspect": "gauge", "features": "inspection"}
"""Names of results up to schema 9."""
SCHEMA = 13
"""Raised with every change of the keys: an older program then says that the project is too new for it."""

MIGRATIONS: Mapping[int, Callable[[dict[str, Any]], dict[str, Any]]] = {
    1: lambda tables: {**tables, "rejected": []},
    2: lambda tables: tables,  # language and template of the report, which have defaults
    3: lambda tables: tables,  # the plan of the inspection, which may be empty
    4: lambda tables: tables,  # studies, which may be none
    5: lambda tables: tables,  # the folder of an interim check, which need not be there
    6: lambda tables: tables,  # known artefacts, which may be none
    7: lambda tables: (
        tables
    ),  # kinds of artefacts, which were all blocks; titles of studies as messages, English before
    8: lambda tables: tables,  # k3 of the camera, which was free or zero: it stays as the camera was calibrated
    9: lambda tables: {**tables, "results": _renamed(tables.get("results", {}), _EARLIER_STEPS)},
    10: lambda tables: {**tables, "accepted": _renamed(tables.get("accepted", {}), EARLIER_CALIBRATIONS)},
    11: lambda tables: tables,  # certificates of targets, laboratories of artefacts, places of callouts: may be none
    12: lambda tables: tables,  # whether the plate is left beside the part, which need not be answered
}
"""By schema: the tables as the next schema has them, from those of this one."""


def _renamed(table: Any, names: Mapping[str, str]) -> Any:
    """A table by the names of the steps as they are now; what is no table is complained of later."""
    if not isinstance(table, dict):
        return table
    return {names.get(step, step): value for step, value in table.items()}


_TODO = Message("advice.open_backup", "open a version in backups, or make a new project")


class NewerProject(InputError):
    """Error that a newer program has written the project: nothing is wrong with it."""


def project_text(file: ProjectFile, path: Path) -> str:
    """Make the text of the file project.json of a project, checked.

    Raises
    ------
    InputError
        If a value is not what it must be, so that the file could not be read again; `path` is for the complaint.
    """
    tables = project_tables(file)
    checked_json(ProjectTables, tables, path)
    return to_json(tables)


def project_tables(file: ProjectFile) -> dict[str, Any]:
    """Make the tables of project.json for a project, values not checked."""
    project = file.project
    return {
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
        "repeats": [{**repeat.values, "measured_at": _stamp(repeat.measured_at)} for repeat in project.repeats],
        "report": {**asdict(project.report), "hidden": sorted(project.report.hidden)},
        "inspection": plan_tables(project.inspection),
        "studies": [{**asdict(study), "title": kept(study.title)} for study in project.studies],
        "artefacts": [{**asdict(one), "due": one.due and one.due.isoformat()} for one in project.artefacts],
        "callouts": {name: list(moved) for name, moved in sorted(project.callouts.items())},
        "plate_beside": project.plate_beside,
        "results": {step: _done_table(done) for step, done in sorted(file.results.items())},
    }


def read_project_text(path: Path) -> ProjectFile:
    """Read and check the project in a file like project.json; InputError if it is damaged, wrong or of a newer program.

    Raises
    ------
    InputError
        If it is missing or damaged, was written by a newer program, or has an unknown key or a wrong value; names the
        file and the field.
    """
    tables = read_json(path, todo=_TODO)
    if not isinstance(tables, dict) or type(tables.get("schema_version")) is not int:  # true would count as 1
        raise InputError(
            Message("project.no_schema_version", "this is no project: there is no schema version in it"),
            where=path,
            todo=_TODO,
        )
    schema = tables["schema_version"]
    if schema > SCHEMA:
        raise NewerProject(
            Message(
                "project.newer_program",
                "the project was written by a newer program "
                "(schema version {schema}, this program knows up to {known})",
                schema=schema,
                known=SCHEMA,
            ),
            where=path,
            todo=Message("advice.open_with_newer_program", "open it with a newer version of Trisect"),
        )
    while schema < SCHEMA:
        if schema not in MIGRATIONS:
            raise InputError(
                Message(
                    "project.unknown_schema_version",
                    "schema_version is {schema}, not a whole number from 1 to {schema2}",
                    schema=schema,
                    schema2=SCHEMA,
                ),
                where=path,
                todo=_TODO,
            )
        tables = MIGRATIONS[schema](tables)
        schema += 1
    return _project_file(checked_json(ProjectTables, {**tables, "schema_version": SCHEMA}, path), path)


def _project_file(file: ProjectTables, path: Path) -> ProjectFile:
    project = Project(
        info=file.info,
        rig=rig_of(file.rig, path, within="rig."),
        sources=file.sources,
        options=_options(file.options),
        accepted=file.accepted,
        rejected=file.rejected,
        repeats=file.repeats,
        report=file.report,
        inspection=plan_of(file.inspection, path),
        studies=file.studies,
        artefacts=tuple(table.artefact() for table in file.artefacts),
        callouts=dict(file.callouts),
        plate_beside=file.plate_beside,
    )
    return ProjectFile(project, file.results, file.created, file.saved)


def _options(table: Table) -> Options:
    stated = dict(table)
    for row in rows(Options):
        if not row.is_one:
            stated[row.key] = type(row.default)(**dict(stated[row.key]))
    return Options(**stated)


def _options_table(options: Options) -> dict[str, Any]:
    return {row.key: _kept(row.setting.kind, row.value(options)) for row in rows(Options) if row.setting.in_file}


def _kept(kind: Kind, value: Any) -> Any:
    """A value as a file has it: names in their order."""
    if isinstance(kind, Values) and value is not None:
        return {one.name: _kept(kind.settings[one.name].kind, getattr(value, one.name)) for one in fields(kind.type)}
    return sorted(value) if isinstance(kind, Names) else value


def _done_table(done: Done) -> dict[str, Any]:
    return {"key": done.key, "rests_on": dict(sorted(done.rests_on.items())), "at": _stamp(done.at)}


def _stamp(time: datetime | None) -> str | None:
    """A time with its zone; one without is local."""
    if time is None:
        return None
    return (time if time.tzinfo else time.astimezone()).isoformat()
