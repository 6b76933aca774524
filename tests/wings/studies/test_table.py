"""Rows put below a table: in its order, with its separator, their doubts in their column."""

import pytest

from core.wings.studies.files.table import table_of, with_rows

HEAD, DOUBTED = "part;operator;value\n", "part;operator;value;doubts\n"


@pytest.mark.parametrize(
    ("table", "more", "whole"),
    [
        (HEAD, HEAD + "1;A;5\n", HEAD + "1;A;5\n"),
        ("", HEAD + "1;A;5\n", HEAD + "1;A;5\n"),
        (HEAD + "1;A;5", HEAD + "2;A;6\n", HEAD + "1;A;5\n2;A;6\n"),
        (HEAD + "# mine\n1;A;5\n", DOUBTED + "2;A;6;moved\n", DOUBTED + "# mine\n1;A;5;\n2;A;6;moved\n"),
        (DOUBTED + "1;A;5;moved\n", HEAD + "2;A;6\n", DOUBTED + "1;A;5;moved\n2;A;6;\n"),
        ("doubts,part,operator,value\n,1,A,5\n", DOUBTED + "2;A;6;moved\n",
         "doubts,part,operator,value\n,1,A,5\nmoved,2,A,6\n"),
    ],
)  # fmt: skip
def test_rows_of_results_go_below_a_table_with_what_is_doubted_of_them(table, more, whole):
    assert with_rows(table, more) == whole


def test_doubts_are_named_with_spaces_between_them_and_nothing_is_none(tmp_path):
    table = table_of(DOUBTED + "1;A;5;moved rig_changed\n1;A;6;\n", tmp_path)
    assert [[doubt.fact for doubt in doubts] for doubts in table.doubts] == [["moved", "rig_changed"], []]
    assert table_of(HEAD + "1;A;5\n", tmp_path).doubts == ((),)
