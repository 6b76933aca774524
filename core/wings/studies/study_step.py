"""Studies of a project: made from a table, kept beside it by what they say, looked at, handed over."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Literal, TypeAlias, cast

from core.errors import InputError, WrongValue
from core.files.atomic import make_inner_folder, write_bytes, write_text
from core.files.csv_text import harmless_table
from core.files.json_text import to_json
from core.files.project.data import KeptStudy
from core.files.project.folder import STUDIES, is_project, read_project, results_folder, study_path
from core.files.reading import read_bytes, read_text
from core.findings.proof import Doubts
from core.messages import Message, label
from core.progress import Progress, silent
from core.wings.studies.acceptance_step import Artefact, read_positions
from core.wings.studies.files.input import Repeats, crossed_of, readings_of, repeats_of
from core.wings.studies.files.results import measured_in
from core.wings.studies.files.study_file import read_study, study_values, write_study
from core.wings.studies.files.table import DOUBTS, separator_of, table_of
from core.wings.studies.kinds.acceptance import AcceptanceCheck, Quantity, acceptance_check
from core.wings.studies.kinds.doubted import doubted_among
from core.wings.studies.kinds.grr import GrrStudy, grr_study
from core.wings.studies.kinds.repeats import THICKNESS
from core.wings.studies.kinds.series import SeriesStudy, series_study, stated_uncertainty
from core.wings.studies.kinds.study import Study, kind_of
from core.wings.studies.kinds.type1 import Type1Study, type1_study

Kind = Literal["grr", "acceptance", "series"]
TABLE = "table.csv"
"""What a study was made of, beside its study.json."""
HEADS: Mapping[str, str] = {
    "grr": "part;operator;value",
    "acceptance": "quantity;position;measured_mm;calibrated_mm;u_mm",
    "series": "part;value_mm;u_mm",
}
_Row: TypeAlias = tuple[Sequence[object], Sequence[str]]
"""Cells of a row, and the doubts of its result."""
_ID = 12
"""Hex digits of a study's hash that name it."""


def keep_study(
    folder: Path, kind: Kind, text: str, base: Path, limits: Mapping[str, float], name: str = THICKNESS,
    progress: Progress = silent,
) -> KeptStudy:  # fmt: skip
    """Make a study from the text of a table, and store both in the project's folder.

    Parameters
    ----------
    folder
        The project's.
    kind
        "grr", "acceptance" or "series".
    text
        The table as CSV with a head line; see `core.wings.studies.files.input`.
    base
        The folder that names of results in the table are seen from.
    limits
        In mm. Of a gauge R&R study "tolerance": T, its full width. Of an acceptance check the limit of each quantity.
        Of a series "lower" and "upper", and "size": values a subgroup.
    name
        Of the characteristic of a series.
    progress
        Called with what is being done; may raise Cancelled.

    Raises
    ------
    InputError
        If something in the table is wrong or too little, a limit is not above 0, or nothing can be written.
    """
    progress("study", 0, 1)
    try:
        table = table_of(text, base / "table")
        study: Study
        if kind == "grr":
            found = crossed_of(table)
            study = grr_study(
                found.values, parts=found.parts, operators=found.operators,
                tolerance=limits.get("tolerance"), unit=found.unit, doubted=found.doubted,
            )  # fmt: skip
        elif kind == "series":
            study = _series(repeats_of(table), limits, name)
        else:
            study = acceptance_check(readings_of(table), cast(Mapping[Quantity, float], limits))
    except InputError as error:
        raise InputError(error.what, where="table", todo=error.todo) from error
    except WrongValue as error:
        raise InputError(error.what, where="table") from error
    return _kept(folder, study, text)


def keep_type1(
    folder: Path, repeats: Sequence[tuple[str, float, Doubts]], nominal: float, tolerance: float
) -> KeptStudy:
    """Make a type-1 study of repeats (label, value, doubts), T = `tolerance` being the full width in mm, and store it.

    Raises
    ------
    InputError
        If there are too few values, or nothing can be written.
    """
    try:
        doubted = doubted_among((label, doubts) for label, _, doubts in repeats)
        study = type1_study([value for _, value, _ in repeats], nominal, tolerance, doubted)
    except WrongValue as error:
        raise InputError(error.what, where="repeats") from error
    rows = [((name, float(value)), _facts(doubts)) for name, value, doubts in repeats]
    return _kept(folder, study, _table("scan;value_mm", rows))


def look_at_study(folder: Path, id_: str) -> Study:
    """Read the study whose id is `id_` in the project's folder; InputError if it is missing or damaged."""
    return read_study(study_path(folder, id_))


def export_study(folder: Path, id_: str, path: Path) -> Path:
    """Write a copy of a study to `path`: its table if the name ends in .csv, else study.json; return the path."""
    source = study_path(folder, id_)
    source = source.with_name(TABLE) if path.suffix.lower() == ".csv" else source
    if not source.exists():
        raise InputError(
            Message("study.gone", "is not there any more"),
            where=source,
            todo=Message("advice.make_study_anew", "make the study again"),
        )
    write_bytes(path, read_bytes(source))
    return path


def read_study_table(path: Path) -> str:
    """Read the text of a CSV table, and check that it can be parsed; InputError if not."""
    table_of(text := read_text(path), path)
    return text


