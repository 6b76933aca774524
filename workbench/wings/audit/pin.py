"""Question for name and PIN: to sign in, or to sign."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtWidgets import QDialog, QDialogButtonBox, QFormLayout, QLineEdit, QWidget

from workbench.language import tr
from workbench.views.common import Choice


def ask_name_and_pin(parent: QWidget | None, title: str, names: Sequence[str]) -> tuple[str, str] | None:
    """Ask for one of `names` and the PIN of that person; None if the user cancels."""
    dialog = _NameAndPin(parent, title, names)
    return dialog.answer() if dialog.exec() == QDialog.DialogCode.Accepted else None


class _NameAndPin(QDialog):
    def __init__(self, parent: QWidget | None, title: str, names: Sequence[str]) -> None:
        super().__init__(parent)
        self.setWindowTitle(title)
        self._name, self._pin = Choice(), QLineEdit()
        self._name.addItems(list(names))
        self._pin.setEchoMode(QLineEdit.EchoMode.Password)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        form = QFormLayout(self)
        form.addRow(tr("Name"), self._name)
        form.addRow(tr("PIN"), self._pin)
        form.addRow(buttons)

    def answer(self) -> tuple[str, str]:
        """Name and PIN."""
        return self._name.currentText(), self._pin.text()
