"""Panels at the side of the inspect page: what is measured and where, the result, picked points and distances."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtWidgets import (
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QListView,
    QPushButton,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from core.inspect.characteristic import thickness_characteristic
from core.inspect.shown.view_frame import FRAME_NAMES, ViewFrame
from core.report.facts.of_budget import budget_facts
from core.report.facts.of_gauge import gauge_facts
from core.report.wording import verdict_sentence
from core.states import OUT_OF_DATE
from workbench.language import number, sentence, text_of, tr
from workbench.pages.inspect import words
from workbench.pages.inspect.faces import FACES, NUMBERS
from workbench.pages.inspect.largest import why_so_large
from workbench.pages.inspect.part import MATERIAL_NAMES, WITH_U
from workbench.pages.inspect.picks import Mode, Pick, Span
from workbench.pages.inspect.presenter import InspectPresenter
from workbench.pages.inspect.stage import PicksFacts, picks_buttons
from workbench.pages.setting_fields import add_rig_settings
from workbench.pages.words import show_facts, wording
from workbench.step_state import State
from workbench.theme import icon
from workbench.views.colours import FACE_LOWER, FACE_UPPER
from workbench.views.forms.editors import NumberRange
from workbench.views.forms.form import SettingsForm
from workbench.views.layouts import alarm, enable, heading, in_column, in_row, muted, set_notes, set_text
from workbench.views.lists.tree_model import Cell, TreeModel, TreeRow
from workbench.views.lists.value_rows import ValueRows, Verdict

if TYPE_CHECKING:
    from core.inspect.results import GaugeResult, PairCandidate


class PartPanel(QWidget):
    """Panel of the part: material, temperature, layer of spray."""

    def __init__(self, presenter: InspectPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._part = presenter.part
        self.form = SettingsForm()
        self.form.add_choice(
            "material",
            tr("Material"),
            [("", tr("not stated")), *((name, tr(shown)) for name, shown in MATERIAL_NAMES.items())],
            tr("Light may come from below the surface of all but metal: U holds it as far as nothing excludes it."),
        )
        assumed = tr("assumed")
        help = tr("While it was scanned; empty: 20 °C with u = 3 °C.")
        self._number(
            "celsius", tr("Temperature"), NumberRange(-50, 200, decimals=2, unit="°C", none_text=assumed), help
        )
        self._u("u_celsius", tr("Temperature, u"), "°C")
        none = tr("none")
        for key, name, help in (
            ("spray_mm", tr("Layer of spray"), tr("On the upper face, less that on the lower one; it is taken off.")),
            ("offset_mm", tr("Seen below the surface"), tr("By this much, found on a master of the material.")),
        ):
            self._number(key, name, NumberRange(0, 10, decimals=4, step=0.005, unit="mm", none_text=none), help)
            self._u(WITH_U[key][0], tr("{name}, u", name=name), "mm")
        self.form.edited.connect(self._part.set_value)
        in_column(self.form, on=self, spacing=4)

    def refresh(self) -> None:
        """Show the project's statements on the part: material, temperature, layer of spray."""
        self.form.set_values(self._part.values())

    def _number(self, key: str, name: str, allowed: NumberRange, help: str) -> None:
        first = 20.0 if key == "celsius" else 0.01
        self.form.add_number(key, name, replace(allowed, first=first), help)

    def _u(self, key: str, name: str, unit: str) -> None:
        most, decimals = (20.0, 2) if unit == "°C" else (10.0, 4)
        usual = next(usual for u, usual in WITH_U.values() if u == key)
        allowed = NumberRange(0, most, decimals=decimals, step=usual, unit=unit, none_text=tr("none"), first=usual)
        self.form.add_number(key, name, allowed, tr("Standard uncertainty of that."))


