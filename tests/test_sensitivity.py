"""Numbers for tuning are found, and those that matter by changing many at once."""

import sys
from types import SimpleNamespace

import pytest

from tests.rests_on import Tree
from tests.sensitivity import Number, change, is_another, numbers, out_of_reach, takers, those_that_matter

MODULE = """from core.compiled import compiled
LIMIT = 3.0
LEAST, MOST = 2, 0.5
_OFF = 0
NAME = "1"
ON = True
IN_LOOP = 4.0
FOR_HELPER = 5.0
DERIVED = 6.0
USUAL = 7.0
TWICE = 2 * DERIVED
@compiled
def loop():
    return IN_LOOP + helper()
def helper():
    return FOR_HELPER
def plain(at=USUAL):
    return LIMIT
"""


@pytest.fixture
def tree(tmp_path):
    (tmp_path / "core" / "scan").mkdir(parents=True)
    (tmp_path / "core" / "scan" / "one.py").write_text(MODULE)
    return Tree(tmp_path)


def test_every_number_that_has_a_name_is_one_for_tuning(tree):
    found = {one.name: one.value for one in numbers(tree)}
    assert found == {
        "LIMIT": 3.0, "LEAST": 2, "MOST": 0.5, "IN_LOOP": 4.0, "FOR_HELPER": 5.0, "DERIVED": 6.0, "USUAL": 7.0
    }  # fmt: skip


def test_what_loops_values_and_defaults_have_taken_is_out_of_reach(tree):
    names = {one.partition(":")[2] for one in out_of_reach(tree, numbers(tree))}
    assert names == {"IN_LOOP", "FOR_HELPER", "DERIVED", "USUAL"}


@pytest.mark.parametrize(("value", "factor", "after"), [(4, 0.5, 2), (1, 0.5, 1), (3, 2.0, 6), (0.5, 0.5, 0.25)])
def test_a_whole_number_stays_whole(value, factor, after):
    changed = Number("m", "N", value).times(factor)
    assert changed == after and type(changed) is type(value)


def test_groups_without_another_result_are_not_split():
    group = [Number("m", f"N{i}", 1.0) for i in range(64)]
    asked = []

    def differs(some):
        asked.append(len(some))
        return "block" if {"N5", "N40"} & {one.name for one in some} else ""

    found = [some[0].name for some, by in those_that_matter(group, differs, lambda: False) if by == "block"]
    assert found == ["N5", "N40"]
    assert len(asked) < 25


def test_numbers_that_make_another_result_only_together_are_told_as_a_group():
    group = [Number("m", f"N{i}", 1.0) for i in range(8)]

    def differs(some):
        return "block" if {"N1", "N6"} <= {one.name for one in some} else ""

    assert [*those_that_matter(group, differs, lambda: False)] == [(group, "block")]


def test_a_number_is_changed_where_it_is_imported_and_not_where_another_is_the_same(tmp_path, monkeypatch):
    texts = {
        "one": "LIMIT = 3.0\n",
        "taker": "from core.scan.one import LIMIT\n",
        "renamed": "from core.scan.taker import LIMIT as _MOST\n",
        "other": "LIMIT = 3.0\n",
    }
    (tmp_path / "core" / "scan").mkdir(parents=True)
    for name, text in texts.items():
        (tmp_path / "core" / "scan" / f"{name}.py").write_text(text)
    places = takers(Tree(tmp_path), [Number("core.scan.one", "LIMIT", 3.0)])["core.scan.one:LIMIT"]
    assert places == {"core.scan.one:LIMIT", "core.scan.taker:LIMIT", "core.scan.renamed:_MOST"}
    value = 3.0  # one object, as a compiled module may have it
    modules = {name: SimpleNamespace(LIMIT=value, _MOST=value) for name in texts}
    for name, module in modules.items():
        monkeypatch.setitem(sys.modules, f"core.scan.{name}", module)
    change(places, 6.0)
    assert (modules["one"].LIMIT, modules["taker"].LIMIT, modules["renamed"]._MOST, modules["other"].LIMIT) == (
        6,
        6,
        6,
        3,
    )


def test_where_time_is_up_nothing_more_is_tried():
    assert list(those_that_matter([Number("m", "N", 1.0)], lambda some: "block", lambda: True)) == []


USUAL = {"verdict": "conforming", "notes": ["a.b"], "thickness_mm": 50.0, "U_mm": 0.1, "points": 1000}


@pytest.mark.parametrize(
    ("found", "another"),
    [
        ({}, False),
        ({"thickness_mm": 50.009}, False),
        ({"thickness_mm": 50.011}, True),
        ({"U_mm": 0.112}, True),
        ({"points": 940}, True),
        ({"notes": []}, True),
        ({"verdict": "not proven"}, True),
    ],
)
def test_a_result_is_another_one_by_what_its_reader_would_notice(found, another):
    assert is_another(USUAL, {**USUAL, **found}) is another
    assert is_another(USUAL, "scan refused")
