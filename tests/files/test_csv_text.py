"""No text in a table of ours is a formula to a spreadsheet; numbers stay numbers."""

from pathlib import Path

import pytest

import core
from core.files.csv_text import csv_text, harmless_table
from core.messages import visible

ROOT = Path(core.__file__).parents[1]


def test_texts_that_would_be_formulas_stand_behind_an_apostrophe_and_numbers_stay():
    rows = [("=1+1", "+a", "-a", "@a", "\ta", " =a"), (-0.5, 3, "1", -2.5, None, "a=b")]
    assert csv_text(rows) == f"'=1+1,'+a,'-a,'@a,{visible(chr(39) + chr(9) + 'a')},' =a\n-0.5,3,1,-2.5,,a=b\n"


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_a_table_of_texts_keeps_its_form(separator):
    row = ("part", "=HYPERLINK(0)", "-0.5") if separator == "," else ("part", "=HYPERLINK(0)", "-0,5")
    made = harmless_table(separator.join(row) + "\n", separator)
    assert made == separator.join((row[0], "'" + row[1], row[2])) + "\n"


def test_tables_are_written_by_one_module():
    writers = [
        path.relative_to(ROOT).as_posix()
        for room in ("core", "workbench")
        for path in (ROOT / room).rglob("*.py")
        if "csv.writer" in path.read_text() or "DictWriter" in path.read_text()
    ]
    assert writers == ["core/files/csv_text.py"]
