"""Questions that need an answer before anything goes on; the one place where windows are modal."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QFileDialog,
    QFormLayout,
    QInputDialog,
    QLabel,
    QLineEdit,
    QMessageBox,
    QPushButton,
    QWidget,
)

from workbench.language import tr
from workbench.views.common import Choice
from workbench.views.layouts import in_row


def ask(parent: QWidget | None, title: str, text: str, answers: Sequence[str], *, harmless: bool = False) -> int:
    """Ask a question by a button for each of `answers`; return the chosen one's index. Escape and Return mean the last.

    Where the first one is `harmless`, Return means that: nothing is lost by it, and nothing is measured otherwise.
    """
    box = QMessageBox(QMessageBox.Icon.Question, title, text, QMessageBox.StandardButton.NoButton, parent)
    last = len(answers) - 1
    buttons = [
        box.addButton(answer, QMessageBox.ButtonRole.AcceptRole if place < last else QMessageBox.ButtonRole.RejectRole)
        for place, answer in enumerate(answers)
    ]
    box.setDefaultButton(buttons[0 if harmless else -1])
    box.setEscapeButton(buttons[-1])
    box.exec()
    clicked = box.clickedButton()
    return buttons.index(clicked) if clicked in buttons else last


def choose_folder(parent: QWidget | None, title: str, start: Path) -> Path | None:
    """Ask for a folder, beginning at `start`; None if the user cancels."""
    chosen = QFileDialog.getExistingDirectory(parent, title, str(start))
    return Path(chosen) if chosen else None


def choose_file_to_save(parent: QWidget | None, title: str, start: Path, kinds: str) -> Path | None:
    """Ask for a file to write; None if the user cancels. `kinds` is a filter, as "PDF (*.pdf)"."""
    chosen, _ = QFileDialog.getSaveFileName(parent, title, str(start), kinds)
    return Path(chosen) if chosen else None


def choose_file_to_open(parent: QWidget | None, title: str, start: Path | None, kinds: str) -> Path | None:
    """Ask for a file to read; None if the user cancels. `kinds` is a filter, as "STL (*.stl)"."""
    chosen, _ = QFileDialog.getOpenFileName(parent, title, str(start or Path.home()), kinds)
    return Path(chosen) if chosen else None


def ask_name_and_folder(parent: QWidget | None, title: str, name: str, folder: Path) -> tuple[str, Path] | None:
    """Ask for a project's name and the folder to put it in; None if the user cancels."""
    dialog = _NameAndFolder(parent, title, name, folder)
    return dialog.answer() if dialog.exec() == QDialog.DialogCode.Accepted else None


def ask_new_project(
    parent: QWidget | None, title: str, name: str, folder: Path, ways: tuple[str, Sequence[str]]
) -> tuple[str, Path, int] | None:
    """Ask for a project's name, its folder and one of `ways` (what they are, and each); None if the user cancels."""
    dialog = _NameAndFolder(parent, title, name, folder, ways)
    return (*dialog.answer(), dialog.way()) if dialog.exec() == QDialog.DialogCode.Accepted else None


def ask_line(parent: QWidget | None, title: str, text: str) -> str:
    """Ask for one line of text; "" if the user cancels."""
    line, given = QInputDialog.getText(parent, title, text)
    return line.strip() if given else ""


def ask_next_part(parent: QWidget | None, part: str, operator: str, folder: Path) -> tuple[str, str, Path] | None:
    """Ask for the next part's serial number, operator and project folder; None if the user cancels."""
    dialog = _NextPart(parent, part, operator, folder)
    return dialog.answer() if dialog.exec() == QDialog.DialogCode.Accepted else None


