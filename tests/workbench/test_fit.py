"""The window fits a small screen: nothing is cut in any language, and nothing moves when results arrive."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtCore import QPoint, QRect, QSize
from PySide6.QtWidgets import QApplication, QLabel, QMenu, QScrollArea, QToolButton, QWidget

from core.files.project.data import new_project
from core.translations import PSEUDO, language
from tests.workbench.clipped import clipped
from tests.workbench.tabs import tab_titled
from workbench.app import build_window
from workbench.bench import Bench
from workbench.first_measurement import ORDER
from workbench.language import choose, tr
from workbench.main_window import SMALLEST, MainWindow
from workbench.menus import SHORTCUTS
from workbench.pages.presenter import StepPresenter
from workbench.pages.project.import_dialog import ImportDialog
from workbench.pages.step_page import StepPage
from workbench.steps import STEPS
from workbench.theme import apply_theme, is_polishing
from workbench.views.layouts import resize_on_screen
from workbench.views.lists.shortcut_list import ShortcutList
from workbench.views.lists.step_rail import StepRail

SIZES = (SMALLEST, QSize(1000, 700))
"""What is left of full HD at twice the size (960 × 540) beside the system's bars, and a small screen."""
SCREEN = QSize(960, 540)
LANGUAGES = (PSEUDO, *(pytest.param(name, marks=pytest.mark.accuracy) for name in ("en", "de", "zh_CN")))
"""The pseudo-language has the longest words."""


@contextmanager
def window_in(name: str, bench: Bench, app: QApplication, qtbot: Any, *, styled: bool = True) -> Iterator[MainWindow]:
    """A window in a language; `styled`: as where that is changed, else it is measured before the style is on."""
    sheet = app.styleSheet()
    choose(language(name), app)
    try:
        if styled:
            apply_theme(app, "light")
        window = build_window(app, bench, "light")
        qtbot.addWidget(window)
        window.show()
        yield window
        qtbot.waitUntil(lambda: not is_polishing(app), timeout=30_000)
        window.dismiss()
    finally:
        choose(language("en"), app)
        app.setStyleSheet(sheet)


def fill_inspect_page(window: MainWindow, bench: Bench, qtbot: Any) -> None:
    """One repeat, of which some statistics cannot be told, a study, and a plane through the surface."""
    window.go_to("inspect")
    inspect: Any = window.presenters["inspect"]
    qtbot.waitUntil(lambda: inspect.scan.view is not None, timeout=60_000)
    inspect.repeats.add()
    page: Any = window.pages["inspect"]
    if (tab := tab_titled(page.tabs, "Studies")) is not None:
        tab.studies.begin("grr")
        tab.studies.write("part;operator;value\n" + "".join(f"{i % 5};{i // 5 % 2};{i * i % 7}\n" for i in range(20)))
        tab.studies.finish()
        qtbot.waitUntil(lambda: tab.studies.study is not None, timeout=60_000)
    inspect.cut.show(True)
    inspect.cut.hide(1)


def sideways(window: MainWindow) -> dict[str, str]:
    """What has to be scrolled to the right, as nobody looks for words there; a table may be."""
    areas = (area for area in window.findChildren(QScrollArea) if area.isVisible())
    bars = {area.accessibleName() or type(area).__name__: area.horizontalScrollBar() for area in areas}
    return {name: f"goes on for {bar.maximum()} px at the right" for name, bar in bars.items() if bar.maximum() > 0}


def laid_out(widget: QWidget) -> None:
    """What a widget wants is known once its layout is done."""
    layout = widget.layout()
    assert layout is not None
    layout.activate()


@pytest.mark.parametrize("styled", [False, True])
@pytest.mark.parametrize("name", LANGUAGES)
def test_every_page_has_room_in_the_smallest_window(
    bench: Bench, qapp: QApplication, qtbot: Any, name: str, styled: bool
) -> None:
    with window_in(name, bench, qapp, qtbot, styled=styled) as window:
        window.resize(SMALLEST)
        laid_out(window.rail)
        assert window.rail.minimumSizeHint().width() < 100
        room = window.width() - window.rail.minimumSizeHint().width()
        wide = {step.name: window.pages[step.name].minimumSizeHint().width() for step in STEPS}
        assert {step: width for step, width in wide.items() if width > room} == {}
        assert window.minimumSizeHint().height() <= SMALLEST.height()


