"""No text of the window is told past the catalogues: in the pseudo-language each of them has its accents."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from PySide6.QtCore import QAbstractItemModel, QAbstractListModel, QModelIndex, Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QApplication,
    QComboBox,
    QGroupBox,
    QLabel,
    QLineEdit,
    QMenu,
    QTabBar,
    QWidget,
)

from core.translations import PSEUDO, language
from workbench.app import build_window
from workbench.bench import Bench
from workbench.language import choose
from workbench.steps import STEPS

FOREIGN = (
    "Trisect",
    "English", "Deutsch",  # languages, by their own names
    "Letter", "Tabloid",  # sizes of paper
    "GRR",  # the symbol of a quantity
    "Ctrl", "Shift",  # keys, as Qt names them
)  # fmt: skip
"""What is called the same in every language. Names in the project are added, and paths and pictures are passed over."""


def texts_of(widget: QWidget) -> Iterator[str]:
    """What a widget itself tells: its text, its tip, its items."""
    yield widget.toolTip()
    yield widget.windowTitle()
    if isinstance(widget, QLabel | QAbstractButton):
        yield widget.text()
    if isinstance(widget, QGroupBox):
        yield widget.title()
    if isinstance(widget, QLineEdit):
        yield widget.placeholderText()
    if isinstance(widget, QTabBar):
        for tab in range(widget.count()):
            yield widget.tabText(tab)
            yield widget.tabToolTip(tab)
    if isinstance(widget, QComboBox):
        yield from (widget.itemText(item) for item in range(widget.count()))
    if isinstance(widget, QAbstractItemView) and widget.model() is not None:
        yield from items_of(widget.model())
    yield from (text for action in widget.actions() for text in said_by(action))


def said_by(action: QAction) -> tuple[str, str, str]:
    return action.text(), action.toolTip(), action.statusTip()


def items_of(model: QAbstractItemModel) -> Iterator[str]:
    """Heads and cells of a list or table."""
    root = QModelIndex()
    for column in range(1 if isinstance(model, QAbstractListModel) else model.columnCount(root)):
        yield str(model.headerData(column, Qt.Orientation.Horizontal) or "")
        for row in range(model.rowCount(root)):
            index = model.index(row, column, root)
            for role in (Qt.ItemDataRole.DisplayRole, Qt.ItemDataRole.ToolTipRole):
                yield str(model.data(index, role) or "")


def english(text: str) -> list[str]:
    """Words of a text that are in no catalogue; the pseudo-language gives every word of three letters an accent."""
    plain = re.sub(r"<[^<>]*>|&\w+;|/\S+|\b\w+\.(png|toml|pdf)\b", " ", text.replace("\N{ZERO WIDTH SPACE}", ""))
    return re.findall(r"\b[A-Za-z]{3,}\b", plain)


def is_never_shown(widget: QWidget) -> bool:
    """Whether it is pyqtgraph's own menu of a plot, or in it: no plot opens it."""
    parent: QWidget | None = widget
    while parent is not None and not (isinstance(parent, QMenu) and parent.title() == "Plot Options"):
        parent = parent.parentWidget()
    return parent is not None


def told_past_the_catalogues(window: QWidget, foreign: re.Pattern[str]) -> dict[str, str]:
    """Every such text of a window, and what tells it."""
    found = {}
    for widget in [window, *window.findChildren(QWidget)]:
        for text in () if is_never_shown(widget) else texts_of(widget):
            if english(foreign.sub(" ", text)):
                found[text] = f"{type(widget).__name__} {widget.objectName()}".strip()
    return found


def test_every_text_of_every_page_comes_from_a_catalogue(
    bench: Bench, qapp: QApplication, qtbot, measured_project: Path
) -> None:
    sheet = qapp.styleSheet()
    choose(language(PSEUDO), qapp)
    try:
        window = build_window(qapp, bench, "light")
        qtbot.addWidget(window)
        bench.model.open(measured_project)
        info = bench.model.project.info
        names = [re.escape(name) for name in (info.name, info.part, info.operator) if name]
        foreign = re.compile("|".join([rf"\b{name}\b" for name in (*names, *FOREIGN)]))
        window.show()
        found: dict[str, str] = {}
        seen = 0
        for step in STEPS:
            window.go_to(step.name)
            qtbot.wait(100)
            qtbot.waitUntil(lambda: not bench.quick.busy, timeout=60_000)
            found |= told_past_the_catalogues(window, foreign)
            seen = max(seen, sum("⟦" in text for one in window.findChildren(QWidget) for text in texts_of(one)))
        window.dismiss()
    finally:
        choose(language("en"), qapp)
        qapp.setStyleSheet(sheet)
    assert seen > 500  # the window does speak the pseudo-language
    assert found == {}