def project_rows(
    kind: Kind, folder: Path, artefact: Artefact, calibrated_mm: float, u_mm: float, diameter_mm: float,
    name: str = THICKNESS, progress: Progress = silent,
) -> str:  # fmt: skip
    """Make rows for a study's table from another project's results: CSV text with a head line.

    For a gauge R&R study its part, operator and thickness, a row for each of its repeats if there are any. For an
    acceptance check what `read_positions` finds in its cloud, the project standing for the position. For a series its
    part, its characteristic `name`, a length, and the standard uncertainty of that.

    Parameters
    ----------
    kind
        Of the study.
    folder
        The other project's.
    artefact, calibrated_mm, u_mm, diameter_mm
        As for `read_positions`; of an acceptance check.
    name
        Of the characteristic of a series.
    progress
        Called with what is being done; may raise Cancelled.

    Raises
    ------
    InputError
        If it is no project, nothing was measured in it, the characteristic is none or no length, or the artefact is
        not in its cloud.
    """
    if not is_project(folder):
        raise InputError(
            Message("study.no_project", "this is no project"),
            where=folder,
            todo=Message("advice.choose_project", "choose the folder of a project"),
        )
    project = read_project(folder).project
    if kind == "grr":
        info = project.info
        part, operator = info.serial or info.part or info.name, info.operator
        if not operator:
            raise InputError(
                Message("study.no_operator", "the project names no operator"),
                where=folder,
                todo=Message("advice.enter_operator", "enter one on its Project page"),
            )
        kept: list[tuple[float, Sequence[str]]] = [(one.thickness_mm, one.doubts) for one in project.repeats]
        if not kept:
            found = measured_in(results_folder(folder), THICKNESS)
            kept = [(found.value, _facts(found.doubts))]
        rows: list[_Row] = [((part, operator, value), doubts) for value, doubts in kept]
    elif kind == "series":
        found = measured_in(results_folder(folder), name)
        if found.unit != "mm":
            raise InputError(Message("study.no_length", "the {name} is no length", name=name), where=folder)
        part = project.info.serial or project.info.name or folder.name
        rows = [((part, found.value, found.u), _facts(found.doubts))]
    else:
        readings = read_positions(
            [results_folder(folder)], artefact, calibrated_mm=calibrated_mm, u_mm=u_mm, diameter_mm=diameter_mm,
            progress=progress,
        )  # fmt: skip
        place = project.info.name or folder.name
        rows = [((one.quantity, place, one.measured, one.calibrated, one.u), _facts(one.doubts)) for one in readings]
    return _table(HEADS[kind], rows)


def _table(head: str, rows: Sequence[_Row]) -> str:
    """Rows under a head line, and their doubts in a column more where one of them has any."""
    doubted = any(doubts for _, doubts in rows)
    lines = [head + (f";{DOUBTS}" if doubted else "")]
    for cells, doubts in rows:
        lines.append(";".join(map(_cell, (*cells, " ".join(doubts)) if doubted else cells)))
    return "\n".join(lines) + "\n"


def _facts(doubts: Doubts) -> tuple[str, ...]:
    """Their names, as tables and files have them."""
    return tuple(doubt.fact for doubt in doubts)


def _cell(value: object) -> str:
    return repr(float(value)) if isinstance(value, float) else " ".join(str(value).replace(";", " ").split())


def _kept(folder: Path, study: Study, table: str) -> KeptStudy:
    """Write a study into a folder called after what it says."""
    id_ = hashlib.sha256(to_json(study_values(study)).encode()).hexdigest()[:_ID]
    make_inner_folder(folder, STUDIES)
    path = study_path(folder, id_)
    write_study(path.parent, study)
    head = next(line for line in table.splitlines() if line.strip() and not line.lstrip().startswith("#"))
    write_text(path.with_name(TABLE), harmless_table(table, separator_of(head)))
    return KeptStudy(id_, kind_of(study), _title(study))


def _series(found: Repeats, limits: Mapping[str, float], name: str) -> SeriesStudy:
    return series_study(
        found.values,
        (limits.get("lower", -math.inf), limits.get("upper", math.inf)),
        size=int(limits.get("size", 1)),
        stated=None if found.u is None else stated_uncertainty(found.u, ()),
        labels=found.labels,
        unit=found.unit,
        name=name,
        doubted=found.doubted,
    )


def _title(study: Study) -> Message:
    match study:
        case GrrStudy():
            parts, operators, repeats = study.values.shape
            return Message(
                "study.title_grr",
                "{parts} parts × {operators} operators × {repeats} repeats",
                parts=parts,
                operators=operators,
                repeats=repeats,
            )
        case Type1Study():
            return Message(
                "study.title_type1",
                "{n} repeats, reference {reference:g} {unit}, T {tolerance:g} {unit}",
                n=study.n,
                reference=study.reference,
                tolerance=study.tolerance,
                unit=study.unit,
            )
        case AcceptanceCheck():
            checked = [
                Message("study.title_quantity", "{quantity} ×{n}", quantity=one.title, n=len(one.readings))
                for one in study.quantities
            ]
            return Message("study.title_acceptance", "{checked}", checked=checked)
        case SeriesStudy() if study.size > 1:
            return Message(
                "study.title_subgroups",
                "{n} × {size} × {name}",
                n=study.points,
                size=study.size,
                name=_named(study.name),
            )
        case _:
            return Message("study.title_values", "{n} × {name}", n=len(study.values), name=_named(study.name))


def _named(name: str) -> str:
    """The name of a characteristic: the thickness in the reader's language, a feature's as its user typed it."""
    return label("thickness") if name == THICKNESS else name