class FacesPanel(QWidget):
    """Panel of nominal value and tolerance, of the faces, and the tools to draw them."""

    draw = Signal(str, str)
    """Face and kind of tool: a region is to be drawn."""

    def __init__(self, presenter: InspectPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self.form = SettingsForm()
        add_rig_settings(self.form, "gauge")
        self.form.edited.connect(presenter.faces.set_number)
        self.states = {face: QLabel() for face in FACES}
        self.tools: dict[tuple[str, str], QToolButton] = {}
        self.words, self.own, self.automatic = muted(), QPushButton(), QPushButton()
        self.several, self.pairs = muted(), QVBoxLayout()
        self._offered: tuple[PairCandidate, ...] = ()
        self.own.setText(tr("Edit those found"))
        self.automatic.setText(tr("Automatic"))
        self.exchange = QToolButton()
        self.own.setIcon(icon("mdi6.vector-square-edit"))
        self.automatic.setIcon(icon("mdi6.auto-fix"))
        self.exchange.setAutoRaise(True)
        self.exchange.setIcon(icon("mdi6.swap-vertical"))
        self.exchange.setAccessibleName(tr("Exchange the upper and the lower region"))
        self.own.clicked.connect(lambda: presenter.faces.take_found())
        self.automatic.clicked.connect(lambda: presenter.faces.find_automatically())
        self.exchange.clicked.connect(lambda: presenter.faces.exchange())
        above = (self.form, heading(tr("Faces")), self._rows(), self.words, self.several, self.pairs)
        column = in_column(*above, on=self, spacing=4)
        row = in_row((self.own, 1), (self.automatic, 1), self.exchange)
        column.addLayout(row)

    def refresh(self) -> None:
        """Show nominal value, tolerance and regions of the faces, and which buttons are enabled."""
        faces = self._presenter.faces
        self.form.set_values(faces.values())
        for key in NUMBERS:
            self.form.set_complaint(key, faces.complaint(key))
        names = {"upper": tr("Upper"), "lower": tr("Lower")}
        for face, label in self.states.items():
            region = faces.region(face)
            if face == self._presenter.outlining:
                state = tr("being outlined …")
            elif region is None:
                state = tr("found automatically")
            else:
                state = tr("own region, {count} corners", count=len(region))
            colour = FACE_UPPER if face == "upper" else FACE_LOWER
            said = tr("{name}: {value}", name=names[face], value=state)
            label.setText(f"<span style='color:{colour}'>■</span> {said}")
        can = faces.buttons
        for (face, kind), button in self.tools.items():
            enable(button, can.draw, self._tip(face, kind))
        self.words.setText(faces.missing())
        self.words.setVisible(bool(faces.missing()))
        self._offer(faces.candidates)
        enable(self.own, can.take_found, tr("Make the outlines of the faces found regions you can change"))
        enable(
            self.automatic,
            can.automatic,
            tr("Remove the regions: the two largest parallel faces are looked for again"),
        )
        enable(self.exchange, can.exchange, tr("Exchange the upper and the lower region"))

    def _offer(self, candidates: tuple[PairCandidate, ...]) -> None:
        """A button for each pair of faces that could be meant."""
        self.several.setText(tr("Say which faces are meant:"))
        self.several.setVisible(bool(candidates))
        if candidates == self._offered:
            return
        self._offered = candidates
        while (item := self.pairs.takeAt(0)) is not None:
            if (widget := item.widget()) is not None:
                widget.hide()
                widget.deleteLater()
        for place, one in enumerate(candidates):
            mm = number(one.thickness_mm, ".1f")
            said = tr("These: {mm} mm apart", mm=mm) if place else tr("These, as measured: {mm} mm apart", mm=mm)
            button = QPushButton(icon("mdi6.check"), said, self)
            u, v = (f"{px:.0f}" for px in one.upper_px)
            tip = tr("Take these faces as regions: the upper one is at pixel {u}, {v}. Then measure again.", u=u, v=v)
            enable(button, self._presenter.faces.buttons.draw, tip)
            button.clicked.connect(lambda _=False, one=one: self._presenter.faces.confirm(one))
            self.pairs.addWidget(button)

    def _rows(self) -> QGridLayout:
        grid = QGridLayout()
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setSpacing(4)
        grid.setColumnStretch(0, 1)
        for row, (face, label) in enumerate(self.states.items()):
            label.setTextFormat(Qt.TextFormat.RichText)
            grid.addWidget(label, row, 0)
            for column, kind in enumerate(("polygon", "lasso"), start=1):
                button = QToolButton()
                button.setAutoRaise(True)
                button.setIconSize(QSize(20, 20))
                button.setIcon(icon("mdi6.vector-polygon" if kind == "polygon" else "mdi6.lasso"))
                button.setAccessibleName(self._does(face, kind))
                button.clicked.connect(lambda _=False, face=face, kind=kind: self.draw.emit(face, kind))
                self.tools[face, kind] = button
                grid.addWidget(button, row, column)
        return grid

    @staticmethod
    def _does(face: str, kind: str) -> str:
        return {
            ("upper", "polygon"): tr("Draw the upper face corner by corner"),
            ("lower", "polygon"): tr("Draw the lower face corner by corner"),
            ("upper", "lasso"): tr("Draw round the upper face with the button held down"),
            ("lower", "lasso"): tr("Draw round the lower face with the button held down"),
        }[face, kind]

    def _tip(self, face: str, kind: str) -> str:
        more = tr(
            "In the picture the region is what you draw. In 3D it becomes the outline, in the picture, of the plane "
            "face you draw round; what is seen behind it does not count. A region may reach over the face's edge."
        )
        return f"{sentence(self._does(face, kind))} {more}"


class ResultPanel(QWidget):
    """Panel of the thickness with its details."""

    def __init__(self, presenter: InspectPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self._shown: object = None
        self.verdict, self.rows, self.rule = Verdict(), ValueRows(), muted()
        self.largest, self.budget, self.notes, self.alarm = muted(), ValueRows(), muted(), alarm()
        self.budget_title, self.notes_title = heading(tr("Uncertainty budget")), heading(tr("Notes"))
        column = in_column(on=self, spacing=6)
        for widget in (
            self.verdict, self.alarm, self.rows, self.rule, self.budget_title, self.largest, self.budget,
            self.notes_title, self.notes,
        ):  # fmt: skip
            column.addWidget(widget)

    def refresh(self) -> None:
        """Show the verdict, the thickness and its details, or why there is none."""
        p = self._presenter
        gauge, outdated = p.scan.gauge, p.state.state is not State.DONE
        if gauge is None or (p.scan.serial, outdated) == self._shown:
            return
        self._shown = (p.scan.serial, outdated)
        self._show_verdict(gauge, outdated)
        show_facts(self.rows, gauge_facts(gauge))
        self.rule.setText("" if gauge.rule is None else tr("Rule: {rule}.", rule=text_of(gauge.rule)))
        thickness = thickness_characteristic(gauge)
        set_text(self.largest, why_so_large(thickness))
        show_facts(self.budget, budget_facts(thickness))
        set_notes(gauge.notes, self.alarm, self.notes)
        self.notes_title.setVisible(bool(self.notes.text()))

    def _show_verdict(self, gauge: GaugeResult, outdated: bool) -> None:
        """What was proven of other faces or another tolerance is proven no more."""
        if outdated:
            self.verdict.set_verdict("", tr(OUT_OF_DATE["gauge"]))
        else:
            self.verdict.set_verdict(words.verdict(gauge), verdict_sentence(gauge, wording()))


class PicksPanel(QWidget):
    """Panel with tools to pick points and distances, and the list of them as soon as there are some."""

    pick = Signal(str)
    """Points ("point") or distances ("distance") are to be picked; "": no more."""

    def __init__(self, presenter: InspectPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self._names: list[str] = []
        self._frame: ViewFrame | None = None
        self.tools: dict[Mode, QPushButton] = {
            "point": QPushButton(icon("mdi6.crosshairs-gps"), tr("Pick points")),
            "distance": QPushButton(icon("mdi6.ruler"), tr("Measure distance")),
        }
        self.list, self._model = QListView(), TreeModel(self)
        self.list.setModel(self._model)
        self.remove = QPushButton(icon("mdi6.playlist-remove"), tr("Remove"))
        self.clear = QPushButton(icon("mdi6.close"), tr("Remove all"))
        self.list.setAccessibleName(tr("Picked points and distances"))
        self.list.setWordWrap(True)
        self.list.setFixedHeight(120)
        above, below = QHBoxLayout(), QHBoxLayout()
        for mode, button in self.tools.items():
            button.setCheckable(True)
            button.clicked.connect(lambda on, mode=mode: self.pick.emit(mode if on else ""))
            above.addWidget(button, 1)
        below.addWidget(self.remove, 1)
        below.addWidget(self.clear, 1)
        self.frame = muted()
        self.help = muted(
            tr(
                "σ of a point is the standard uncertainty of its depth, u of a distance the two points' share. "
                "The calibrations' share is not in them. Points and distances are not kept with the project."
            )
        )
        self.help.setObjectName("help")
        in_column(above, self.frame, self.list, below, self.help, on=self)
        self.remove.clicked.connect(self._remove)
        self.clear.clicked.connect(lambda: presenter.picks.clear())
        self.list.selectionModel().currentChanged.connect(lambda: self._show_buttons())

    def refresh(self) -> None:
        """Show the list of picked points and distances, and which buttons are enabled."""
        picks = self._presenter.picks
        for mode, button in self.tools.items():
            button.setChecked(picks.mode == mode)
        names = [item.name for item in picks.items]
        frame = self._presenter.frame
        if names != self._names or self._frame is None or not frame.same_as(self._frame):
            newest = names[-1] if names and names != self._names else ""
            self._names, self._frame = names, frame
            self.frame.setText(tr("x, y, z: {frame}", frame=tr(FRAME_NAMES[frame.kind])))
            self._model.set_rows([TreeRow(item.name, (Cell(_pick_text(item, frame)),)) for item in picks.items])
            if newest:
                self.list.setCurrentIndex(self._model.index_of(newest))
        self._show_buttons()

    def _show_buttons(self) -> None:
        for widget in (self.frame, self.list, self.remove, self.clear):
            widget.setVisible(bool(self._names))
        chosen = self.list.currentIndex().isValid()
        can = picks_buttons(PicksFacts(self._presenter.scan.buttons.use, bool(self._names), chosen))
        tips: dict[Mode, str] = {
            "point": tr("Click points in 3D: x, y, z in mm in the frame of the view, with picture and pixel"),
            "distance": tr("Click two points in 3D: their distance in mm with its standard uncertainty"),
        }
        for mode, button in self.tools.items():
            enable(button, can.pick, tips[mode])
        enable(self.remove, can.remove, tr("Take the chosen one off the list"))
        enable(self.clear, can.clear, tr("Take all points and distances off the list"))

    def _remove(self) -> None:
        name = self._model.key(self.list.currentIndex())
        if name:
            self._presenter.picks.remove(name)


def _pick_text(item: Pick | Span, frame: ViewFrame) -> str:
    return "\n".join(words.pick_lines(item, frame) if isinstance(item, Pick) else words.span_lines(item, frame))
