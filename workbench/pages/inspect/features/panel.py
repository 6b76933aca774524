"""The panel of features: what is measured beside the thickness, with value ± U and verdict, and the one chosen."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QEvent, Qt, Signal
from PySide6.QtGui import QAction, QKeySequence, QShortcut
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHBoxLayout,
    QHeaderView,
    QMenu,
    QPushButton,
    QToolButton,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)

from core.inspect.feature_spec import Kind
from workbench.pages import inspect_feature_values as fields
from workbench.pages import inspect_feature_words as words
from workbench.pages.inspect_feature_form import FeatureForm
from workbench.pages.inspect_presenter import InspectPresenter
from workbench.pages.inspect_templates_button import TemplatesButton
from workbench.pages.step_page import muted
from workbench.theme import icon
from workbench.views import ask
from workbench.views.value_rows import VERDICT_ICONS

if TYPE_CHECKING:
    from core.inspect.characteristic import Characteristic

MOST_ROWS = 12
"""The list shows so many rows before it is scrolled."""


class FeaturesPanel(QWidget):
    """List, buttons, and the form of the chosen feature. Without any feature: one line and one button."""

    draw = Signal(str, str)
    """Name of a region and kind of tool: it is to be drawn."""

    def __init__(self, presenter: InspectPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter, self._features = presenter, presenter.features
        self._shown: object = None
        self.list, self.add, self.measure = QTreeWidget(), QPushButton(), QPushButton()
        self.templates = TemplatesButton(presenter.features.templates)
        self.remove, self.up, self.down = QToolButton(), QToolButton(), QToolButton()
        self.state, self.form = muted(), FeatureForm(presenter)
        self.kinds: dict[Kind, QAction] = {}
        self._make_list()
        self._make_menu()
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(4)
        column.addWidget(self.list)
        row = QHBoxLayout()
        row.addWidget(self.add, 1)
        for button in (self.remove, self.up, self.down):
            button.setAutoRaise(True)
            row.addWidget(button)
        column.addLayout(row)
        row = QHBoxLayout()
        row.addWidget(self.templates, 1)
        row.addWidget(self.measure, 1)
        column.addLayout(row)
        column.addWidget(self.state)
        column.addWidget(self.form)
        self.form.draw.connect(self.draw)
        self._dress()

    def refresh(self) -> None:
        """Show what the presenter says now."""
        features = self._features
        some = bool(features.plan.features)
        for widget in (self.list, self.remove, self.up, self.down, self.measure):
            widget.setVisible(some)
        self._show_list()
        self._show_buttons()
        self.templates.refresh()
        self.state.setText(self._sentence())
        self.state.setVisible(bool(self.state.text()))
        self.form.refresh()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and hasattr(self, "form"):
            self._dress()
            self._shown = None
            self._show_list()

    # ---- the list

    def _make_list(self) -> None:
        self.list.setColumnCount(2)
        self.list.setHeaderLabels([self.tr("Feature"), self.tr("Value ± U")])
        self.list.setAccessibleName(self.tr("Features"))
        self.list.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.list.setIndentation(14)
        self.list.setUniformRowHeights(True)
        header = self.list.header()
        header.setStretchLastSection(False)
        header.setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        header.setSectionResizeMode(1, QHeaderView.ResizeMode.ResizeToContents)
        self.list.currentItemChanged.connect(self._chosen)
        for keys, does in (
            (QKeySequence(QKeySequence.StandardKey.Delete), self._remove),
            (QKeySequence("Alt+Up"), lambda: self._features.move(self._features.chosen, -1)),
            (QKeySequence("Alt+Down"), lambda: self._features.move(self._features.chosen, 1)),
        ):
            shortcut = QShortcut(keys, self.list)
            shortcut.setContext(Qt.ShortcutContext.WidgetShortcut)
            shortcut.activated.connect(does)

    def _show_list(self) -> None:
        """All items anew where anything in them has changed; the one chosen stays chosen."""
        features = self._features
        shown = (features.plan, features.shown, features.measuring)
        if shown != self._shown:
            self._shown = shown
            self.list.blockSignals(True)
            self.list.clear()
            self.list.addTopLevelItems([self._item(spec.name, spec.kind) for spec in features.plan.features])
            self.list.expandAll()
            self.list.blockSignals(False)
            self._fit_list()
        names = features.plan.names
        wanted = self.list.topLevelItem(names.index(features.chosen)) if features.chosen in names else None
        current = self.list.currentItem()
        if wanted is not None and (current is None or wanted not in (current, current.parent())):
            self.list.blockSignals(True)
            self.list.setCurrentItem(wanted)
            self.list.blockSignals(False)

    def _fit_list(self) -> None:
        """As high as its rows, up to a point: nothing is scrolled that there is room for."""
        items = [self.list.topLevelItem(place) for place in range(self.list.topLevelItemCount())]
        rows = sum(1 + item.childCount() for item in items if item is not None)
        row = self.list.sizeHintForRow(0) if rows else 0
        header, frame = self.list.header().sizeHint().height(), 2 * self.list.frameWidth()
        self.list.setFixedHeight(header + frame + min(rows, MOST_ROWS) * row)

    def _item(self, name: str, kind: Kind) -> QTreeWidgetItem:
        result = self._features.result(name)
        rows = () if result is None else result.rows
        text = words.value(rows[0]) if len(rows) == 1 else ""
        item = QTreeWidgetItem([f"{name}, {words.short_name(rows[0], name)}" if text else name, text])
        item.setData(0, Qt.ItemDataRole.UserRole, name)
        item.setIcon(0, icon(words.SYMBOLS[kind]))
        item.setTextAlignment(1, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        tips = [words.title(kind).removesuffix(" …")]
        if result is None:
            item.setText(1, self.tr("measuring …") if self._features.measuring else self.tr("not measured"))
        elif result.problem:
            item.setText(1, self.tr("cannot be measured"))
            item.setIcon(1, icon("mdi6.alert-outline", colour="warn"))
            tips.append(result.problem)
        else:
            tips += [words.used(result), *(words.tip(row) for row in rows)]
            self._mark(item, words.verdict(result))
            if not rows:
                item.setText(1, self.tr("measured"))
            if len(rows) > 1:
                item.addChildren([self._row(words.short_name(row, name), row, name) for row in rows])
        for column in (0, 1):
            item.setToolTip(column, "\n".join(tip for tip in tips if tip))
        return item

    def _row(self, text: str, row: Characteristic, name: str) -> QTreeWidgetItem:
        item = QTreeWidgetItem([text, words.value(row)])
        item.setData(0, Qt.ItemDataRole.UserRole, name)
        item.setTextAlignment(1, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self._mark(item, row.verdict)
        for column in (0, 1):
            item.setToolTip(column, words.tip(row))
        return item

    def _mark(self, item: QTreeWidgetItem, verdict: str) -> None:
        if verdict:
            symbol, colour = VERDICT_ICONS[verdict]
            item.setIcon(1, icon(symbol, colour=colour))

    def _chosen(self, item: QTreeWidgetItem | None) -> None:
        self._features.choose("" if item is None else str(item.data(0, Qt.ItemDataRole.UserRole)))

    # ---- the buttons

    def _make_menu(self) -> None:
        menu = QMenu(self)
        menu.setToolTipsVisible(True)
        for kind in fields.KINDS:
            action = menu.addAction(words.title(kind))
            action.triggered.connect(lambda _=False, kind=kind: self._add(kind))
            self.kinds[kind] = action
        self.add.setText(self.tr("Add feature"))
        self.add.setMenu(menu)
        self.measure.setText(self.tr("Measure all"))
        self.measure.clicked.connect(lambda: self._features.measure())
        self.remove.clicked.connect(self._remove)
        self.up.clicked.connect(lambda: self._features.move(self._features.chosen, -1))
        self.down.clicked.connect(lambda: self._features.move(self._features.chosen, 1))

    def _show_buttons(self) -> None:
        features, plan = self._features, self._features.plan
        for kind, action in self.kinds.items():
            why_not = fields.why_not(kind, plan)
            action.setEnabled(not why_not)
            action.setToolTip(why_not or words.help_of(kind))
        self.add.setToolTip(self.tr("Measure something beside the thickness"))
        why_not = features.cannot_measure
        self.measure.setEnabled(not why_not)
        self.measure.setToolTip(why_not or self.tr("Measure all features on this scan"))
        place = plan.names.index(features.chosen) if features.chosen in plan.names else -1
        choose = self.tr("Choose a feature first.")
        for button, why_not, tip in (
            (self.remove, features.cannot_remove(features.chosen), self.tr("Take the chosen feature out (Delete)")),
            (self.up, choose if place < 0 else self.tr("It is the first.") if not place else "",
             self.tr("Move the chosen feature up (Alt+Up)")),
            (self.down, choose if place < 0 else self.tr("It is the last.") if place == len(plan.names) - 1 else "",
             self.tr("Move the chosen feature down (Alt+Down)")),
        ):  # fmt: skip
            button.setEnabled(not why_not)
            button.setToolTip(why_not or tip)
            button.setAccessibleName(tip)

    def _sentence(self) -> str:
        features = self._features
        if not features.plan.features:
            return self.tr("Steps, spheres, flatness, sections and more, beside the thickness.")
        if features.problem:
            return features.problem
        chosen = features.result(features.chosen)
        if chosen is not None and chosen.problem:
            return chosen.problem
        if features.measuring or features.shown is not None:
            shown = features.shown
            return "" if shown is None else "\n".join(shown.notes)
        return features.cannot_measure or self.tr("The features have changed or are not measured yet: measure them.")

    def _add(self, kind: Kind) -> None:
        if kind != "deviation":
            self._features.edit.add(kind)
            return
        start = self._presenter.model.folder
        path = ask.choose_file_to_open(self, self.tr("Nominal surface"), start, self.tr("STL (*.stl *.STL)"))
        if path is not None:
            self._features.edit.add(kind, path)

    def _remove(self) -> None:
        if self._features.chosen:
            self._features.remove(self._features.chosen)

    def _dress(self) -> None:
        for button, symbol in (
            (self.add, "mdi6.plus"),
            (self.measure, "mdi6.ruler-square"),
            (self.remove, "mdi6.delete-outline"),
            (self.up, "mdi6.arrow-up"),
            (self.down, "mdi6.arrow-down"),
        ):
            button.setIcon(icon(symbol))
        for kind, action in self.kinds.items():
            action.setIcon(icon(words.SYMBOLS[kind]))
