"""The layout is remembered for each screen, and never puts the window outside of what there is."""

from __future__ import annotations

from pathlib import Path

import pytest
from PySide6.QtCore import QRect
from PySide6.QtWidgets import QApplication, QWidget
from pytestqt.qtbot import QtBot

from core.files.project.data import new_project
from workbench import window_layout
from workbench.main_window import MainWindow
from workbench.window_layout import (
    FRAMED_MS,
    LAST_SCREEN,
    TITLE_BAR,
    inside,
    keep_layout,
    name_of,
    put_on_screen,
    restore_layout,
)

ROOM = QRect(1920, 30, 960, 510)


@pytest.mark.parametrize(
    ("place", "expected"),
    [
        (QRect(2000, 40, 700, 400), QRect(2000, 40, 700, 400)),  # it is inside already
        (QRect(-3000, 4000, 700, 400), QRect(1920, 140, 700, 400)),  # of a screen that is gone
        (QRect(1920, 0, 2560, 1400), QRect(1920, 30, 960, 510)),  # of a larger screen
        (QRect(2500, 300, 700, 400), QRect(2180, 140, 700, 400)),  # half outside
    ],
)
def test_a_window_is_put_inside_its_screen(place: QRect, expected: QRect) -> None:
    assert inside(place, ROOM) == expected


def test_the_title_bar_is_on_the_screen_before_and_after_the_window_has_its_frame(qtbot: QtBot) -> None:
    window = QWidget()
    qtbot.addWidget(window)
    window.setMinimumSize(200, 100)
    room = QRect(0, 0, 640, 400)
    window.setGeometry(room)
    put_on_screen(window, room)
    assert window.geometry() == QRect(0, TITLE_BAR, 640, 400 - TITLE_BAR)
    window.show()
    qtbot.waitUntil(lambda: window.frameGeometry() != window.geometry())
    for place in (room, QRect(0, -30, 640, 300), QRect(500, 390, 640, 300)):
        window.setGeometry(place)
        put_on_screen(window, room)
        assert room.contains(window.frameGeometry())


def change(window: MainWindow) -> None:
    """Divide a page otherwise, and open and fold panels."""
    scan, inspect = window.pages["scan"], window.pages["inspect"]
    scan.splitter.setSizes([scan.splitter.sizes()[0] - 40, scan.splitter.sizes()[1] + 40])
    scan.kept_panels["settings"].expand(animate=False)
    inspect.kept_panels["points"].collapse(animate=False)


def seen(window: MainWindow) -> tuple[list[int], bool, bool]:
    scan, inspect = window.pages["scan"], window.pages["inspect"]
    opened = (scan.kept_panels["settings"].isExpanded(), inspect.kept_panels["points"].isExpanded())
    return (scan.splitter.sizes(), *opened)


def test_a_layout_is_as_it_was_on_the_same_screen_and_its_own_on_another(
    window: MainWindow, qapp: QApplication, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    window.model.create(tmp_path / "empty", new_project("Empty"))
    window.go_to("scan")
    qapp.processEvents()
    settings = window.bench.settings
    for _ in range(2):  # as large as there is room for on this screen
        keep_layout(window, window.pages, settings)
        restore_layout(window, window.pages, settings)
        qapp.processEvents()
    first = seen(window)
    keep_layout(window, window.pages, settings)
    here = name_of(window.screen())
    assert settings.text(LAST_SCREEN, "") == here
    monkeypatch.setattr(window_layout, "name_of", lambda _: "960x540 at 2")  # the window is on a small screen now
    change(window)
    second = seen(window)
    assert second != first and second[1:] == (True, False)
    keep_layout(window, window.pages, settings)
    monkeypatch.undo()
    settings.keep_text(LAST_SCREEN, here)
    restore_layout(window, window.pages, settings)
    assert seen(window) == first
    monkeypatch.setattr(window_layout, "name_of", lambda _: "960x540 at 2")
    settings.keep_text(LAST_SCREEN, "a screen that is gone")
    restore_layout(window, window.pages, settings)
    assert seen(window) == second


def test_a_layout_of_a_screen_that_is_gone_puts_the_window_on_one_that_is_there(window: MainWindow) -> None:
    settings = window.bench.settings
    window.move(9000, 7000)
    keep_layout(window, window.pages, settings)
    restore_layout(window, window.pages, settings)
    room = window.screen().availableGeometry()
    assert room.contains(window.geometry().topLeft())


def test_moved_to_another_screen_the_pages_are_as_they_were_there_and_the_window_stays_where_it_was_put(
    window: MainWindow, qapp: QApplication, qtbot: QtBot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    window.model.create(tmp_path / "empty", new_project("Empty"))
    window.go_to("scan")
    window.show()
    qtbot.wait(2 * FRAMED_MS)  # until it was put on the screen with its frame: where that is small, its size changes
    handle = window.windowHandle()

    def move_to(name: str) -> None:
        monkeypatch.setattr(window_layout, "name_of", lambda _: name)
        handle.screenChanged.emit(window.screen())
        qapp.processEvents()

    move_to("here")
    first, place = seen(window), window.geometry()
    move_to("there")
    assert seen(window) == first, "nothing is known yet of that screen"
    change(window)
    second = seen(window)
    assert second != first
    move_to("here")
    assert seen(window) == first
    move_to("there")
    assert seen(window) == second and window.geometry() == place
