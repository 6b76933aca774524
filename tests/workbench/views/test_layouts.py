"""What a greyed button does with the focus it has."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication, QDialog, QPushButton, QWidget

from workbench.views.layouts import enable, in_row, rename


def two_buttons(qtbot: Any) -> tuple[QWidget, QPushButton, QPushButton]:
    """A window with two buttons, the first with the focus."""
    panel, first, second = QWidget(), QPushButton("Do it"), QPushButton("Undo it")
    in_row(first, second, on=panel)
    qtbot.addWidget(panel)
    panel.show()
    panel.activateWindow()
    first.setFocus()
    qtbot.waitUntil(first.hasFocus)
    return panel, first, second


def test_a_greyed_button_leaves_the_focus_beside_itself(qtbot: Any) -> None:
    panel, first, second = two_buttons(qtbot)
    pressed: list[str] = []
    first.clicked.connect(lambda: enable(first, "done", ""))
    second.clicked.connect(lambda: pressed.append("undone"))
    for _ in range(2):
        qtbot.keyClick(panel.focusWidget() or panel, Qt.Key.Key_Space)
    assert not pressed
    assert panel.hasFocus()
    enable(first, "", "again")
    qtbot.keyClick(panel, Qt.Key.Key_Tab)
    assert first.hasFocus(), "Tab goes on from where the person was"


def test_a_button_greyed_behind_a_question_does_not_hand_on_the_focus_it_will_have_again(qtbot: Any) -> None:
    panel, first, _ = two_buttons(qtbot)
    question = QDialog(panel)
    question.setModal(True)
    question.show()
    question.activateWindow()
    qtbot.waitUntil(lambda: not first.hasFocus())
    enable(first, "done", "")
    question.close()
    panel.activateWindow()
    qtbot.waitUntil(lambda: QApplication.focusWidget() is not None)
    assert panel.hasFocus()


def test_a_button_that_means_another_thing_now_is_not_pressed_by_the_next_space(qtbot: Any) -> None:
    panel, button, _ = two_buttons(qtbot)
    pressed: list[str] = []
    button.clicked.connect(lambda: pressed.append(button.text()))
    button.clicked.connect(lambda: rename(button, "Stop"))
    for _ in range(2):
        qtbot.keyClick(panel.focusWidget() or panel, Qt.Key.Key_Space)
    assert pressed == ["Do it"]
    button.setFocus()
    rename(button, "Stop")
    assert button.hasFocus(), "it means the same"
