"""Compare with an artefact: choose it from the registers, or add, change or remove one there."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import asdict
from datetime import date
from typing import cast

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QDialog, QLabel, QPushButton, QWidget

from core.checks.artefact_check import KINDS, Artefact, ArtefactKind
from core.messages import capital
from core.report.wording import with_uncertainty
from workbench.language import number, tr
from workbench.pages.scan.artefacts import KnownArtefacts
from workbench.pages.words import wording
from workbench.theme import icon, shades
from workbench.views import ask
from workbench.views.common import Choice, dress
from workbench.views.forms.editors import NumberRange
from workbench.views.forms.form import SettingsForm
from workbench.views.layouts import STRETCH, enable, heading, in_column, in_row, muted, resize_on_screen, set_text
from workbench.views.lists.data_table import DataTable

LONGEST_ID = 60
"""Letters."""


class ArtefactDialog(QDialog):
    """Dialog with the registers at the left, and the fields of the chosen or a new artefact.

    To be shown with `open`.
    """

    def __init__(self, artefacts: KnownArtefacts, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(tr("Compare with an artefact"))
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        resize_on_screen(self, 1240, 540)
        self._artefacts, self._ids, self._wanted = artefacts, tuple[str, ...](), ""
        self._filled: Artefact | None = None
        self.table, self.said, self.problem = DataTable(), muted(), QLabel()
        self.problem.setWordWrap(True)
        self.table.set_headers(
            [
                (tr("Artefact"), ""),
                (tr("Kind"), ""),
                (tr("Certified"), "mm"),
                (tr("U"), "mm"),
                (tr("Certificate"), ""),
                (tr("Valid until"), ""),
                (tr("Register"), ""),
            ]
        )
        self.form = self._fields()
        self.add = QPushButton(icon("mdi6.plus"), tr("Add"))
        self.change, self.remove = QPushButton(tr("Replace")), QPushButton(icon("mdi6.delete-outline"), tr("Remove"))
        self.compare, self.close_it = QPushButton(tr("Compare")), QPushButton(tr("Close"))
        self.compare.setProperty("primary", True)
        for button in (self.add, self.change, self.remove, self.compare, self.close_it):
            button.setAutoDefault(False)
        self.length_title, self.length = QLabel(tr("Compared is")), Choice()
        self.length_title.setBuddy(self.length)
        self._arrange()
        self.table.current_row_changed.connect(self._chosen)
        self.table.row_activated.connect(lambda _: self.compare.click())
        self.add.clicked.connect(self._add)
        self.change.clicked.connect(self._change)
        self.remove.clicked.connect(self._remove)
        self.compare.clicked.connect(self._compare)
        self.close_it.clicked.connect(self.reject)
        self.close_it.setFocus()  # a table that has the focus chooses its first row: nobody chose that artefact
        artefacts.changed.connect(self.refresh)
        artefacts.read()
        self.refresh()

    @property
    def chosen(self) -> Artefact | None:
        """Artefact that is chosen in the table; None if none is."""
        row = self.table.current_row()
        return self._artefacts.known.get(self._ids[row]) if 0 <= row < len(self._ids) else None

    def refresh(self) -> None:
        """Show the artefacts of both registers."""
        known, of_project = self._artefacts.known, self._artefacts.of_project
        before = self.chosen
        wanted, self._ids = self._wanted or (before.id if before else ""), tuple(known)
        self.table.set_rows([row(one, one.id in of_project) for one in known.values()])
        if wanted in self._ids:
            self.table.set_current_row(self._ids.index(wanted))
            self._wanted = ""
        dress(self.problem, f"color: {shades().bad};")
        set_text(self.problem, self._artefacts.problem)
        self._show_chosen()

    def _arrange(self) -> None:
        help = muted(
            tr(
                "What was measured last is compared with the certificate of the artefact that was scanned: the "
                "thickness of a block, or the diameter of a sphere or the height of a step among the features. The "
                "result is kept in the history of the rig."
            )
        )
        title = heading(tr("Artefact"))
        side = QWidget()
        side.setFixedWidth(300)
        buttons = in_row(STRETCH, self.change, self.add, spacing=6)
        in_column(title, self.form, buttons, STRETCH, on=side, spacing=6)
        of = in_row(self.length_title, self.length, STRETCH, self.remove, spacing=6)
        left = in_column(help, (self.table, 1), of, self.said, self.problem, spacing=6)
        ends = in_row(STRETCH, self.close_it, self.compare, spacing=6)
        in_column((in_row((left, 1), side, spacing=16), 1), ends, on=self, margins=(16, 14, 16, 12), spacing=8)

    def _fields(self) -> SettingsForm:
        form = SettingsForm()
        form.add_text("id", tr("Name"), tip=tr("What is engraved on it, as GB 50-7"))
        form.add_choice("kind", tr("Kind"), [(kind, capital(tr(words))) for kind, words in KINDS.items()])
        length = NumberRange(0.001, 5000.0, decimals=5, step=1.0, unit="mm", none_text=tr("none"), first=50.0)
        form.add_number("value_mm", tr("Certified length"), length, tip=tr("At 20 °C"))
        width = NumberRange(1e-6, 10.0, decimals=6, step=0.0001, unit="mm", none_text=tr("none"), first=0.0004)
        form.add_number("U_mm", tr("U of it"), width, tip=tr("Expanded uncertainty, with the k of the certificate"))
        form.add_number("k", tr("Its k"), NumberRange(1.0, 10.0, decimals=2, step=0.1))
        form.add_text("certificate", tr("Certificate"), tip=tr("Its number"))
        form.add_text("due", tr("Valid until"), placeholder="2028-03-01", tip=tr("Its last day; may be left empty"))
        registers = [("own", tr("Mine, of all projects")), ("project", tr("The project's"))]
        form.add_choice("register", tr("Register"), registers)
        form.set_values({"kind": "block", "value_mm": None, "U_mm": None, "k": 2.0, "register": "own"})
        return form

    def _chosen(self, _: int) -> None:
        self._show_chosen()

    def _show_chosen(self) -> None:
        one, nothing = self.chosen, tr("Choose an artefact.")
        if one is not None and one != self._filled:
            self.form.set_values(values_of(one, own=not self._of_project(one)))
            self._complain({})
        self._filled = one
        self._show_lengths(one)
        why_not = self._artefacts.cannot_compare or (
            self._artefacts.why_not(one, str(self.length.currentData() or "")) if one else nothing
        )
        enable(self.compare, why_not, tr("Error and E_n of what was measured against the certificate"))
        enable(self.change, "" if one else nothing, tr("Put what stands in the fields in place of the chosen artefact"))
        enable(self.remove, "" if one else nothing, tr("Take the chosen artefact out of its register"))
        enable(self.add, "", tr("Add what stands in the fields as another artefact"))
        if not self._ids:
            said = tr("No artefact is known yet: add one.")
        elif one is not None and has_lapsed(one):
            said = tr(
                "The certificate of {id} held until {due}: measured after that day it is doubtful at best; have it "
                "calibrated.",
                id=one.id,
                due=one.due,
            )
        else:
            said = ""
        set_text(self.said, said)

    def _show_lengths(self, one: Artefact | None) -> None:
        """What the chosen artefact may be compared with, where that is to be chosen."""
        names = self._artefacts.lengths.get(one.kind, ()) if one is not None else ()
        if names != tuple(self.length.itemData(place) for place in range(self.length.count())):
            self.length.clear()
            for name in names:
                self.length.addItem(name or tr("the thickness"), name)
        for widget in (self.length_title, self.length):
            widget.setVisible(len(names) > 1)

    def _of_project(self, one: Artefact) -> bool:
        return one.id in self._artefacts.of_project

    def _add(self) -> None:
        self.add.setFocus()  # what is half typed is meant
        values = self.form.values()
        own = values["register"] == "own"
        if self._complain(complaints(values, self._artefacts.own if own else self._artefacts.of_project)):
            return
        made = artefact_of(values)
        self._wanted = made.id
        self._artefacts.add(made, own=own)
        self.refresh()

    def _change(self) -> None:
        self.change.setFocus()  # what is half typed is meant
        one, values = self.chosen, self.form.values()
        if one is None:
            return
        own = not self._of_project(one)
        wrong = complaints(values, {*(self._artefacts.own if own else self._artefacts.of_project)} - {one.id})
        if values["register"] != ("own" if own else "project"):
            wrong["register"] = tr("It stays where it is: add it to the other one, and remove it here.")
        if self._complain(wrong):
            return
        made = artefact_of(values)
        self._wanted = made.id
        self._artefacts.change(one, made, own=own)
        self.refresh()

    def _remove(self) -> None:
        one = self.chosen
        if one is None:
            return
        own = not self._of_project(one)
        text = tr("{id} goes out of your register for all projects; this cannot be undone.", id=one.id)
        answers = [tr("Remove"), tr("Keep")]
        if own and ask.ask(self, tr("Remove the artefact"), text, answers) != 0:
            return
        self._artefacts.change(one, None, own=own)
        self.refresh()

    def _complain(self, wrong: Mapping[str, str]) -> bool:
        """Say what is wrong with the fields, by their keys; whether anything is."""
        for key in ("id", "value_mm", "U_mm", "due", "register"):
            self.form.set_complaint(key, wrong.get(key, ""))
        return bool(wrong)

    def _compare(self) -> None:
        if (one := self.chosen) is not None:
            self._artefacts.compare(one, str(self.length.currentData() or ""))
            self.accept()


def has_lapsed(artefact: Artefact) -> bool:
    """Whether the certificate of an artefact has expired by today."""
    return artefact.due is not None and artefact.due < date.today()


def row(artefact: Artefact, of_project: bool) -> tuple[str, ...]:
    """Make the texts of an artefact's row in the table; `of_project`: it is from the project's register."""
    value, width = with_uncertainty(artefact.value_mm, artefact.U_mm, wording())
    due = tr("not stated") if artefact.due is None else artefact.due.isoformat()
    return (
        artefact.id,
        tr(KINDS[artefact.kind]),
        value,
        f"{width} (k = {number(artefact.k, 'g')})",
        artefact.certificate,
        tr("{due}, lapsed", due=due) if has_lapsed(artefact) else due,
        tr("project") if of_project else tr("mine"),
    )


def complaints(values: Mapping[str, object], taken: Collection[str]) -> dict[str, str]:
    """Return a sentence for each field of an artefact that is wrong, by its key; `taken` are ids that are in use."""
    name, due = str(values["id"]).strip(), str(values["due"]).strip()
    wrong = {}
    if not name:
        wrong["id"] = tr("Give it the name that is engraved on it.")
    elif len(name) > LONGEST_ID:
        wrong["id"] = tr("At most {n} letters.", n=LONGEST_ID)
    elif name in taken:
        wrong["id"] = tr("The register has one of this name already.")
    if values["value_mm"] is None:
        wrong["value_mm"] = tr("The certificate states it.")
    if values["U_mm"] is None:
        wrong["U_mm"] = tr("The certificate states it.")
    try:
        _day(due)
    except ValueError:
        wrong["due"] = tr("Write the day as 2028-03-01.")
    return wrong


def artefact_of(values: Mapping[str, object]) -> Artefact:
    """Convert fields of the dialog, all of them valid, to an artefact."""
    value, width, k = (float(str(values[key])) for key in ("value_mm", "U_mm", "k"))
    name, certificate, due = (str(values[key]).strip() for key in ("id", "certificate", "due"))
    return Artefact(name, value, width, k, certificate, _day(due), cast(ArtefactKind, values["kind"]))


def values_of(artefact: Artefact, *, own: bool) -> dict[str, object]:
    """Convert an artefact to the fields of the dialog; `own`: it is in the user's register, not the project's."""
    due = "" if artefact.due is None else artefact.due.isoformat()
    return {**asdict(artefact), "due": due, "register": "own" if own else "project"}


def _day(text: str) -> date | None:
    return date.fromisoformat(text) if text else None
