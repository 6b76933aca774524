"""Tables as CSV for spreadsheets: comma between fields, and no text that they would take for a formula."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Sequence
from typing import Any

from core.messages import visible

_FORMULA = ("=", "+", "-", "@", "\t", "\r")


def csv_text(rows: Iterable[Sequence[Any]]) -> str:
    """Write rows as CSV text; a text that a spreadsheet would take for a formula gets an apostrophe."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([harmless(cell) for cell in row] for row in rows)
    return text.getvalue()


def harmless_table(text: str, separator: str) -> str:
    """Put an apostrophe before cells of a text table that would be taken for formulas; numbers stay as they are."""
    rows = csv.reader(text.splitlines(), delimiter=separator)
    out = io.StringIO()
    writer = csv.writer(out, delimiter=separator, lineterminator="\n")
    writer.writerows([cell if _is_number(cell) else harmless(cell) for cell in row] for row in rows)
    return out.getvalue()


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text.replace(",", ".")))
    except ValueError:
        return False


def harmless(cell: Any) -> Any:
    """Put an apostrophe before a text that a spreadsheet would take for a formula; numbers are returned as they are.

    Control characters are written out.

    References
    ----------
    OWASP, CSV Injection.
    """
    if not isinstance(cell, str):
        return cell
    return visible(f"'{cell}" if cell.lstrip(" ").startswith(_FORMULA) else cell, keep="\n")
