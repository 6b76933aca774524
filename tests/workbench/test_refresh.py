"""Many changes, one refresh, and never within the signal that asked for it."""

from __future__ import annotations

from typing import Any

import shiboken6
from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QApplication, QPushButton

from workbench.bench import Bench
from workbench.pages.presenter import StepPresenter
from workbench.pages.step_page import StepPage
from workbench.refresh import Refresh


class Sender(QObject):
    changed = Signal(object)


class Page(StepPage):
    """Makes its button anew at each refresh."""

    def __init__(self, presenter: StepPresenter) -> None:
        super().__init__(presenter)
        self.refreshes, self.button = 0, QPushButton()

    def refresh(self) -> None:
        self.refreshes += 1
        shiboken6.delete(self.button)
        self.button = QPushButton(self)
        self.button.clicked.connect(self.presenter.changed)


def test_many_changes_are_one_refresh_in_the_next_turn(qapp: QApplication) -> None:
    parent, sender, shown = QObject(), Sender(), []
    refresh = Refresh(lambda: shown.append(1), parent)
    sender.changed.connect(refresh.soon)
    for number in range(5):
        sender.changed.emit(number)
    assert shown == []
    qapp.processEvents()
    assert shown == [1]
    qapp.processEvents()
    assert shown == [1]


def test_whoever_must_look_now_has_it_done_once(qapp: QApplication) -> None:
    parent, shown = QObject(), []
    refresh = Refresh(lambda: shown.append(1), parent)
    refresh.at_once()
    assert shown == []
    refresh.soon()
    refresh.at_once()
    qapp.processEvents()
    assert shown == [1]


def test_what_was_asked_for_is_not_done_for_a_page_that_is_gone(qapp: QApplication) -> None:
    parent, sender, shown = QObject(), Sender(), []
    refresh = Refresh(lambda: shown.append(1), parent)
    sender.changed.connect(refresh.soon)
    sender.changed.emit(0)
    shiboken6.delete(parent)
    qapp.processEvents()
    sender.changed.emit(0)
    assert shown == []


def test_a_page_may_delete_the_button_that_was_clicked(bench: Bench, qtbot: Any, qapp: QApplication) -> None:
    page = Page(StepPresenter(bench))
    qtbot.addWidget(page)
    page.show()
    before, button = page.refreshes, page.button
    for _ in range(3):
        page.button.click()
    assert (page.refreshes, page.button) == (before, button), "the button is still in its signal"
    qapp.processEvents()
    assert page.refreshes == before + 1
    assert page.button is not button


def test_a_hidden_page_is_refreshed_before_it_is_shown_or_soon_after_but_not_while(
    bench: Bench, qtbot: Any, qapp: QApplication
) -> None:
    page = Page(StepPresenter(bench))
    qtbot.addWidget(page)
    page.presenter.changed.emit()
    qapp.processEvents()
    assert page.refreshes == 0
    page.prepare()
    assert page.refreshes == 1
    page.hide()
    page.presenter.changed.emit()
    qapp.processEvents()
    page.show()  # by somebody who did not prepare it: Qt is not to meet widgets that come and go
    assert page.refreshes == 1
    qapp.processEvents()
    assert page.refreshes == 2
