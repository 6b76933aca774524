"""The list of results, the thickness first, with value ± U and verdict, and what can be done with each."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QModelIndex, QPersistentModelIndex, QPoint, Qt, QTimer, Signal
from PySide6.QtGui import QAction, QIcon, QKeySequence, QResizeEvent, QShortcut
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHeaderView,
    QMenu,
    QPushButton,
    QSizePolicy,
    QToolButton,
    QWidget,
)

from core.inspect.characteristic import thickness_characteristic
from core.inspect.plan import kinds
from core.inspect.plan.feature_kind import FeatureKind
from core.inspect.plan.kinds import kind_named, kind_of
from core.states import OUT_OF_DATE
from workbench.language import text_of, tr
from workbench.pages.inspect.features import values as fields
from workbench.pages.inspect.features import words
from workbench.pages.inspect.features.edit import InspectFeatureEdit
from workbench.pages.inspect.features.form import FeatureForm, choose_nominal
from workbench.pages.inspect.features.plan import THICKNESS, InspectFeatures
from workbench.pages.inspect.features.templates import InspectTemplates
from workbench.pages.inspect.largest import why_so_large
from workbench.pages.inspect.scan import InspectScan
from workbench.theme import icon
from workbench.views import ask
from workbench.views.control_frames import FRAMES_ROLE, SHORT_ROLE, Frame, FramesDelegate
from workbench.views.layouts import FewLines, enable, in_column, in_row, muted, set_text
from workbench.views.lists.tree_model import Cell, TreeList, TreeRow
from workbench.views.lists.value_rows import VERDICT_ICONS

if TYPE_CHECKING:
    from core.inspect.characteristic import Characteristic

FEWEST_ROWS, ROWS, MOST_ROWS = 3, 6, 16
"""The list shows so many rows, on a high page more, others are scrolled: it is always in sight, and below it the form
of a feature."""
LOWEST_PAGE, LOW_PAGE, SHARE = 410, 700, 0.45
"""Pixels of a page from which on and up to which there are so many rows as usual: a lower page is short of what is
missing; of what is beyond, the list takes this share."""


class FeaturesPanel(QWidget):
    """Panel with the list of features and its buttons, of constant height.

    The form of the chosen feature, how far the features are, and the notes on their results stand where whoever shows
    the panel has room for them.
    Without a scan and any feature: two buttons.
    """

    draw = Signal(str, str)
    """Name of a region and kind of tool: it is to be drawn."""
    show_place = Signal(str)
    """A feature, or THICKNESS, is to be shown on the part."""
    ask_limits = Signal(object)
    """The limits of the chosen feature are to be entered: the first editor of them, or None where it has none."""
    ask_thickness = Signal()
    """The limits of the thickness are to be entered."""
    measure_thickness = Signal()
    """It is to be measured again."""

    def __init__(
        self,
        features: InspectFeatures,
        edit: InspectFeatureEdit,
        templates: InspectTemplates,
        scan: InspectScan,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self._features, self._edit, self._scan = features, edit, scan
        self._shown: object = None
        self._page_height = LOW_PAGE
        self._frames: dict[str, Frame] = {}
        self._datums: dict[str, Frame] = {}
        self.list, self.add, self.measure = _List((tr("Feature"), tr("Value ± U"))), QPushButton(), QPushButton()
        self.templates = TemplatesButton(templates)
        self.remove, self.up, self.down = QToolButton(), QToolButton(), QToolButton()
        self.state, self.notes = FewLines(3, steady=True), muted()
        self.form = FeatureForm(features, edit, scan)
        self.kinds: dict[str, QAction] = {}
        self.actions_of_row: dict[str, QAction] = {}
        self._make_list()
        self._make_menu()
        self._row_menu = self._make_row_menu()
        column = in_column(self.list, on=self, spacing=3)
        for button in (self.remove, self.up, self.down):
            button.setAutoRaise(True)
        column.addLayout(in_row((self.measure, 1), self.remove, self.up, self.down))
        column.addLayout(in_row((self.add, 1), (self.templates, 1)))
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Maximum)
        self.form.draw.connect(self.draw)

    def fit(self, page_height: int) -> None:
        """Set the height of the list of features to suit a page of `page_height` px."""
        self._page_height = page_height
        self._fit_list()

    def refresh(self) -> None:
        """Show the list of features with their results, and which buttons are enabled."""
        features = self._features
        some = bool(features.plan.features)
        self.list.setVisible(some or self._scan.view is not None)
        for widget in (self.remove, self.up, self.down, self.measure):
            widget.setVisible(some)
        self._show_list()
        self._show_buttons()
        self.templates.refresh()
        self.state.setText(self._sentence())
        shown = features.shown
        set_text(self.notes, "" if shown is None or features.problem else "\n".join(map(text_of, shown.notes)))
        self.form.refresh()

    # ---- the list

    def _make_list(self) -> None:
        self.list.setAccessibleName(tr("Features"))
        self.list.setEditTriggers(
            QAbstractItemView.EditTrigger.EditKeyPressed | QAbstractItemView.EditTrigger.DoubleClicked
        )
        self.list.setExpandsOnDoubleClick(False)
        self.list.edited.connect(self._rename)
        self.list.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
        self.list.customContextMenuRequested.connect(self._show_row_menu)
        self.list.setIndentation(14)
        self.list.setItemDelegateForColumn(0, FramesDelegate(self.list))
        self.list.setUniformRowHeights(True)
        header = self.list.header()
        header.setStretchLastSection(False)
        header.setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        header.setSectionResizeMode(1, QHeaderView.ResizeMode.ResizeToContents)
        self.list.chosen.connect(self._features.choose)
        for keys, does in (
            (QKeySequence(QKeySequence.StandardKey.Delete), self._remove),
            (QKeySequence("Alt+Up"), lambda: self._features.move(self._features.chosen, -1)),
            (QKeySequence("Alt+Down"), lambda: self._features.move(self._features.chosen, 1)),
        ):
            shortcut = QShortcut(keys, self.list)
            shortcut.setContext(Qt.ShortcutContext.WidgetShortcut)
            shortcut.activated.connect(does)

    def _show_list(self) -> None:
        """The feature chosen is marked, and no other."""
        features = self._features
        results = [(features.result(name), features.outdated(name)) for name in features.plan.names]
        shown = (features.plan, results, features.measuring, self._scan.gauge, self._scan.is_thickness_old)
        if shown != self._shown:
            self._shown = shown
            self._frames, self._datums = words.required_frames(features.plan), words.datum_frames(features.plan)
            rows = [self._feature_row(spec.name, kind_of(spec)) for spec in features.plan.features]
            self.list.set_rows([self._thickness_row(), *rows])
            self._fit_list()
        self.list.choose(features.chosen)

    def _thickness_row(self) -> TreeRow:
        """The gauge's thickness: the first of all results."""
        name, gauge = tr("Thickness"), self._scan.gauge
        if gauge is None:
            return TreeRow(
                THICKNESS, (Cell(name, icon=icon("mdi6.arrow-expand-vertical")), Cell(tr("not measured"), right=True))
            )
        row, old = thickness_characteristic(gauge), self._scan.is_thickness_old
        tip = tr(OUT_OF_DATE["gauge"]) if old else words.tip(row)
        value = self._value(words.value(row), tip, _verdict_icon(row.verdict), old)
        return TreeRow(THICKNESS, (Cell(name, tip, icon("mdi6.arrow-expand-vertical")), value))

    def _fit_list(self) -> None:
        """As high as the page lets it be, whatever is in it: results that come push nothing below them."""
        row = self.list.sizeHintForRow(0)
        if row <= 0:
            return
        header, frame = self.list.header().sizeHint().height(), 2 * self.list.frameWidth()
        missing, beyond = max(LOWEST_PAGE - self._page_height, 0), max(self._page_height - LOW_PAGE, 0)
        rows = ROWS - math.ceil(missing / row) + round(SHARE * beyond / row)
        rows = min(max(rows, FEWEST_ROWS), MOST_ROWS) if self._features.plan.features else 1
        self.list.setFixedHeight(header + frame + rows * row)
        self.updateGeometry()

    def _feature_row(self, name: str, kind: FeatureKind) -> TreeRow:
        outdated = self._features.outdated(name)
        result = outdated or self._features.result(name)
        rows = () if result is None else result.rows
        text = words.value(rows[0]) if len(rows) == 1 else ""
        frames = [self._frames[row.name] for row in rows if row.name in self._frames] if text else []
        named = text and not frames  # the symbol says what it is
        mark: QIcon | None = None
        tips = [tr(kind.title)]
        if result is None:
            text = self._state()
        elif result.problem:
            text, mark = tr("cannot be measured"), icon("mdi6.alert-outline", colour="warn")
            tips.append(text_of(result.problem))
        else:
            tips += [words.used(result), *(words.tip(row) for row in rows)]
            text, mark = text or ("" if rows else tr("has been measured")), _verdict_icon(words.verdict(result))
        if outdated is not None:
            tips = [tips[0], tr(OUT_OF_DATE["feature"])]
        tip = "\n".join(tip for tip in tips if tip)
        feature = Cell(
            tr("{name}, {kind}", name=name, kind=words.short_name(rows[0], name)) if named else name,
            tip,
            icon(kind.icon),
            edited=name,
            more={
                FRAMES_ROLE: [*([self._datums[name]] if name in self._datums else []), *frames],
                SHORT_ROLE: name if named else "",  # its icon says the kind as well
            },
        )
        below = rows if len(rows) > 1 else ()
        return TreeRow(
            name,
            (feature, self._value(text, tip, mark, outdated is not None)),
            tuple(self._row_below(row, name, tips[-1] if outdated else "") for row in below),
        )

    def _row_below(self, row: Characteristic, name: str, outdated: str) -> TreeRow:
        tip = outdated or words.tip(row)
        frames = [self._frames[row.name]] if row.name in self._frames else []
        value = self._value(words.value(row), tip, _verdict_icon(row.verdict), bool(outdated))
        return TreeRow(row.name, (Cell(words.short_name(row, name), tip, more={FRAMES_ROLE: frames}), value))

    def _value(self, text: str, tip: str, mark: QIcon | None, outdated: bool) -> Cell:
        """One that is out of date stays readable until there is a new one, but it has no verdict any more."""
        if not outdated:
            return Cell(text, tip, mark, right=True)
        faint = {int(Qt.ItemDataRole.ForegroundRole): self.palette().placeholderText()}
        return Cell(text, tip, icon("mdi6.clock-outline", colour="muted"), right=True, more=faint)

    # ---- what can be done with a row

    def _make_row_menu(self) -> QMenu:
        """By the right button of the mouse, and by the menu key."""
        menu = QMenu(self)
        menu.setToolTipsVisible(True)
        for key, text, symbol, does in (
            ("rename", tr("Rename"), "mdi6.rename-outline", self._edit_name),
            ("duplicate", tr("Duplicate"), "mdi6.content-duplicate", self._duplicate),
            ("remove", tr("Remove"), "mdi6.delete-outline", self._remove),
            ("limits", tr("Limits …"), "mdi6.arrow-collapse-vertical", self._ask_limits),
            (
                "show",
                tr("Show on the part"),
                "mdi6.crosshairs-gps",
                lambda: self.show_place.emit(self._features.chosen),
            ),
            ("measure", tr("Measure again"), "mdi6.ruler-square", self._measure_again),
        ):
            action = menu.addAction(icon(symbol), text)
            action.triggered.connect(lambda _=False, does=does: does())
            self.actions_of_row[key] = action
        self.actions_of_row["rename"].setShortcut(QKeySequence(Qt.Key.Key_F2))
        self.actions_of_row["remove"].setShortcut(QKeySequence(QKeySequence.StandardKey.Delete))
        for action in self.actions_of_row.values():  # the list has these keys; the menu only names them
            action.setShortcutContext(Qt.ShortcutContext.WidgetShortcut)
        return menu

    def _show_row_menu(self, at: QPoint) -> None:
        name = self.list.key_at(at)
        if not name:
            return
        self._features.choose(name)
        self.refresh()
        self._row_menu.popup(self.list.viewport().mapToGlobal(at))

    def _show_row_actions(self) -> None:
        """Which of them are possible with the chosen row."""
        thickness = self._features.chosen == THICKNESS
        only = tr("The thickness is always measured: draw its faces under “What is measured”.") if thickness else ""
        can = self._features.buttons
        measured = (
            self._scan.gauge is not None if thickness else self._features.result(self._features.chosen) is not None
        )
        for key, why_not, tip in (
            ("rename", only, tr("Call it otherwise (F2, double click)")),
            ("duplicate", only, tr("Put a copy below it")),
            ("remove", only or can.remove, tr("Take the chosen feature out (Delete)")),
            ("limits", "", tr("Enter what is asked of it")),
            ("show", "" if measured else tr("Measure it first."), tr("Bring it to the middle of the surface")),
            ("measure", "" if thickness else can.measure, tr("Measure all features on this scan")),
        ):
            enable(self.actions_of_row[key], why_not, tip)

    def _edit_name(self) -> None:
        self.list.edit(self.list.currentIndex().siblingAtColumn(0))

    def _rename(self, name: str, to: str) -> None:
        self._features.choose(name)
        self._edit.set_value("name", to)

    def _duplicate(self) -> None:
        self._features.duplicate(self._features.chosen)

    def _ask_limits(self) -> None:
        """Go to the first field of its limits, once the form is there."""
        if self._features.chosen == THICKNESS:
            self.ask_thickness.emit()
        else:
            QTimer.singleShot(0, self, lambda: self.ask_limits.emit(self.form.first_limit))

    def _measure_again(self) -> None:
        if self._features.chosen == THICKNESS:
            self.measure_thickness.emit()
        else:
            self._features.measure()

    # ---- the buttons

    def _make_menu(self) -> None:
        menu = QMenu(self)
        menu.setToolTipsVisible(True)
        for kind in kinds.every_kind():
            action = menu.addAction(words.title(kind))
            action.triggered.connect(lambda _=False, kind=kind: self._add(kind))
            action.setIcon(icon(kind.icon))
            self.kinds[kind.name] = action
        for button, symbol in (
            (self.add, "mdi6.plus"),
            (self.measure, "mdi6.ruler-square"),
            (self.remove, "mdi6.delete-outline"),
            (self.up, "mdi6.arrow-up"),
            (self.down, "mdi6.arrow-down"),
        ):
            button.setIcon(icon(symbol))
        self.add.setText(tr("Add feature"))
        self.add.setMenu(menu)
        self.measure.setText(tr("Measure all"))
        self.measure.clicked.connect(lambda: self._features.measure())
        self.remove.clicked.connect(self._remove)
        self.up.clicked.connect(lambda: self._features.move(self._features.chosen, -1))
        self.down.clicked.connect(lambda: self._features.move(self._features.chosen, 1))

    def _state(self) -> str:
        """Of a feature without a value."""
        if not self._features.measuring:
            return tr("not measured")
        return tr("reading …") if self._features.up_to_date else tr("measuring …")

    def _show_buttons(self) -> None:
        for name, action in self.kinds.items():
            enable(action, fields.why_not(name, self._features.plan), tr(kind_named(name).help))
        self.add.setToolTip(tr("Measure something beside the thickness"))
        can = self._features.buttons
        again = tr(
            "Nothing has changed since all features were measured. Measure them again, as after a nominal file did"
        )
        tip = again if self._features.up_to_date else tr("Measure all features on this scan")
        enable(self.measure, can.measure, tip)
        for button, why_not, tip in (
            (self.remove, can.remove, tr("Take the chosen feature out (Delete)")),
            (self.up, can.up, tr("Move the chosen feature up (Alt+Up)")),
            (self.down, can.down, tr("Move the chosen feature down (Alt+Down)")),
        ):
            enable(button, why_not, tip)
            button.setAccessibleName(tip)
        self._show_row_actions()

    def _sentence(self) -> str:
        features = self._features
        if not features.plan.features:
            return self._why_U() or tr("Steps, spheres, flatness, sections and more, beside the thickness.")
        if features.problem:
            return features.problem
        chosen = features.result(features.chosen)
        if chosen is not None and chosen.problem:
            return text_of(chosen.problem)
        if features.measuring:
            return ""
        if features.shown is not None:
            return self._why_U()
        return features.buttons.measure or tr("The features have changed or are not measured yet: measure them.")

    def _why_U(self) -> str:
        """Why U of the chosen result is as large as it is, of the thickness where none is chosen."""
        chosen = self._features.chosen
        if chosen not in self._features.plan.names:
            gauge = self._scan.gauge
            return "" if gauge is None or self._scan.is_thickness_old else why_so_large(thickness_characteristic(gauge))
        result = None if self._features.outdated(chosen) is not None else self._features.result(chosen)
        return why_so_large(result.rows[0]) if result is not None and result.rows else ""

    def _add(self, kind: FeatureKind) -> None:
        if not kind.nominal_file:
            self._edit.add(kind.name)
            return
        path = choose_nominal(self, self._features.model.folder)
        if path is not None:
            self._edit.add(kind.name, path)

    def _remove(self) -> None:
        if self._features.chosen in self._features.plan.names:
            self._features.remove(self._features.chosen)


