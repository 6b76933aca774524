"""What is told of a result in rows and columns: made once, drawn by terminal, window, PDF and XLSX."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TypeAlias

from core.messages import Message, decimals_of, plain
from core.report.facts.fact import Fact, Reader, Value
from core.report.wording import Words


@dataclass(frozen=True, slots=True)
class Uncertain:
    """Number of a table with its uncertainty, shown elsewhere, which decides its decimals.

    `sd` is standard or expanded, as where the number is told with it, in the column's unit.
    """

    value: float
    sd: float


Cell: TypeAlias = Value | Uncertain
"""What stands in a row."""


@dataclass(frozen=True, slots=True)
class Column:
    """Column of a table: the fields of a `Fact` but its value."""

    label: str | Message
    unit: str = ""
    digits: int | None = None
    tip: str | Message = ""
    level: Reader = Reader.TECHNICIAN
    significant: int | None = None
    signed: bool = False

    def fact(self, cell: Cell) -> Fact:
        """Make the fact for one cell of this column, with the column's name, unit and digits."""
        value, digits = (cell.value, decimals_of(cell.sd)) if isinstance(cell, Uncertain) else (cell, self.digits)
        return Fact(
            self.label, value, self.unit, digits, self.tip, self.level,
            significant=self.significant, signed=self.signed,
        )  # fmt: skip


@dataclass(frozen=True, slots=True)
class FactTable:
    """Facts in rows and columns.

    Parameters
    ----------
    columns
        The first one names the rows.
    rows
        A value for each column; None: it has none.
    title
        Parts the names of its rows from those of another table of the same result; "" where there is none.
    level
        Whom it is for.
    """

    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]
    title: str = ""
    level: Reader = Reader.TECHNICIAN

    def for_reader(self, reader: Reader) -> FactTable:
        """Return the table with those columns only that are meant for the reader."""
        places = [place for place, column in enumerate(self.columns) if column.level <= reader]
        rows = tuple(tuple(row[place] for place in places) for row in self.rows)
        return replace(self, columns=tuple(self.columns[place] for place in places), rows=rows)

    def texts(self, words: Words) -> list[list[str]]:
        """Write all cells of the table, row by row, without units; "" for a cell without a value."""
        return [
            [
                "" if value is None else replace(column.fact(value), unit="").text(words)
                for column, value in zip(self.columns, row, strict=True)
            ]
            for row in self.rows
        ]

    def lines(self, words: Words) -> list[tuple[str, str]]:
        """Write each row as a line: its name, and its values with their names, 'σ 0.306 mm, of T 22.7 %'."""
        return [(self._name(row, words), words.joined(self._said(row, words))) for row in self.rows]

    def facts(self, words: Words) -> tuple[Fact, ...]:
        """Convert each cell with a value to a fact named by its row and column: 'gauge R&R: σ'."""
        return tuple(
            replace(
                column.fact(value),
                label=plain(f"{self._name(row, words)}: {words.known(column.label)}"),
                level=self._level(column),
            )
            for row in self.rows
            for column, value in zip(self.columns[1:], row[1:], strict=True)
            if value is not None
        )

    def _level(self, column: Column) -> Reader:
        return max(self.level, column.level)

    def _name(self, row: tuple[Cell, ...], words: Words) -> str:
        name = self.columns[0].fact(row[0]).text(words)
        return words("{name}: {value}", name=words(self.title), value=name) if self.title else name

    def _said(self, row: tuple[Cell, ...], words: Words) -> list[str]:
        return [
            f"{words.known(column.label)} {column.fact(value).text(words)}"
            for column, value in zip(self.columns[1:], row[1:], strict=True)
            if value is not None
        ]


def tables_for_reader(tables: Iterable[FactTable], reader: Reader) -> tuple[FactTable, ...]:
    """Select the tables meant for a reader, each with the columns meant for that reader."""
    return tuple(table.for_reader(reader) for table in tables if table.level <= reader)
