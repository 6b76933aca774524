"""Pages of a document: shown at once, sharp soon, never in the way."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QWheelEvent
from PySide6.QtWidgets import QApplication

from tests.workbench.watchdog import LIMIT_MS, Watchdog
from workbench.theme import shades
from workbench.views.pages.page_scroll import MOST_ZOOM, NARROWEST_PX, WIDEST_PX, PageScroll


def page(shade: int = 255, size: tuple[int, int] = (1980, 1400)) -> Any:
    drawn = np.full((*size, 3), shade, np.uint8)
    drawn[::40] = 30
    return drawn


@pytest.fixture
def scroll(qtbot: Any) -> Iterator[PageScroll]:
    made = PageScroll()
    qtbot.addWidget(made)
    made.resize(720, 600)
    with qtbot.waitExposed(made):
        made.show()
    yield made
    made.hide()


def all_sharp(qtbot: Any, scroll: PageScroll) -> None:
    qtbot.waitUntil(lambda: all(sheet.is_sharp for sheet in scroll._in_sight()), timeout=3000)


def test_without_pages_a_sentence_stands_there(scroll: PageScroll) -> None:
    scroll.set_message("Scan the part first.")
    assert scroll.message == "Scan the part first."
    scroll.set_pages([page()])
    assert scroll.message == ""
    scroll.set_pages([])
    assert scroll.message == "Scan the part first."


def test_pages_are_as_wide_as_there_is_room_within_limits(scroll: PageScroll, qtbot: Any) -> None:
    scroll.set_pages([page(), page(200, (1000, 1400))])
    first, second = scroll.sheets
    assert first.width() == second.width()
    assert first.height() == pytest.approx(first.width() * 1980 / 1400, abs=1)
    assert 600 < first.width() < 720
    for width, wanted in ((2000, WIDEST_PX), (200, NARROWEST_PX)):
        scroll.resize(width, 600)
        qtbot.waitUntil(lambda wanted=wanted: first.width() == wanted)


def test_only_what_is_in_sight_is_made_sharp(scroll: PageScroll, qtbot: Any) -> None:
    scroll.set_pages([page() for _ in range(5)])
    all_sharp(qtbot, scroll)
    assert [sheet.is_sharp for sheet in scroll.sheets] == [True, False, False, False, False]
    qtbot.keyClick(scroll._scroll, Qt.Key.Key_End)
    all_sharp(qtbot, scroll)
    assert scroll.sheets[-1].is_sharp
    assert not scroll.sheets[2].is_sharp
    assert scroll._place.text() == "Page 5 of 5"


def test_keys_buttons_and_wheel_zoom_and_the_middle_stays(scroll: PageScroll, qtbot: Any) -> None:
    scroll.set_pages([page() for _ in range(3)])
    bar, fitted = scroll._scroll.verticalScrollBar(), scroll.sheets[0].width()
    bar.setValue(bar.maximum() // 2)
    middle = (bar.value() + bar.pageStep() / 2) / scroll._inside.height()
    qtbot.keyClick(scroll._scroll, Qt.Key.Key_Plus)
    qtbot.mouseClick(scroll.larger, Qt.MouseButton.LeftButton)
    assert scroll.sheets[0].width() == round(fitted * 1.44)
    assert (bar.value() + bar.pageStep() / 2) / scroll._inside.height() == pytest.approx(middle, abs=0.01)
    qtbot.keyClick(scroll._scroll, Qt.Key.Key_Minus)
    assert scroll.sheets[0].width() == round(fitted * 1.2)
    turn = QWheelEvent(
        QPointF(50, 50), QPointF(50, 50), QPoint(), QPoint(0, 120), Qt.MouseButton.NoButton,
        Qt.KeyboardModifier.ControlModifier, Qt.ScrollPhase.NoScrollPhase, False,
    )  # fmt: skip
    QApplication.sendEvent(scroll._scroll.viewport(), turn)
    assert scroll.sheets[0].width() == round(fitted * 1.44)
    qtbot.keyClick(scroll._scroll, Qt.Key.Key_0)
    assert scroll.sheets[0].width() == fitted
    for _ in range(20):
        scroll.zoom(1.2)
    assert scroll.sheets[0].width() == round(fitted * MOST_ZOOM)


def test_new_pages_keep_the_place_that_is_looked_at(scroll: PageScroll, qtbot: Any) -> None:
    scroll.set_pages([page() for _ in range(3)])
    bar = scroll._scroll.verticalScrollBar()
    bar.setValue(700)
    scroll.set_pages([page(240) for _ in range(3)])
    QApplication.processEvents()
    assert bar.value() == 700
    assert scroll.count() == 3


def test_pages_that_are_no_longer_true_are_dimmed_and_say_why(scroll: PageScroll, qtbot: Any) -> None:
    scroll.set_pages([page()])
    all_sharp(qtbot, scroll)
    bright = scroll.sheets[0].grab().toImage().pixelColor(300, 300).lightness()
    scroll.set_note("Drawing the pages …")
    assert scroll._note.isVisible()
    assert scroll.sheets[0].grab().toImage().pixelColor(300, 300).lightness() < bright
    scroll.set_note("")
    assert not scroll._note.isVisible()
    assert scroll.sheets[0].grab().toImage().pixelColor(300, 300).lightness() == bright


def test_many_pages_and_a_window_pulled_to_and_fro_do_not_hold_the_window_up(scroll: PageScroll, qtbot: Any) -> None:
    pages = [page() for _ in range(8)]
    scroll.set_pages(pages)
    all_sharp(qtbot, scroll)
    with Watchdog() as watchdog:
        for turn in range(3):
            scroll.set_pages(pages)
            for width in range(500, 1100, 60):
                scroll.resize(width, 900)
                qtbot.wait(8)
            scroll.zoom(1.2 if turn % 2 else 1 / 1.2)
            all_sharp(qtbot, scroll)
    assert watchdog.longest_ms < LIMIT_MS, watchdog.worst()


def test_a_window_that_was_wide_can_be_made_narrow_again_in_one_go(qtbot: Any) -> None:
    view = PageScroll()
    qtbot.addWidget(view)
    narrow = view.minimumSizeHint().width()
    view.resize(1900, 900)
    view.show()
    view.set_message("Drawing the pages …")
    QApplication.processEvents()
    assert view.minimumSizeHint().width() <= narrow + 60


def test_a_page_is_framed_at_its_very_edge(scroll: PageScroll, qtbot: Any) -> None:
    scroll.set_pages([page()])
    all_sharp(qtbot, scroll)
    drawn = scroll.sheets[0].grab().toImage()
    for x in (0, drawn.width() - 1):
        assert drawn.pixelColor(x, drawn.height() // 3).name() == shades().line.lower()
