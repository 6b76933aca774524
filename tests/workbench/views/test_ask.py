"""What Return and Escape mean where the window asks."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication, QMessageBox

import workbench
from workbench.views import ask

RETURN_MEANS_THE_FIRST = {
    "Project in use": "open read only",
    "Recover the project": "with what was not saved; what was saved stays among the backups",
    "Read-only project": "a copy, whose place is asked for next",
    "Open projects by double click": "what the entry of the menu that asks is for; taken back there",
}
"""Questions whose first answer is harmless, and what it is."""
RETURN_MEANS_THE_LAST = {
    "Damaged project",
    "Few poses agree",
    "Interrupted recording",
    "Leave the project",
    "Live source",
    "Re-adjust camera and laser?",
    "Remove the artefact",
}
"""Questions of which any other answer loses something, or changes what is measured."""


def sources() -> Iterator[tuple[Path, ast.Module]]:
    for path in sorted(Path(workbench.__file__).parent.rglob("*.py")):
        yield path, ast.parse(path.read_text(encoding="utf-8"))


def questions() -> dict[str, set[bool]]:
    """Title of each question in the window, and whether Return means its first answer."""
    found: dict[str, set[bool]] = {}
    for _, module in sources():
        for call in ast.walk(module):
            if isinstance(call, ast.Call) and ast.unparse(call.func) == "ask.ask":
                title = ast.literal_eval(call.args[1].args[0])  # type: ignore[attr-defined]  # tr("…")
                harmless = any(
                    keyword.arg == "harmless" and ast.literal_eval(keyword.value) for keyword in call.keywords
                )
                found.setdefault(title, set()).add(harmless)
    return found


def test_return_means_the_safe_answer_of_every_question() -> None:
    expected = {title: {True} for title in RETURN_MEANS_THE_FIRST} | {title: {False} for title in RETURN_MEANS_THE_LAST}
    assert questions() == expected


def test_questions_are_put_in_one_place() -> None:
    using = {
        path.name
        for path, module in sources()
        if any(isinstance(node, ast.alias) and node.name == "QMessageBox" for node in ast.walk(module))
    }
    assert using == {"ask.py", "menus.py"}, "menus.py tells about the program, and asks nothing"


@pytest.mark.parametrize("harmless", [False, True])
@pytest.mark.parametrize("key", [Qt.Key.Key_Return, Qt.Key.Key_Space, Qt.Key.Key_Escape])
def test_a_key_pressed_as_a_question_comes_up(qtbot, monkeypatch, harmless, key):
    def meet(box: QMessageBox) -> None:
        box.show()
        box.activateWindow()
        qtbot.waitUntil(lambda: QApplication.focusWidget() is not None)
        qtbot.keyClick(QApplication.focusWidget(), key)
        qtbot.waitUntil(lambda: not box.isVisible())

    monkeypatch.setattr(QMessageBox, "exec", meet)
    chosen = ask.ask(None, "Leave", "A job is not finished yet.", ["Stop and leave", "Stay"], harmless=harmless)
    assert chosen == (0 if harmless and key != Qt.Key.Key_Escape else 1)
