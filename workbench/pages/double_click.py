"""Opening projects by double click, switched on and off by hand: nothing is written into the user's system unasked."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication
from PySide6.QtWidgets import QWidget

from core.errors import InputError
from workbench import association
from workbench.notices import Notices
from workbench.views import ask


def choose_double_click(window: QWidget, notices: Notices) -> None:
    """Ask whether the system is to open projects in this program, do it, and tell what was done."""
    try:
        there = association.installed()
        text = _there() if there else _not_there()
        answers = [_tr("Open by double click"), _tr("Leave it as it is")]
        if there:
            answers = [_tr("Renew"), _tr("No longer"), _tr("Leave it as it is")]
        answer = ask.ask(window, _tr("Open projects by double click"), text, answers)
        if answer == len(answers) - 1:
            return
        outcome = association.install() if answer == 0 else association.uninstall()
    except InputError as error:
        notices.error(str(error))
        return
    notices.info(outcome.sentence, "\n".join(map(str, outcome.files)))


def _there() -> str:
    return _tr("A double click on NAME.trisect in a project's folder opens it in Trisect. Renew this where the program "
               "has been moved.")  # fmt: skip


def _not_there() -> str:
    return _tr("Every project has a file NAME.trisect in its folder. Shall a double click on it open the project? "
               "The system is told so for you alone, and it can be taken back here.")  # fmt: skip


def _tr(text: str) -> str:
    return QCoreApplication.translate("DoubleClick", text)
