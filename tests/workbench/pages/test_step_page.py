"""What all pages share: the panel at the side."""

from __future__ import annotations

from typing import Any

from PySide6.QtWidgets import QCheckBox, QListWidget

from workbench.bench import Bench
from workbench.pages.presenter import StepPresenter
from workbench.pages.step_page import StepPage
from workbench.views.layouts import Sentence


def test_the_side_is_never_narrower_than_what_is_in_it_however_narrow_the_window(hand_bench: Bench, qtbot: Any) -> None:
    page = StepPage(StepPresenter(hand_bench))
    qtbot.addWidget(page)
    page.resize(500, 400)
    page.show()
    side: Any = page.scrolled
    page.splitter.setSizes([500, 10])
    assert side.width() >= 300
    box = QCheckBox("a very long setting " * 4)
    page.add_to_side(box)
    qtbot.waitUntil(lambda: side.viewport().width() >= side.widget().minimumSizeHint().width() > 400)
    page.splitter.setSizes([500, 10])
    right = box.mapTo(side.viewport(), box.rect().topRight()).x()
    assert right < side.viewport().width(), "nothing is cut off"


def test_a_list_at_the_side_is_higher_on_a_higher_page_and_never_too_low(hand_bench: Bench, qtbot: Any) -> None:
    page, listed = StepPage(StepPresenter(hand_bench)), QListWidget()
    qtbot.addWidget(page)
    page.add_list("Views", listed)
    page.show()
    heights = []
    for height in (500, 1000, 500):
        page.resize(900, height)
        qtbot.waitUntil(lambda height=height: page.height() == height)
        heights.append(listed.minimumHeight())
    assert heights[0] == heights[2] == 240 and 330 < heights[1] < 400


def test_a_list_at_the_side_gives_way_to_what_would_else_be_scrolled_to(hand_bench: Bench, qtbot: Any) -> None:
    page, listed, below = StepPage(StepPresenter(hand_bench)), QListWidget(), Sentence("words")
    qtbot.addWidget(page)
    page.add_list("Views", listed)
    page.add_to_side(below)
    page.resize(900, 1000)
    page.show()
    bar = page.scrolled.verticalScrollBar()
    for height, whole in ((560, True), (640, True), (900, False), (600, True), (100, True)):
        below.setFixedHeight(height)
        qtbot.waitUntil(lambda height=height: below.height() == height)
        qtbot.waitUntil(lambda whole=whole: (bar.maximum() == 0) is whole)
        assert listed.height() >= 240
    qtbot.waitUntil(lambda: listed.height() == 360)
    page.resize(900, 950)
    below.setFixedHeight(600)
    qtbot.waitUntil(lambda: below.height() == 600 and bar.maximum() == 0 and page.height() == 950)
