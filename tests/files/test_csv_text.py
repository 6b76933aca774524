"""No text in a table of ours is a formula to a spreadsheet; numbers stay numbers."""

from pathlib import Path

import pytest

import core
from core.files.csv_text import csv_text, harmless_table
from core.messages import visible
from core.pipeline.steps.study_step import export_study, keep_study

ROOT = Path(core.__file__).parents[1]


def test_texts_that_would_be_formulas_stand_behind_an_apostrophe_and_numbers_stay():
    rows = [("=1+1", "+a", "-a", "@a", "\ta", " =a"), (-0.5, 3, "1", -2.5, None, "a=b")]
    assert csv_text(rows) == f"'=1+1,'+a,'-a,'@a,{visible(chr(39) + chr(9) + 'a')},' =a\n-0.5,3,1,-2.5,,a=b\n"


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_a_table_of_texts_keeps_its_form(separator):
    row = ("part", "=HYPERLINK(0)", "-0.5") if separator == "," else ("part", "=HYPERLINK(0)", "-0,5")
    made = harmless_table(separator.join(row) + "\n", separator)
    assert made == separator.join((row[0], "'" + row[1], row[2])) + "\n"


def test_the_table_of_a_study_that_is_handed_over_holds_no_formula(tmp_path):
    cells = [
        f"=cmd|'/c calc'!A{part};o{o};{part + o / 10 + r / 100 - 1}"
        for part in range(3)
        for o in (1, 2)
        for r in (1, 2)
    ]
    text = "\n".join(["part;operator;value", "# a;=cmd()", *cells]) + "\n"
    kept = keep_study(tmp_path, "grr", text, tmp_path, {"tolerance": 8.0})
    lines = export_study(tmp_path, kept.id, tmp_path / "t.csv").read_text().splitlines()
    assert not any(cell.startswith(("=", "@")) for line in lines for cell in line.split(";"))
    assert lines[2].startswith("'=cmd|'/c calc'!A0;o1;-0.8")


def test_tables_are_written_by_one_module():
    writers = [
        path.relative_to(ROOT).as_posix()
        for room in ("core", "workbench")
        for path in (ROOT / room).rglob("*.py")
        if "csv.writer" in path.read_text() or "DictWriter" in path.read_text()
    ]
    assert writers == ["core/files/csv_text.py"]
