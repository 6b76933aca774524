"""The results as a workbook for the office: a sheet for each kind of table. The same bytes every time."""

from __future__ import annotations

import io
import math
import zipfile
from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from openpyxl import Workbook
from openpyxl.cell.cell import ILLEGAL_CHARACTERS_RE
from openpyxl.styles import Font
from openpyxl.utils import get_column_letter
from openpyxl.worksheet.worksheet import Worksheet

from core.files.atomic import write_bytes
from core.files.exchange.records import (
    FACT_COLUMNS,
    FRAME_COLUMNS,
    Row,
    as_table,
    budget_rows,
    fact_row,
    facts_of_steps,
    facts_of_studies,
    frame_rows,
    result_row,
    setting_rows,
)
from core.inspect.characteristic import Characteristic
from core.messages import decimals_of, label
from core.report.content import ReportContent
from core.report.facts.fact import Fact
from core.report.facts.of_budget import (
    CONTRIBUTION,
    DISTRIBUTION,
    FREEDOM,
    INPUT,
    OF_INPUT,
    SENSITIVITY,
    SHARE,
    VALUE,
)
from core.report.facts.of_features import DEVIATION, EXPANDED, FACTOR, MEASURED, NOMINAL
from core.report.wording import Words
from core.states import VERDICT

RESULT_HEADS = {
    "name": label("characteristic"), "kind": label("kind"), "unit": label("unit"), "nominal": NOMINAL,
    "lower_limit": label("lower limit"), "upper_limit": label("upper limit"), "value": MEASURED,
    "deviation": DEVIATION, "u": "u", "k": FACTOR, "U": EXPANDED, "verdict": VERDICT, "rule": label("rule"),
}  # fmt: skip
BUDGET_HEADS = {
    "characteristic": label("characteristic"), "source": INPUT, "value": VALUE,
    "input_unit": label("unit of the value"), "distribution": DISTRIBUTION, "standard_uncertainty": OF_INPUT,
    "sensitivity": SENSITIVITY, "contribution": CONTRIBUTION, "unit": label("unit"), "dof": FREEDOM, "share": SHARE,
}  # fmt: skip
"""What the columns are called, as in the tables of the PDF, by the keys of their records."""

_WIDEST = 60
"""The widest column in characters: longer texts run on."""
_ZIP_TIME = (1980, 1, 1, 0, 0, 0)
"""Of every part within the file: a zip has no other way to say that it has no time."""


def write_xlsx(path: Path, content: ReportContent) -> None:
    """Write a report as an Excel workbook: results, budgets, studies, frames, facts and settings on a sheet each.

    Cells hold numbers in full, and show as many decimals as the report does.

    What the report tells in words is told in its language; the names of sheets, frames and settings are fixed.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    book = Workbook()
    book.remove(book.worksheets[0])
    words = Words.of(content.language)
    results = [{**_result(one), "rule": words(one.rule or "")} for one in content.characteristics]
    budgets = [
        row | {"source": words(cause.words), "distribution": words(row["distribution"] or "")}
        for one in content.characteristics
        for row, cause in zip(budget_rows(one), one.budget, strict=True)
    ]
    tables: dict[str, Sequence[Sequence[Any]]] = {
        "result": _headed(RESULT_HEADS, results, words),
        "budget": _headed(BUDGET_HEADS, budgets, words),
        **({"studies": _facts(facts_of_studies(content, words), words)} if content.studies else {}),
        "frames": as_table(FRAME_COLUMNS, frame_rows(content)),
        "facts": _facts(facts_of_steps(content), words),
        "settings": [["name", "value"], *setting_rows(content)],
    }
    for name, rows in tables.items():
        _fill(book.create_sheet(name), rows)
    properties = book.properties
    properties.title, properties.creator = f"Measurement report {content.report_id}", f"Trisect {content.version}"
    properties.created = content.timestamp.astimezone(UTC).replace(tzinfo=None)
    stream = io.BytesIO()
    book.save(stream)
    write_bytes(path, _timeless(stream.getvalue(), content.timestamp))


def _result(one: Characteristic) -> Row:
    """A characteristic with the decimals of its U."""
    row = result_row(one)
    return _shown(row, decimals_of(row["U"] or math.nan), ("value", "deviation", "U"))


def _facts(facts: Iterable[tuple[str, Fact]], words: Words) -> list[list[Any]]:
    """Facts as a table, each with its decimals."""
    numbers = ("value", "u", "U", "low", "high")
    return as_table(FACT_COLUMNS, [_shown(fact_row(of, fact, words), fact.decimals, numbers) for of, fact in facts])


def _shown(row: Row, decimals: int | None, names: Iterable[str]) -> Row:
    """The row with the real numbers of these names beside the `decimals` that are shown of them; None: as they are."""
    if decimals is None:
        return row
    return {**row, **{name: (row[name], decimals) for name in names if isinstance(row[name], float)}}


def _headed(heads: Mapping[str, str], rows: Iterable[Row], words: Words) -> list[list[Any]]:
    """A head line in the reader's language and the rows, in the order of the heads."""
    return [[words.known(name) for name in heads.values()], *([row[key] for key in heads] for row in rows)]


def _fill(sheet: Worksheet, rows: Sequence[Sequence[Any]]) -> None:
    """Rows with a bold head that stays in sight; a text never becomes a formula, (value, decimals) are a number."""
    widths: dict[int, int] = {}
    for row, values in enumerate(rows, start=1):
        for column, value in enumerate(values, start=1):
            cell = sheet.cell(row, column)
            if isinstance(value, tuple):
                value, decimals = value
                cell.number_format = f"0.{'0' * decimals}" if decimals > 0 else "0"
            if isinstance(value, str):
                cell.value = ILLEGAL_CHARACTERS_RE.sub(" ", value)
                cell.data_type = "s"
            else:
                cell.value = value
            if row == 1:
                cell.font = Font(bold=True)
            widths[column] = max(widths.get(column, 0), len(str(value)) if isinstance(value, str) else 12)
    for column, width in widths.items():
        sheet.column_dimensions[get_column_letter(column)].width = min(width + 2, _WIDEST)
    sheet.freeze_panes = "A2"


def _timeless(data: bytes, at: datetime) -> bytes:
    """The workbook with the measurement's time instead of the clock's, within and about its parts."""
    out = io.BytesIO()
    stamp = at.astimezone(UTC).strftime("%Y-%m-%dT%H:%M:%SZ").encode()
    with zipfile.ZipFile(io.BytesIO(data)) as parts, zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as whole:
        for name in parts.namelist():
            text = parts.read(name)
            if name == "docProps/core.xml":
                head, mark, rest = text.partition(b"<dcterms:modified")
                opening, _, closing = rest.partition(b">")
                text = head + mark + opening + b">" + stamp + closing[closing.index(b"<") :]
            whole.writestr(zipfile.ZipInfo(name, _ZIP_TIME), text, zipfile.ZIP_DEFLATED)
    return out.getvalue()
