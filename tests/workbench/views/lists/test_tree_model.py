"""A list's rows as a model: what Qt asks of it holds, and what stays stays where it was and chosen."""

from __future__ import annotations

import random
from typing import Any

import pytest
from PySide6.QtCore import QAbstractItemModel, QModelIndex, Qt
from PySide6.QtTest import QAbstractItemModelTester

from tests.workbench.cells import place, shown, tip
from workbench.views.lists.tree_model import Cell, TreeList, TreeModel, TreeRow


def row(key: str, below: int = 0, said: str = "") -> TreeRow:
    lower = tuple(TreeRow(str(n), (Cell(f"{key}.{n}"), Cell("", right=True))) for n in range(below))
    return TreeRow(key, (Cell(key, f"tip of {key}"), Cell(said or "-", right=True, ticked=False)), lower)


def texts(model: QAbstractItemModel, above: QModelIndex | None = None) -> list[Any]:
    above = above or QModelIndex()
    return [
        (index.data(), texts(model, index)) if model.rowCount(index) else index.data()
        for index in (model.index(number, 0, above) for number in range(model.rowCount(above)))
    ]


@pytest.fixture
def tree(qtbot: Any) -> TreeList:
    made = TreeList(("What", "Value"))
    qtbot.addWidget(made)
    return made


def test_rows_and_those_below_are_shown_unfolded_under_their_titles(tree: TreeList) -> None:
    tree.set_rows([row("a", 2), row("b")])
    model = tree.model()
    assert texts(model) == [("a", ["a.0", "a.1"]), "b"]
    assert [model.headerData(n, Qt.Orientation.Horizontal) for n in (0, 1)] == ["What", "Value"]
    assert tree.isExpanded(place(tree, 0)) and tip(tree, 1) == "tip of b"
    assert shown(tree, 1, 1, role=Qt.ItemDataRole.TextAlignmentRole) & Qt.AlignmentFlag.AlignRight


def test_a_row_that_stays_stays_chosen_and_nobody_is_told_of_choosing(tree: TreeList, qtbot: Any) -> None:
    tree.set_rows([row("a"), row("b", 2), row("c")])
    tree.setCurrentIndex(place(tree, 1, 0, 1))
    with qtbot.assertNotEmitted(tree.chosen):
        tree.set_rows([row("new"), row("b", 2, "1.0"), row("c")])
        assert tree.currentIndex().data() == "b.1" and shown(tree, 1, 1) == "1.0"
        tree.set_rows([row("c")])
        tree.choose("")
        assert not tree.currentIndex().isValid() and not tree.selectedIndexes()
    with qtbot.waitSignal(tree.chosen) as said:
        tree.setCurrentIndex(place(tree, 0))
    assert said.args == ["c"]


def test_a_row_below_another_is_of_the_one_above(tree: TreeList, qtbot: Any) -> None:
    tree.set_rows([row("a"), row("b", 2)])
    with qtbot.waitSignal(tree.chosen) as said:
        tree.setCurrentIndex(place(tree, 1, 0, 0))
    assert said.args == ["b"]
    tree.choose("b")
    assert tree.currentIndex().data() == "b.0", "its own row is chosen already"


def test_a_tick_is_asked_for_and_stands_once_the_rows_say_so(tree: TreeList, qtbot: Any) -> None:
    tree.set_rows([row("a"), row("b")])
    with qtbot.waitSignal(tree.ticked) as said:
        tree.model().setData(place(tree, 1, 1), Qt.CheckState.Checked, Qt.ItemDataRole.CheckStateRole)
    assert said.args == ["b", True]
    assert shown(tree, 1, 1, role=Qt.ItemDataRole.CheckStateRole) is Qt.CheckState.Unchecked
    assert shown(tree, 1, 0, role=Qt.ItemDataRole.CheckStateRole) is None


@pytest.mark.parametrize("seed", range(20))
def test_from_any_rows_to_any_others_the_model_keeps_what_qt_asks(seed: int, qtbot: Any, qapp: Any) -> None:
    chance = random.Random(seed)
    model = TreeModel(qapp, ("What", "Value"))
    tester = QAbstractItemModelTester(model, QAbstractItemModelTester.FailureReportingMode.Fatal)
    for _ in range(20):
        keys = chance.sample("abcdefgh", chance.randrange(8))
        rows = [row(key, chance.choice((0, 0, 1, 3))) for key in keys]
        model.set_rows(rows)
        assert texts(model) == [
            (one.key, [f"{one.key}.{n}" for n in range(len(one.below))]) if one.below else one.key for one in rows
        ]
    del tester
