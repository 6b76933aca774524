"""The results as a workbook for the office: a sheet for each kind of table. The same bytes every time."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Sequence
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
    BUDGET_COLUMNS,
    FACT_COLUMNS,
    FRAME_COLUMNS,
    RESULT_COLUMNS,
    as_table,
    budget_rows,
    frame_rows,
    result_row,
    setting_rows,
    study_rows,
    told_rows,
)
from core.report.content import ReportContent

_WIDEST = 60
"""The widest column in characters: longer texts run on."""
_ZIP_TIME = (1980, 1, 1, 0, 0, 0)
"""Of every part within the file: a zip has no other way to say that it has no time."""


def write_xlsx(path: Path, content: ReportContent) -> None:
    """Write result, budgets, studies, frames, facts of each step and settings, each on a sheet, numbers in full.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    book = Workbook()
    book.remove(book.worksheets[0])
    budgets = [row for one in content.characteristics for row in budget_rows(one)]
    tables: dict[str, Sequence[Sequence[Any]]] = {
        "result": as_table(RESULT_COLUMNS, [result_row(one) for one in content.characteristics]),
        "budget": as_table(BUDGET_COLUMNS, budgets),
        **({"studies": as_table(FACT_COLUMNS, study_rows(content))} if content.studies else {}),
        "frames": as_table(FRAME_COLUMNS, frame_rows(content)),
        "facts": as_table(FACT_COLUMNS, told_rows(content)),
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


def _fill(sheet: Worksheet, rows: Sequence[Sequence[Any]]) -> None:
    """Rows with a bold head that stays in sight; a text never becomes a formula."""
    widths: dict[int, int] = {}
    for row, values in enumerate(rows, start=1):
        for column, value in enumerate(values, start=1):
            cell = sheet.cell(row, column)
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