def _verdict_icon(verdict: str) -> QIcon | None:
    if not verdict:
        return None
    symbol, colour = VERDICT_ICONS[verdict]
    return icon(symbol, colour=colour)


class _List(TreeList):
    """Keeps the chosen row in sight, however high it is made, and those below it as far as there is room."""

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.scrollTo(self.currentIndex())  # an index of nothing moves nothing

    def scrollTo(
        self,
        index: QModelIndex | QPersistentModelIndex,
        hint: QAbstractItemView.ScrollHint = QAbstractItemView.ScrollHint.EnsureVisible,
    ) -> None:
        model = self.model()
        if below := model.rowCount(index) if index.isValid() else 0:
            super().scrollTo(model.index(below - 1, 0, index), hint)
        super().scrollTo(index, hint)


class TemplatesButton(QPushButton):
    """Menu: save the plan as a template, take one from a file, or one of those used last."""

    def __init__(self, templates: InspectTemplates, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._templates = templates
        self._paths: list[Path] | None = None
        self.setText(tr("Templates"))
        self.setIcon(icon("mdi6.playlist-plus"))
        self.setToolTip(tr("Keep these features for the next part, or take those of another"))
        menu = QMenu(self)
        menu.setToolTipsVisible(True)
        self.save = menu.addAction(icon("mdi6.content-save-outline"), tr("Save as template …"))
        self.open = menu.addAction(icon("mdi6.folder-open-outline"), tr("Take from file …"))
        self.open.setToolTip(tr("Measure the features of a plan.toml from now on, instead of these"))
        self._line = menu.addSeparator()
        self.recent: list[QAction] = []
        self.save.triggered.connect(lambda: self._save())
        self.open.triggered.connect(lambda: self._open())
        self.setMenu(menu)

    def refresh(self) -> None:
        """Fill the menu with the templates used last, and enable what is possible."""
        why_not, paths = self._templates.cannot_save, self._templates.recent
        enable(self.save, why_not, tr("Write these features, their regions and limits to a file"))
        if paths == self._paths:
            return
        self._paths = paths
        menu = self.menu()
        for action in self.recent:
            menu.removeAction(action)
            action.deleteLater()
        self.recent = []
        for path in paths:
            action = menu.addAction(path.stem)
            action.setToolTip(tr("Measure these features on this part: {plan}", plan=path))
            action.triggered.connect(lambda _=False, path=path: self._templates.take(path))
            self.recent.append(action)
        self._line.setVisible(bool(paths))

    def _save(self) -> None:
        path = ask.choose_file_to_save(self, tr("Save as template"), self._templates.place(), tr("Plan (*.toml)"))
        if path is not None:
            self._templates.save(path)

    def _open(self) -> None:
        path = ask.choose_file_to_open(
            self, tr("Take the features of a template"), self._templates.place().parent, tr("Plan (*.toml)")
        )
        if path is not None:
            self._templates.take(path)