class _NextPart(QDialog):
    """The serial number comes first: a scanner types it and presses Return."""

    def __init__(self, parent: QWidget | None, part: str, operator: str, folder: Path) -> None:
        super().__init__(parent)
        self.setWindowTitle(tr("Next part"))
        self.setMinimumWidth(480)
        self._part, self._folder = part, folder
        self.serial, self.operator, self._will = QLineEdit(), QLineEdit(operator), QLabel()
        self._will.setObjectName("muted")
        self._will.setWordWrap(True)
        self.buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        form = QFormLayout(self)
        form.addRow(tr("Serial number"), self.serial)
        form.addRow(tr("Operator"), self.operator)
        form.addRow(self._will)
        form.addRow(self.buttons)
        for field in (self.serial, self.operator):
            field.textChanged.connect(self._check)
        self.serial.returnPressed.connect(self._go_on)
        self._check()

    def _go_on(self) -> None:
        """Return after the number, as a scanner sends it: to the operator, if that is still empty."""
        if not self.operator.text().strip():
            self.operator.setFocus()

    def answer(self) -> tuple[str, str, Path]:
        """Serial number, operator and the project's folder."""
        serial = self.serial.text().strip()
        return serial, self.operator.text().strip(), self._folder / file_name(f"{self._part} {serial}".strip())

    def _check(self) -> None:
        serial, operator, target = self.answer()
        if not serial:
            problem = tr("Scan or type the serial number.")
        elif not operator:
            problem = tr("Say who measures.")
        elif target.exists():
            problem = tr("{folder} exists already: was this part measured before?", folder=target)
        else:
            problem = ""
        self.buttons.button(QDialogButtonBox.StandardButton.Ok).setEnabled(not problem)
        self._will.setText(problem or tr("The project will be the folder {folder}.", folder=target))


class _NameAndFolder(QDialog):
    def __init__(
        self, parent: QWidget | None, title: str, name: str, folder: Path, ways: tuple[str, Sequence[str]] = ("", ())
    ) -> None:
        super().__init__(parent)
        self.setWindowTitle(title)
        self.setMinimumWidth(480)
        self._name, self._folder = QLineEdit(name), QLineEdit(str(folder))
        self._name.selectAll()
        browse = QPushButton(tr("Browse …"))
        browse.clicked.connect(self._browse)
        place = in_row((self._folder, 1), browse)
        self._will = QLabel()
        self._will.setObjectName("muted")
        self._will.setWordWrap(True)
        self._buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        self._buttons.accepted.connect(self.accept)
        self._buttons.rejected.connect(self.reject)
        form = QFormLayout(self)
        form.addRow(tr("Name"), self._name)
        form.addRow(tr("In folder"), place)
        self._way = Choice()
        asked, answers = ways
        self._way.addItems(list(answers))
        self._way.setVisible(bool(answers))
        if answers:
            form.addRow(asked, self._way)
        form.addRow(self._will)
        form.addRow(self._buttons)
        self._name.textChanged.connect(self._check)
        self._folder.textChanged.connect(self._check)
        self._check()

    def answer(self) -> tuple[str, Path]:
        """Name and folder."""
        return self._name.text().strip(), Path(self._folder.text().strip())

    def way(self) -> int:
        """Number of the way that is chosen, from 0."""
        return max(self._way.currentIndex(), 0)

    def _browse(self) -> None:
        folder = choose_folder(self, tr("Folder for the project"), Path(self._folder.text()))
        if folder is not None:
            self._folder.setText(str(folder))

    def _check(self) -> None:
        name, folder = self.answer()
        target = folder / file_name(name)
        ok = self._buttons.button(QDialogButtonBox.StandardButton.Ok)
        if not name:
            problem = tr("Give the project a name.")
        elif target.exists():
            problem = tr("{folder} exists already; choose another name.", folder=target)
        else:
            problem = ""
        ok.setEnabled(not problem)
        self._will.setText(problem or tr("The project will be the folder {folder}.", folder=target))


def file_name(name: str) -> str:
    """Convert a project's name to a folder name that is valid on every system."""
    kept = "".join("-" if c in '<>:"/\\|?*' or ord(c) < 32 else c for c in name).strip(" .")
    return kept or tr("project")