@pytest.mark.parametrize("name", LANGUAGES)
def test_no_word_is_cut_and_next_is_in_sight_on_any_page_before_and_after_measuring(
    bench: Bench, qapp: QApplication, qtbot: Any, measured_project: Path, tmp_path: Path, name: str
) -> None:
    found: dict[str, dict[str, str]] = {}

    def look(what: str) -> None:
        for size in SIZES if name != PSEUDO else SIZES[1:]:  # no language is 40 % longer than English everywhere
            window.resize(size)
            for _ in range(3):  # a panel that gets wider makes its page divide its room anew
                qapp.processEvents()
            if cut := clipped(window) | sideways(window):
                found[f"{what} at {size.toTuple()}"] = cut

    with window_in(name, bench, qapp, qtbot) as window:
        look("welcome")
        bench.model.create(tmp_path / "empty", new_project("Empty"))
        for project in ("empty", "measured"):
            if project == "measured":
                bench.model.open(measured_project)
                fill_inspect_page(window, bench, qtbot)
            for step in STEPS:
                window.go_to(step.name)
                qtbot.waitUntil(lambda: not bench.quick.busy, timeout=60_000)
                tabs: Any = getattr(window.pages[step.name], "tabs", None)
                for tab in range(tabs.count()) if tabs is not None else (0,):
                    if tabs is not None:
                        tabs.setCurrentIndex(tab)
                    look(f"{project}, {step.name} {tab}")
                if step is not STEPS[-1]:
                    inside = window.rect().contains(window.next.geometry())
                    assert window.next.isVisible() and inside, step.name
    assert found == {}


def test_what_the_lines_of_a_chart_mean_has_room_and_only_a_low_window_is_scrolled_to_the_statistics(
    bench: Bench, qapp: QApplication, qtbot: Any, measured_project: Path
) -> None:
    with window_in("de", bench, qapp, qtbot) as window:
        bench.model.open(measured_project)
        fill_inspect_page(window, bench, qtbot)
        page: Any = window.pages["inspect"]
        page.tabs.setCurrentWidget(page.series)
        field = page.series.chart.canvas

        def has_room() -> bool:
            words = [one for one, _ in page.series.chart._words_shown]
            return all(field.rect().contains(one.mapRectToScene(one.boundingRect()).toRect()) for one in words)

        for size, scrolled in ((SMALLEST, True), (QSize(1280, 800), False)):
            window.resize(size)
            qtbot.waitUntil(lambda: (page.series.below.verticalScrollBar().maximum() > 0) == scrolled)  # noqa: B023
            qtbot.waitUntil(has_room)


@pytest.mark.parametrize("name", LANGUAGES)
def test_menus_and_dialogs_have_room_on_the_smallest_screen_and_cut_no_word(
    bench: Bench, qapp: QApplication, qtbot: Any, measured_project: Path, name: str
) -> None:
    with window_in(name, bench, qapp, qtbot) as window:
        bench.model.open(measured_project)
        for menu in window.findChildren(QMenu):
            assert menu.sizeHint().height() <= SCREEN.height() and menu.sizeHint().width() <= SCREEN.width()
        for dialog in (
            ShortcutList([(key, tr(meaning)) for _, key, meaning in SHORTCUTS], window),
            ImportDialog(bench, measured_project / "imported", window),
        ):
            needed = dialog.minimumSizeHint()
            assert needed.width() <= SCREEN.width() and needed.height() <= SCREEN.height(), type(dialog)
            dialog.resize(dialog.sizeHint().boundedTo(SCREEN))
            dialog.show()
            qapp.processEvents()
            assert clipped(dialog) == {}, type(dialog)
            dialog.close()


def test_a_dialog_is_never_larger_than_its_screen(qapp: QApplication, qtbot: Any) -> None:
    dialog = QWidget()
    qtbot.addWidget(dialog)
    resize_on_screen(dialog, 5000, 400)
    assert dialog.size() == QSize(dialog.screen().availableSize().width(), 400)


