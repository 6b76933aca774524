"""The focus stays where the person is: Space presses nothing that nobody chose."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QAbstractButton, QApplication, QDialog, QWidget

from tests.workbench.technician import Technician
from workbench.step_state import ORDER


def pressable(inside: QWidget) -> list[QAbstractButton]:
    """The buttons that could have the focus now."""
    return [
        one
        for one in inside.findChildren(QAbstractButton)
        if one.isVisible() and one.isEnabled() and one.focusPolicy() & Qt.FocusPolicy.TabFocus
    ]


def named(button: QWidget) -> str:
    return getattr(button, "text", str)() or button.accessibleName() or button.toolTip() or repr(button)


def opened(t: Technician, project: Path) -> None:
    """The window in front, a finished project open."""
    t.window.projects.open_project(project)
    t.activate()
    t.idle()


def test_whatever_is_greyed_or_hidden_hands_its_focus_to_no_other_button(
    technician: Technician, measured_project: Path
) -> None:
    t, wrong = technician, []
    opened(t, measured_project)
    for page in ORDER:
        t.window.go_to(page)
        t.idle()
        buttons = pressable(t.window)
        assert len(buttons) > 3
        for button in buttons:
            for change, back in ((button.setDisabled, button.setEnabled), (button.setHidden, button.setVisible)):
                button.setFocus()
                if not button.hasFocus():  # one of a group: another is chosen
                    continue
                change(True)
                now = QApplication.focusWidget()
                if now is None or isinstance(now, QAbstractButton) or not now.isAncestorOf(button):
                    wrong.append((page, named(button), change.__name__, now and named(now)))
                back(True)
    assert not wrong


def test_whoever_comes_to_a_page_is_on_none_of_its_buttons(technician: Technician, measured_project: Path) -> None:
    t, wrong = technician, []
    opened(t, measured_project)
    for page, other in pairwise([*ORDER, ORDER[0]]):
        t.window.go_to(page)
        t.idle()
        for button in pressable(t.page()):
            button.setFocus()
            for to in (other, page):
                t.window.go_to(to)
                now = QApplication.focusWidget()
                if now is None or (isinstance(now, QAbstractButton) and t.page().isAncestorOf(now)):
                    wrong.append((named(button), to, now and named(now)))
    assert not wrong


def test_a_button_hidden_behind_a_question_does_not_hand_on_its_focus_afterwards(
    technician: Technician, measured_project: Path
) -> None:
    t = technician
    opened(t, measured_project)
    button = pressable(t.page())[0]
    button.setFocus()
    question = QDialog(t.window)
    question.setModal(True)
    question.show()
    question.activateWindow()
    t.until(lambda: not button.hasFocus(), "the question to be in front")
    button.hide()
    question.close()
    t.activate()
    assert not isinstance(QApplication.focusWidget(), QAbstractButton)


def test_opening_and_closing_a_project_leaves_the_focus_on_no_button(
    technician: Technician, measured_project: Path
) -> None:
    t = technician
    t.activate()
    pressable(t.window.welcome)[0].setFocus()
    t.window.projects.open_project(measured_project)
    assert not isinstance(QApplication.focusWidget(), QAbstractButton)
    pressable(t.page())[0].setFocus()
    t.window.projects.close_project()
    assert not isinstance(QApplication.focusWidget(), QAbstractButton)
