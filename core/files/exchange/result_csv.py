"""The results as a table: one line for each characteristic, UTF-8, comma between fields, point before decimals."""

from __future__ import annotations

from pathlib import Path

from core.files.atomic import write_text
from core.files.csv_text import csv_text
from core.files.exchange.records import RESULT_COLUMNS, as_table, result_row
from core.report.content import ReportContent


def write_result_csv(path: Path, content: ReportContent) -> None:
    """Write one line for each characteristic; what is not known stays empty.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    rows = [result_row(one) for one in content.characteristics]
    write_text(path, csv_text(as_table(RESULT_COLUMNS, rows)))