def test_a_long_word_of_a_job_makes_the_window_no_wider(window: MainWindow, qapp: QApplication) -> None:
    window.resize(SMALLEST)
    window.task_bar.begin("Measuring the recording")
    window.task_bar.progress("Measuring the recording", "the sweeps meet the fan and each other " * 4, 0.5, "")
    qapp.processEvents()
    assert window.minimumSizeHint().width() <= SMALLEST.width()


def places(window: MainWindow, qapp: QApplication) -> list[QRect]:
    """Where the parts of the page shown are."""
    for _ in range(3):
        qapp.processEvents()
    page = window.pages[window.current]
    parts = (window.rail, page, page.scrolled, window.next)
    return [QRect(part.mapTo(window, QPoint(0, 0)), part.size()) for part in parts]


def test_nothing_moves_when_a_job_begins_goes_on_and_ends(
    window: MainWindow, qapp: QApplication, measured_project: Path
) -> None:
    window.resize(SMALLEST)
    window.model.open(measured_project)
    before = places(window, qapp)
    window.task_bar.begin("Measuring the recording")
    assert places(window, qapp) == before
    window.task_bar.progress("Measuring the recording", "sweeps", 0.5, "about 2 minutes left")
    assert places(window, qapp) == before
    window.task_bar.end()
    assert places(window, qapp) == before


@pytest.mark.parametrize("size", [SMALLEST, QSize(1280, 800)])
def test_nothing_moves_when_a_banner_comes_and_it_tells_all_its_words(
    window: MainWindow, qapp: QApplication, measured_project: Path, size: QSize
) -> None:
    window.resize(size)
    window.model.open(measured_project)
    before = places(window, qapp)
    for words in ("Nothing here opens the report.", "The board was found in none of the pictures of this folder. " * 4):
        window.bench.notices.warning(words)
        assert places(window, qapp) == before
        assert window.banner.isVisible() and clipped(window.banner) == {}
    window.banner.hide()
    assert places(window, qapp) == before


@pytest.mark.parametrize("name", ["en", "de"])
def test_nothing_moves_as_one_instruction_follows_the_other(
    bench: Bench, qapp: QApplication, qtbot: Any, measured_project: Path, name: str
) -> None:
    with window_in(name, bench, qapp, qtbot) as window:
        window.resize(SMALLEST)
        window.model.open(measured_project)
        window.projects.first_measurement_begun.emit()
        before = places(window, qapp)
        for number, each in enumerate(ORDER):
            for can_show in (True, False):
                window.instructions.show_instruction(number, len(ORDER), tr(each.text), can_show=can_show)
                assert places(window, qapp) == before
                assert clipped(window.instructions) == {}


def test_a_folded_panel_shows_nothing_that_keys_could_reach_and_an_open_one_all_of_it(
    hand_page: StepPage, qtbot: Any
) -> None:
    words = QLabel("wrapped words " * 40)
    words.setWordWrap(True)
    panel = hand_page.add_panel("Result", words, collapsed=True)
    hand_page.show()
    assert not words.isVisible()
    panel.toggleButton().click()
    qtbot.waitUntil(lambda: words.isVisible() and words.height() >= words.heightForWidth(words.width()))
    words.setText(words.text() * 2)  # as results arrive
    qtbot.waitUntil(lambda: words.height() >= words.heightForWidth(words.width()))


@pytest.fixture
def hand_page(bench: Bench, qtbot: Any) -> StepPage:
    page = StepPage(StepPresenter(bench))
    qtbot.addWidget(page)
    page.resize(900, 500)
    return page


def test_a_narrow_rail_shows_icons_and_its_tips_tell_the_titles(qtbot: Any) -> None:
    rail = StepRail([("scan", "Scan", "mdi6.line-scan"), ("report", "Report", "mdi6.file")])
    qtbot.addWidget(rail)
    rail.set_states({"scan": ("done", "12 frames."), "report": ("todo", "")})
    laid_out(rail)
    wide = rail.minimumSizeHint().width()
    rail.set_narrow(True)
    laid_out(rail)
    assert rail.minimumSizeHint().width() < 0.5 * wide
    assert [button.toolTip() for button in rail.findChildren(QToolButton)] == ["Scan\n12 frames.", "Report"]
    rail.set_narrow(False)
    assert [button.toolTip() for button in rail.findChildren(QToolButton)] == ["12 frames.", ""]
    laid_out(rail)
    assert rail.minimumSizeHint().width() == wide
