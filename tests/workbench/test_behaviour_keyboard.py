"""The whole job without the mouse."""

from __future__ import annotations

from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication, QListView, QTabBar, QWidget

from tests.workbench.technician import Technician
from workbench.menus import SHORTCUTS
from workbench.step_state import ORDER
from workbench.steps import STEPS

ALT, CONTROL = Qt.KeyboardModifier.AltModifier, Qt.KeyboardModifier.ControlModifier
SHIFT = Qt.KeyboardModifier.ShiftModifier
MOST_TABS = 150


def press(t: Technician, key: Qt.Key, modifier: Qt.KeyboardModifier = Qt.KeyboardModifier.NoModifier) -> None:
    """A key for whatever has the focus."""
    t.shortcut(key, modifier)


def focused() -> QWidget:
    widget = QApplication.focusWidget()
    assert widget is not None, "nothing has the focus"
    return widget


def named(widget: QWidget) -> str:
    """What the technician sees the focus is on."""
    text = getattr(widget, "text", None)
    return str(text() if callable(text) else "").replace("&", "") or widget.accessibleName()


def tab_to(t: Technician, name: str) -> None:
    """Go to a widget by Tab alone."""
    passed = []
    for _ in range(MOST_TABS):
        widget: QWidget | None = focused()
        while widget is not None and widget is not t.window:
            if name in (named(widget), widget.accessibleName()):
                return
            widget = widget.parentWidget() if isinstance(widget, QWidget) and widget.focusProxy() else None
        passed.append(named(focused()))
        press(t, Qt.Key.Key_Tab)
    raise AssertionError(f"{name!r} is not reached by Tab from page {t.window.current}; passed {passed}")


@pytest.mark.parametrize(("key", "more"), [(Qt.Key.Key_Y, CONTROL), (Qt.Key.Key_Z, CONTROL | SHIFT)])
def test_what_was_undone_is_redone_by_either_key(
    technician: Technician, measured_project: Path, key: Qt.Key, more: Qt.KeyboardModifier
) -> None:
    t = technician
    t.window.projects.open_project(measured_project)
    t.window.go_to("project")
    t.activate()
    before = t.model.project.info.part
    t.type_in(t.field("Part"), "Another block")
    t.window.rail.setFocus()  # a line of text has an undo of its own
    assert t.model.project.info.part == "Another block"
    press(t, Qt.Key.Key_Z, CONTROL)
    assert t.model.project.info.part == before
    press(t, key, more)
    assert t.model.project.info.part == "Another block"


@pytest.mark.accuracy
def test_from_new_project_to_report_without_the_mouse(technician: Technician, simulated: Path, tmp_path: Path) -> None:
    t = technician
    t.activate()
    with t.names_project("By keys"):
        press(t, Qt.Key.Key_N, CONTROL)
    t.until(lambda: t.window.current == "project", "the new project")
    tab_to(t, "Part")
    t.write("Gauge block")
    press(t, Qt.Key.Key_Tab)
    assert t.model.project.info.part == "Gauge block"
    press(t, Qt.Key.Key_Right, ALT)

    for page in ("camera", "planes"):
        assert t.window.current == page
        t.will_choose(simulated / page)
        tab_to(t, "Recorded folder")
        press(t, Qt.Key.Key_Space)
        tab_to(t, "Choose folder …")
        press(t, Qt.Key.Key_Space)
        t.until(lambda: t.presenter().stage == "solved", "the calibration", 60)
        press(t, Qt.Key.Key_Return, CONTROL)
        t.until(lambda: t.presenter().stage == "accepted", "it to be accepted")
        press(t, Qt.Key.Key_Right, ALT)

    assert t.window.current == "scan"
    t.will_choose(simulated / "scan")
    tab_to(t, "Recorded folder")
    press(t, Qt.Key.Key_Space)
    tab_to(t, "Choose folder …")
    press(t, Qt.Key.Key_Space)
    t.until(lambda: t.presenter().stage == "recorded", "the frames to be listed")
    press(t, Qt.Key.Key_R, CONTROL)
    t.until(lambda: t.presenter().stage == "measured", "the scan to be measured", 90)
    press(t, Qt.Key.Key_Right, ALT)
    assert t.window.current == "inspect"
    t.idle()
    press(t, Qt.Key.Key_Right, ALT)
    assert t.window.current == "report"
    t.idle(60)
    press(t, Qt.Key.Key_R, CONTROL)
    t.until(lambda: "report" in t.model.results, "the report", 60)
    t.will_choose(tmp_path / "report.pdf")
    tab_to(t, "Report (PDF)")
    press(t, Qt.Key.Key_Space)
    t.until(lambda: (tmp_path / "report.pdf").exists(), "the PDF")
    t.idle()
    assert t.errors() == []


