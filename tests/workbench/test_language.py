"""Another language is spoken at once: the window is replaced, and what is open stays open."""

from __future__ import annotations

import gc
import re
from collections.abc import Iterator
from dataclasses import replace

import pytest
import shiboken6
from PySide6.QtCore import QCoreApplication, QEvent
from PySide6.QtGui import QFontDatabase, QFontInfo
from PySide6.QtWidgets import QApplication, QPushButton

import workbench.language
from core.translations import PSEUDO, language
from tests.workbench.pseudo import FOREIGN, told_past_the_catalogues
from tests.workbench.test_pseudo_dialogs import ALIKE
from workbench.app import build_window, speak
from workbench.bench import Bench
from workbench.language import choose, joined, language_name, named, sentence, sentences
from workbench.main_window import MainWindow
from workbench.steps import STEPS
from workbench.work import jobs


@pytest.fixture
def windows(bench: Bench, qapp: QApplication, qtbot) -> Iterator[list[MainWindow]]:
    """All windows there were, the newest last, the first one shown in English."""
    made: list[MainWindow] = []
    sheet = qapp.styleSheet()

    def put() -> MainWindow:
        new = build_window(qapp, bench, "light")
        new.language_wanted.connect(lambda name: speak(qapp, new, name, put))
        new.show()
        made.append(new)
        return new

    put()
    yield made
    made[-1].dismiss()
    made.clear()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    gc.collect(1)
    choose(language("en"), qapp)
    qapp.setStyleSheet(sheet)


def speaks(windows: list[MainWindow], name: str, count: int) -> bool:
    return language_name() == name and len(windows) == count


def test_the_window_speaks_another_language_at_once_and_shows_the_same_step(windows, bench, qtbot, measured_project):
    bench.model.open(measured_project)
    named = replace(bench.model.project, info=replace(bench.model.project.info, name="Teil 7"))
    bench.model.edit("name", named)
    first = windows[0]
    first.go_to("report")
    first.menus.actions["language de"].trigger()
    qtbot.waitUntil(lambda: speaks(windows, "de", 2))
    second = windows[1]
    assert (second.current, second.back.text()) == ("report", workbench.language.tr("Back"))
    assert second.back.text() != "Back" and second.isVisible()
    assert bench.model.folder == measured_project and second.rail.state_of("camera") == "done"
    assert "Teil 7" in second.windowTitle()
    bench.model.undo_stack.undo()
    qtbot.waitUntil(lambda: "Teil 7" not in second.windowTitle())
    qtbot.waitUntil(lambda: not shiboken6.isValid(first))
    second.menus.actions["language en"].trigger()
    qtbot.waitUntil(lambda: speaks(windows, "en", 3))
    assert {one.text() for one in windows[2].findChildren(QPushButton)} >= {"Back", "Next", "Messages"}


@pytest.mark.accuracy
def test_nothing_of_the_language_before_is_left_on_any_page(windows, bench, qtbot, measured_project):
    bench.model.open(measured_project)

    def shown(window: MainWindow) -> Iterator[str]:
        for step in STEPS:
            window.go_to(step.name)
            qtbot.waitUntil(lambda: not bench.quick.busy, timeout=60_000)
            qtbot.wait(20)
            yield step.name

    assert len(list(shown(windows[0]))) == len(STEPS)
    windows[0].language_wanted.emit(PSEUDO)
    qtbot.waitUntil(lambda: speaks(windows, PSEUDO, 2))
    alike = ("Block", "Gauge block", "Somebody", measured_project.name, *FOREIGN, *ALIKE)
    foreign = re.compile("|".join(rf"\b{one}\b" for one in alike))
    left = {page: told_past_the_catalogues(windows[1], foreign) for page in shown(windows[1])}
    assert {page: texts for page, texts in left.items() if texts} == {}


def test_while_something_is_measured_the_language_changes_at_the_next_start(windows, bench, qtbot):
    bench.run_long(windows[0], jobs.REFUSE, "x", label="Test", on_done=print, offers={})
    windows[0].menus.actions["language zh_CN"].trigger()
    assert windows[0].notice_list.count() >= 1
    assert speaks(windows, "en", 1) and bench.settings.language == "zh_CN"


def test_chinese_is_drawn_with_chinese_characters_and_latin_as_before(qapp, monkeypatch):
    latin = QFontInfo(qapp.font()).family()
    monkeypatch.setattr(QFontDatabase, "families", lambda: ["Noto Sans CJK JP", "Microsoft YaHei"])
    try:
        choose(language("zh_CN"), qapp)
        assert qapp.font().families() == [latin, "Microsoft YaHei"]
    finally:
        choose(language("en"), qapp)
    assert qapp.font().families() == [latin]


def test_words_are_put_together_with_the_signs_of_the_language(qapp):
    try:
        choose(language("zh_CN"), qapp)
        assert named("量具 R&R", sentence(joined(("甲", "乙")))) == "量具 R&R：甲、乙。"
        assert sentences("合格。", "", "完成于 11月27日。") == "合格。完成于 11月27日。"
        choose(language("de"), qapp)
        assert named("Streuung", sentence(joined(("a", "b"), ";"))) == "Streuung: A; b."
        assert sentences("Konform.", "Fertig.") == "Konform. Fertig."
    finally:
        choose(language("en"), qapp)
