"""A table of numbers as spreadsheets write it: CSV with a head line, checked cell by cell.

Commas, semicolons or tabs between the cells; where it is not commas, a number may have a decimal comma. Empty lines and
lines that begin with # are passed over.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

from core.errors import InputError
from core.files.limits import LARGEST
from core.files.reading import csv_rows, read_text
from core.findings.proof import Doubt, Doubts
from core.messages import Message

SEPARATORS = ";\t,"
DOUBTS = "doubts"
"""The column of facts, by their names in files with spaces between them, by which the result of a row proves nothing.

A table without it says of no result that it is doubted, as tables typed by hand and those of earlier versions do."""


@dataclass(frozen=True, slots=True)
class Table:
    """Table of cells as text, by column; `lines` are the numbers of the rows in the file, from 1."""

    path: Path
    lines: tuple[int, ...]
    columns: Mapping[str, tuple[str, ...]]
    decimal_comma: bool

    def __len__(self) -> int:
        return len(self.lines)

    def name_of(self, names: Sequence[str]) -> str | None:
        """Find which one of the column `names` the table has; None if it has none, InputError if it has several."""
        found = [name for name in names if name in self.columns]
        if len(found) > 1:
            raise InputError(
                Message("study.same_columns", "the columns {found:and} say the same", found=tuple(found)),
                where=self.path,
                todo=Message("advice.keep_one", "keep one of them"),
            )
        return found[0] if found else None

    def texts(self, *names: str) -> tuple[str, ...]:
        """Read the column that has one of `names` as texts; InputError if it is missing or a cell is empty."""
        name = self._needed(names)
        for line, cell in zip(self.lines, self.columns[name], strict=True):
            if not cell:
                raise InputError(
                    Message("study.cell_empty", "line {line}, column {name} is empty", line=line, name=name),
                    where=self.path,
                    todo=Message("advice.fill_cell", "fill it in"),
                )
        return self.columns[name]

    @property
    def doubts(self) -> tuple[Doubts, ...]:
        """Doubts about each row's result, reasons why it proves nothing, from the column "doubts"; () for none."""
        cells = self.columns.get(DOUBTS, ("",) * len(self))
        return tuple(tuple(map(Doubt.named, cell.split())) for cell in cells)

    def numbers(self, *names: str) -> tuple[float, ...]:
        """Read the column that has one of `names` as finite numbers; InputError if it is missing or one is not."""
        name = self._needed(names)
        return tuple(self._number(name, row) for row in range(len(self)))

    def numbers_if_any(self, *names: str) -> tuple[float, ...] | None:
        """Read the cells of the column that has one of `names` as numbers; None if it is missing or empty."""
        name = self.name_of(names)
        return None if name is None or not any(self.columns[name]) else self.numbers(name)

    def numbers_or(self, default: float, *names: str) -> tuple[float, ...]:
        """Read the cells of the column that has one of `names` as numbers; `default` for an empty or missing cell."""
        name = self.name_of(names)
        if name is None:
            return (default,) * len(self)
        cells = self.columns[name]
        return tuple(self._number(name, row) if cells[row] else default for row in range(len(self)))

    def _needed(self, names: Sequence[str]) -> str:
        name = self.name_of(names)
        if name is None:
            near = [hit for one in names for hit in get_close_matches(one, self.columns, n=1, cutoff=0.75)]
            hint = (
                Message("study.nearest_column", "did you mean {name}?", name=near[0])
                if near
                else Message("study.its_columns", "its columns are {names}", names=tuple(self.columns))
            )
            raise InputError(
                Message("study.column_missing", "the column {name} is missing ({hint})", name=names[0], hint=hint),
                where=self.path,
            )
        return name

    def _number(self, name: str, row: int) -> float:
        cell = self.columns[name][row]
        try:
            value = float(cell.replace(",", ".") if self.decimal_comma else cell)
        except ValueError:
            value = math.nan
        if not abs(value) <= LARGEST:
            line = self.lines[row]
            raise InputError(
                Message(
                    "study.cell_not_a_number", 'line {line}, column {name} is "{cell}", not a finite number',
                    line=line, name=name, cell=cell,
                )
                if cell
                else Message(
                    "study.cell_without_number", "line {line}, column {name} is empty, not a number",
                    line=line, name=name,
                ),
                where=self.path,
            )  # fmt: skip
        return value


def read_table(path: Path) -> Table:
    """Read a CSV table with a head line from the file at `path`.

    Raises
    ------
    InputError
        If the file is missing or no text; else as `table_of`.
    """
    return table_of(read_text(path), path)


def separator_of(head: str) -> str:
    """Find the separator of a CSV table (semicolon, tab or comma) in its head line."""
    return next((one for one in SEPARATORS if one in head), ",")


def with_rows(text: str, more: str) -> str:
    """Append the rows of the CSV table `more`, with the same columns, to the table `text`; doubts get a column.

    Parameters
    ----------
    text
        The table, whatever is wrong with it; nothing: the other with its head.
    more
        The other one, with semicolons and its doubts, if it has them, in its last column.
    """
    lines = text.splitlines()
    told = [number for number, line in enumerate(lines) if line.strip() and not line.lstrip().startswith("#")]
    if not told:
        return more
    separator = separator_of(lines[told[0]])
    head, *rows = (line.split(";") for line in more.splitlines())
    columns = [cell.strip() for cell in lines[told[0]].split(separator)]
    if DOUBTS in head and DOUBTS not in columns:
        for number in told:
            lines[number] += separator + (DOUBTS if number == told[0] else "")
        columns.append(DOUBTS)
    for row in rows:
        cells = row[:-1] if DOUBTS in head else row
        if DOUBTS in columns:
            cells.insert(columns.index(DOUBTS), row[-1] if DOUBTS in head else "")
        lines.append(separator.join(cells))
    return "\n".join(lines) + "\n"


def table_of(text: str, path: Path) -> Table:
    """Parse a CSV table in `text`; `path` is the file it comes from, named in errors.

    Raises
    ------
    InputError
        If it has no rows, a column twice, a cell that goes over several lines, or a row with more or fewer cells than
        the head.
    """
    lines = [
        (number, line)
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if len(lines) < 2:
        raise InputError(Message("study.table_without_rows", "the table has no rows below its head"), where=path)
    head = lines[0][1]
    separator = separator_of(head)
    names, *rows = ([cell.strip() for cell in row] for row in csv_rows((line for _, line in lines), path, separator))
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(Message("study.column_twice", 'the column "{twice}" is there twice', twice=twice), where=path)
    numbers = tuple(number for number, _ in lines[1:])
    if len(rows) != len(numbers):
        raise InputError(
            Message("study.cell_over_lines", "a cell in quotes does not end in the line it begins in"),
            where=path,
            todo=Message("advice.close_quotes", "close its quotes, or leave them out"),
        )
    for number, row in zip(numbers, rows, strict=True):
        if len(row) != len(names):
            raise InputError(
                Message(
                    "study.row_length",
                    "line {number} has {row} cells, but the head has {names}",
                    number=number,
                    row=len(row),
                    names=len(names),
                ),
                where=path,
            )
    columns = {name: tuple(row[place] for row in rows) for place, name in enumerate(names)}
    return Table(path, numbers, columns, decimal_comma=separator != ",")