def test_every_button_of_a_page_is_reached_by_tab_and_has_a_name(
    technician: Technician, measured_project: Path
) -> None:
    technician.window.projects.open_project(measured_project)
    technician.activate()
    for page in ORDER:
        technician.window.go_to(page)
        technician.idle()
        tab_through(technician)


def tab_through(t: Technician) -> None:
    """From the top of a page round to there again: each button on the way, and each has a name."""
    press(t, Qt.Key.Key_Tab)  # from the page itself, which is no stop, to its first
    first, reached = focused(), []
    for _ in range(MOST_TABS):
        reached.append(focused())
        press(t, Qt.Key.Key_Tab)
        if focused() is first:
            break
    assert focused() is first, "Tab does not come round"
    unnamed = [
        widget
        for widget in reached
        if not named(widget) and not widget.toolTip() and not isinstance(widget, QTabBar)  # its tabs have names
    ]
    assert not unnamed, [(type(widget).__name__, type(widget.parentWidget()).__name__) for widget in unnamed]
    missed = [
        button
        for button in t.page().findChildren(QWidget)
        if hasattr(button, "clicked")
        and button.isVisible()
        and button.isEnabled()
        and button.focusPolicy() & Qt.FocusPolicy.TabFocus
        and button not in reached
        and not (getattr(button, "group", lambda: None)() or getattr(button, "autoExclusive", lambda: False)())
    ]
    assert not missed, [named(button) or button.toolTip() for button in missed]


def test_fields_of_the_target_come_where_they_are_seen(technician: Technician, measured_project: Path) -> None:
    t = technician
    t.window.projects.open_project(measured_project)
    t.window.go_to("camera")
    t.idle()
    t.activate()
    t.unfold("Target")
    for _ in range(2):
        t.field("Kind").setFocus()
        order = []
        for _ in range(4):
            press(t, Qt.Key.Key_Tab)
            order.append(focused().accessibleName())
        assert order[-1] != "Kind"
        assert order[:3] == ["Columns", "Rows", "Square"]
        t.choose("Kind", "ChArUco" if "Check" in t.field("Kind").currentText() else "Checkerboard")
        t.idle()
        if "ChArUco" in t.field("Kind").currentText():
            t.choose("Kind", "Checkerboard")
            t.idle()


def test_the_list_under_the_question_mark_tells_every_key(technician: Technician) -> None:
    t = technician
    t.activate()
    told: list[str] = []

    def read(dialog: QWidget) -> None:
        told.extend(label.text() for label in dialog.findChildren(QWidget) if hasattr(label, "text"))
        views = dialog.findChildren(QListView)
        told.extend(str(view.model().index(row, 0).data()) for view in views for row in range(view.model().rowCount()))

    with t.meets(read):
        t.window.menus.actions["keys"].trigger()
    for _, key, meaning in SHORTCUTS:
        assert any(key in text for text in told), key
        assert any(meaning in text for text in told), meaning


def test_every_key_of_the_window_is_in_the_list(technician: Technician) -> None:
    keys = {key for _, keys, _ in SHORTCUTS for key in keys.replace(" … ", ",").replace(" ", "").split(",")}
    numbered = {f"Ctrl+{number}" for number in range(1, len(ORDER) + 1)}
    for name, action in technician.window.menus.actions.items():
        for shortcut in action.shortcuts():
            assert shortcut.toString() in keys | numbered, name


def test_f1_opens_the_manual_at_the_page_of_the_step(technician: Technician) -> None:
    t = technician
    t.activate()
    press(t, Qt.Key.Key_F1)
    pages = t.window.manual.pages
    assert t.window.manual.isVisible()
    assert pages.source().fileName() == f"{next((s.manual for s in STEPS if s.name == t.window.current), 'index')}.md"
    t.window.manual.close()
