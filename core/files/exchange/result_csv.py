"""The results as a table: one line for each characteristic, UTF-8, comma between fields, point before decimals."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Any

from core.files.atomic import write_text
from core.files.exchange.records import RESULT_COLUMNS, as_table, result_row
from core.messages import visible
from core.report.content import ReportContent

_FORMULA = ("=", "+", "-", "@", "\t", "\r")


def write_result_csv(path: Path, content: ReportContent) -> None:
    """Write one line for each characteristic; what is not known stays empty.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    text = io.StringIO()
    rows = [result_row(one) for one in content.characteristics]
    table = as_table(RESULT_COLUMNS, rows)
    csv.writer(text, lineterminator="\n").writerows([harmless(cell) for cell in row] for row in table)
    write_text(path, text.getvalue())


def harmless(cell: Any) -> Any:
    """A cell that no spreadsheet takes for a formula: such a text stands behind an apostrophe; numbers stay numbers.

    Control characters are written out.

    References
    ----------
    OWASP, CSV Injection.
    """
    if not isinstance(cell, str):
        return cell
    return visible(f"'{cell}" if cell.lstrip(" ").startswith(_FORMULA) else cell, keep="\n")
