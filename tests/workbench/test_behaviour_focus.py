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


def test_the_focus_goes_to_no_other_button_where_one_is_greyed_or_hidden_or_its_page_is_left(
    technician: Technician, measured_project: Path
) -> None:
    t = technician
    opened(t, measured_project)
    for page, other in pairwise([*ORDER, ORDER[0]]):
        t.window.go_to(page)
        t.idle()
        assert grey_and_hide(t) == []
        assert come_and_go(t, page, other) == []


def grey_and_hide(t: Technician) -> list[tuple[object, ...]]:
    """Whatever hands its focus to another button when it is greyed or hidden."""
    wrong: list[tuple[object, ...]] = []
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
                wrong.append((t.window.current, named(button), change.__name__, now and named(now)))
            back(True)
    return wrong


def come_and_go(t: Technician, page: str, other: str) -> list[tuple[object, ...]]:
    """Whatever button of a page has the focus when somebody comes to the page."""
    wrong: list[tuple[object, ...]] = []
    for button in pressable(t.page()):
        button.setFocus()
        for to in (other, page):
            t.window.go_to(to)
            now = QApplication.focusWidget()
            if now is None or (isinstance(now, QAbstractButton) and t.page().isAncestorOf(now)):
                wrong.append((named(button), to, now and named(now)))
    return wrong


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
