"""What a study is made of, read from a table or from folders of results.

Columns (others are passed over):

- repeats, type1, series: `value` (or value_mm, thickness_mm), and if you like `scan` or `part`, `u_mm` or `U_mm` with
  `k` (else k = 2);
- grr: `part`, `operator`, and `value`, or `result`: the folder of results of that measurement, seen from the table;
- acceptance: `quantity` (form, size, spacing, flatness), `position`, `measured_mm`, and if you like `calibrated_mm`,
  `u_mm`;
- all of them: `doubts`, the facts by which the result of a row proves nothing (`table.DOUBTS`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import cast

import numpy as np

from core.errors import InputError
from core.files.reading import resolved
from core.inspect.conformity import Limits
from core.inspect.results import Contribution
from core.messages import Message
from core.model.arrays import Array
from core.wings.studies.files.results import Measured, measured_in
from core.wings.studies.files.table import Table, read_table
from core.wings.studies.kinds.acceptance import QUANTITIES, Quantity, Reading
from core.wings.studies.kinds.doubted import Doubted, doubted_among
from core.wings.studies.kinds.repeats import THICKNESS

VALUE = ("value", "value_mm", "thickness_mm", "value_deg")


@dataclass(frozen=True, eq=False, slots=True)
class Repeats:
    """Repeated measurements of one quantity.

    Parameters
    ----------
    name
        Of the quantity.
    labels
        Of the scans.
    values
        In `unit`.
    u
        Standard uncertainties; None if they are not stated.
    U
        Expanded ones; empty if they are not stated.
    budgets
        One a scan, where the scans have them; else empty.
    unit
        "mm" or "deg".
    limits
        Asked of the quantity by all scans alike, in `unit`; else None.
    doubted
        Those whose results prove nothing.
    """

    name: str
    labels: tuple[str, ...]
    values: tuple[float, ...]
    u: tuple[float, ...] | None
    U: tuple[float, ...]
    budgets: tuple[tuple[Contribution, ...], ...]
    unit: str
    limits: Limits | None = None
    doubted: Doubted = ()


@dataclass(frozen=True, eq=False, slots=True)
class Crossed:
    """Crossed study: `values` (p, o, r) in `unit`, the names of parts and operators, results that prove nothing."""

    values: Array
    parts: tuple[str, ...]
    operators: tuple[str, ...]
    unit: str
    doubted: Doubted = ()


def read_repeats(paths: Sequence[Path], name: str = THICKNESS) -> Repeats:
    """Read repeated values of one quantity from one table, or of the characteristic `name` from folders of results.

    Raises
    ------
    InputError
        If a file is missing or has something wrong in it, or a folder has no such characteristic.
    """
    table = _table_among(paths)
    if table is None:
        return _of_results(paths, [measured_in(path, name) for path in paths], name)
    return repeats_of(table, name)


def repeats_of(table: Table, name: str = THICKNESS) -> Repeats:
    """Convert a table to repeated values of one quantity with their uncertainties; InputError if a cell is wrong."""
    column = table.name_of(VALUE) or VALUE[0]
    values = table.numbers(column)
    called = table.name_of(("scan", "part"))
    labels = table.texts(called) if called else tuple(str(row + 1) for row in range(len(table)))
    u, expanded = table.numbers_if_any("u_mm", "u", "u_deg"), table.numbers_if_any("U_mm", "U", "U_deg")
    if expanded is not None:
        factors = table.numbers_if_any("k") or (2.0,) * len(table)
        _above_zero(table, "k", factors)
        u = u or tuple(one / k for one, k in zip(expanded, factors, strict=True))
    if u is not None:
        _not_negative(table, "u_mm", u)
    unit, doubted = "deg" if column == "value_deg" else "mm", doubted_among(zip(labels, table.doubts, strict=True))
    return Repeats(name, labels, values, u, expanded or (), (), unit, doubted=doubted)


def read_crossed(path: Path, name: str = THICKNESS) -> Crossed:
    """Read the values of a gauge R&R study, parts × operators × repeats, from the table at `path`."""
    if path.is_dir():
        raise InputError(
            Message("study.grr_needs_table", "a gauge R&R study needs a table of part, operator and value"), where=path
        )
    return crossed_of(read_table(path), name)


def crossed_of(table: Table, name: str = THICKNESS) -> Crossed:
    """Convert a table to the values of a gauge R&R study: parts × operators × repeats, each as often.

    Raises
    ------
    InputError
        As `read_repeats`, or if a part was measured more or less often by one operator than by another.
    """
    path = table.path
    parts, operators = table.texts("part"), table.texts("operator")
    unit = "mm"
    if "result" in table.columns:
        folders = table.texts("result")
        measured = [measured_in(path.parent / folder, name) for folder in folders]
        values, unit = [one.value for one in measured], measured[0].unit
        doubts = [(*one.doubts, *told) for one, told in zip(measured, table.doubts, strict=True)]
        labels = folders
    else:
        values, doubts = list(table.numbers(*VALUE)), list(table.doubts)
        labels = tuple(f"{part}/{operator}" for part, operator in zip(parts, operators, strict=True))
    names = tuple(dict.fromkeys(parts)), tuple(dict.fromkeys(operators))
    cells: dict[tuple[str, str], list[float]] = {(part, operator): [] for part in names[0] for operator in names[1]}
    for part, operator, value in zip(parts, operators, values, strict=True):
        cells[part, operator].append(value)
    most = max(len(cell) for cell in cells.values())
    for (part, operator), cell in cells.items():
        if len(cell) != most:
            raise InputError(
                Message(
                    "study.unequal_repeats",
                    "part {part} was measured {cell} times by operator {operator}, others {most} times",
                    part=part,
                    cell=len(cell),
                    operator=operator,
                    most=most,
                ),
                where=path,
                todo=Message(
                    "advice.measure_all_parts_alike", "a crossed study needs every part as often by every operator"
                ),
            )
    if len(names[0]) < 2 or most < 2:
        raise InputError(
            Message(
                "study.too_few_parts_or_repeats",
                "{names} parts and {most} repeats are too few",
                names=len(names[0]),
                most=most,
            ),
            where=path,
            todo=Message("advice.measure_two_of_each", "measure 2 or more of each"),
        )
    shaped = np.array([[cells[part, operator] for operator in names[1]] for part in names[0]])
    return Crossed(shaped, *names, unit, doubted_among(zip(labels, doubts, strict=True)))


def read_readings(path: Path) -> tuple[Reading, ...]:
    """Read the readings of an acceptance check, one a row, from the table at `path`."""
    return readings_of(read_table(path))


def readings_of(table: Table) -> tuple[Reading, ...]:
    """Convert a table to the readings of an acceptance check, one a row; InputError if a cell is wrong."""
    path = table.path
    quantities = table.texts("quantity")
    for line, quantity in zip(table.lines, quantities, strict=True):
        if quantity not in QUANTITIES:
            raise InputError(
                Message(
                    "study.cell_no_quantity",
                    'line {line}, column quantity is "{quantity}", not {quantities} or {quantities2}',
                    line=line,
                    quantity=quantity,
                    quantities=tuple(QUANTITIES[:-1]),
                    quantities2=QUANTITIES[-1],
                ),
                where=path,
            )
    positions, measured = table.texts("position"), table.numbers("measured_mm", "measured")
    calibrated = table.numbers_or(0.0, "calibrated_mm", "calibrated")
    u = table.numbers_or(0.0, "u_mm", "u")
    _not_negative(table, "u_mm", u)
    for line, quantity, value in zip(table.lines, quantities, calibrated, strict=True):
        if quantity in ("size", "spacing") and not value > 0:
            raise InputError(
                Message(
                    "study.calibrated_not_positive",
                    "line {line}, column calibrated_mm must be above 0 for {quantity}",
                    line=line,
                    quantity=quantity,
                ),
                where=path,
            )
    known = cast(tuple[Quantity, ...], quantities)
    return tuple(map(Reading, known, positions, measured, calibrated, u, table.doubts))


def _table_among(paths: Sequence[Path]) -> Table | None:
    """The one table given, None for folders of results; InputError if it is neither."""
    files = [path for path in paths if not path.is_dir()]
    if not files:
        return None
    if len(paths) > 1:
        raise InputError(
            Message("study.table_among_folders", "a study takes one table, or folders of results"),
            where=files[0],
            todo=Message("advice.give_alone", "give it alone"),
        )
    return read_table(files[0])


def _of_results(paths: Sequence[Path], found: Sequence[Measured], name: str) -> Repeats:
    units = {one.unit for one in found}
    if len(units) > 1:
        raise InputError(
            Message(
                "study.length_and_angle",
                "{name} is a length in one folder and an angle in another",
                name=name,
            ),
            where=paths[0],
        )
    labels = _labels(paths)
    places: dict[tuple[float, float], str] = {}
    for label, one in zip(labels, found, strict=True):
        twin = places.setdefault((one.value, one.u), label)
        if twin != label or labels.count(label) > 1:
            raise InputError(
                Message(
                    "study.same_measurement_twice",
                    "it holds the same measurement as {twin}, to the last digit",
                    twin=twin,
                ),
                where=label,
                todo=Message("advice.scan_part_anew", "scan the part anew"),
            )
    return Repeats(
        name,
        labels,
        tuple(one.value for one in found),
        tuple(one.u for one in found),
        tuple(one.k * one.u for one in found),
        tuple(one.budget for one in found) if all(one.budget for one in found) else (),
        units.pop(),
        found[0].limits if all(one.limits == found[0].limits for one in found) else None,
        doubted_among((label, one.doubts) for label, one in zip(labels, found, strict=True)),
    )


def _labels(paths: Sequence[Path]) -> tuple[str, ...]:
    """The folders' own names, with those of the folders above them as far as needed to tell them apart."""
    whole = [resolved(path).parts for path in paths]
    for depth in range(1, max(map(len, whole))):
        names = tuple("/".join(parts[-depth:]) for parts in whole)
        if len(set(names)) == len(names):
            return names
    return tuple(str(path) for path in paths)


def _not_negative(table: Table, name: str, values: Sequence[float]) -> None:
    for line, value in zip(table.lines, values, strict=True):
        if value < 0:
            raise InputError(
                Message(
                    "study.cell_negative",
                    "line {line}, column {name} is {value:g}, not a length of 0 or more",
                    line=line,
                    name=name,
                    value=value,
                ),
                where=table.path,
            )


def _above_zero(table: Table, name: str, values: Sequence[float]) -> None:
    for line, value in zip(table.lines, values, strict=True):
        if not value > 0:
            raise InputError(
                Message(
                    "study.cell_not_positive",
                    "line {line}, column {name} is {value:g}, not a number above 0",
                    line=line,
                    name=name,
                    value=value,
                ),
                where=table.path,
            )
