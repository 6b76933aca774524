"""The welcome page under the mouse and the keys."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QWidget

from core.files.project.data import ProjectFile, new_project
from core.files.project.folder import create_project
from tests.workbench.cells import place
from tests.workbench.hand_lane import HandLane
from workbench.bench import Bench
from workbench.pages.project.actions import ProjectActions
from workbench.pages.project.welcome_page import WelcomePage
from workbench.views import ask
from workbench.work import jobs


@pytest.fixture
def page(hand_bench: Bench, qtbot: Any) -> Iterator[WelcomePage]:
    window = QWidget()
    qtbot.addWidget(window)
    made = WelcomePage(ProjectActions(hand_bench, window))
    qtbot.addWidget(made)
    made.resize(1280, 760)
    with qtbot.waitExposed(made):
        made.show()
    yield made
    made.hide()


def listed(page: WelcomePage) -> list[Path]:
    page._refreshing.at_once()
    return [Path(page._listed.key(place(page.recent, row))) for row in range(page.recent.model().rowCount())]


def with_recent(page: WelcomePage, *folders: Path) -> None:
    for folder in folders:
        create_project(folder, ProjectFile(new_project(folder.name)))
        page._projects.bench.settings.remember(folder)
    page._refreshing.at_once()


def click(qtbot: Any, widget: QWidget) -> None:
    qtbot.mouseClick(widget, Qt.MouseButton.LeftButton)


def test_without_recent_projects_it_says_what_will_be_there(page: WelcomePage) -> None:
    assert not page.recent.isVisible()
    assert page._none.isVisible()


def test_recent_projects_are_listed_newest_first_and_open_by_one_click(
    page: WelcomePage, qtbot: Any, tmp_path: Path
) -> None:
    first, second = tmp_path / "first", tmp_path / "second"
    with_recent(page, first, second)
    assert listed(page) == [second, first]
    where = page.recent.visualRect(place(page.recent, 1)).center()
    qtbot.mouseClick(page.recent.viewport(), Qt.MouseButton.LeftButton, pos=where)
    qtbot.waitUntil(lambda: page._projects.model.folder == first)
    assert listed(page) == [first, second]


def test_enter_opens_and_delete_leaves_out(page: WelcomePage, qtbot: Any, tmp_path: Path) -> None:
    first, second = tmp_path / "first", tmp_path / "second"
    with_recent(page, first, second)
    page.activateWindow()
    page.recent.setFocus()
    page.recent.setCurrentIndex(place(page.recent, 1))
    qtbot.waitUntil(page.recent.hasFocus)
    qtbot.keyClick(page.recent, Qt.Key.Key_Delete)
    assert listed(page) == [second]
    assert (first / "project.json").exists(), "only the list forgets it"
    page.recent.setCurrentIndex(place(page.recent, 0))
    qtbot.keyClick(page.recent, Qt.Key.Key_Return)
    qtbot.waitUntil(lambda: page._projects.model.folder == second)


def test_a_project_that_is_gone_is_not_listed(page: WelcomePage, tmp_path: Path) -> None:
    with_recent(page, tmp_path / "gone")
    (tmp_path / "gone" / "project.json").unlink()
    page.refresh()
    assert listed(page) == []


def test_the_sample_link_says_that_it_is_being_prepared(page: WelcomePage, qtbot: Any) -> None:
    measuring = cast(HandLane, page._projects.bench.measuring)
    measuring.held = {jobs.SAMPLE_PROJECT}
    click(qtbot, page.sample)
    assert not page.sample.isEnabled()
    assert page.sample.text() == "Preparing the sample …"
    assert page.sample.toolTip()
    measuring.cancel_all()
    assert page.sample.isEnabled()
    assert page.sample.text() == "Open sample"


def test_every_link_leads_somewhere(
    page: WelcomePage, qtbot: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    model, went = page._projects.model, list[str]()
    page._projects.go_to.connect(went.append)
    click(qtbot, page.simulated)
    assert model.is_open
    assert went == ["camera"]
    monkeypatch.setattr(ask, "ask_new_project", lambda *_: ("Mine", tmp_path, 0))
    click(qtbot, page.new)
    assert model.folder == tmp_path / "Mine"
    create_project(tmp_path / "other", ProjectFile(new_project("Other")))
    monkeypatch.setattr(ask, "choose_folder", lambda *_: tmp_path / "other")
    click(qtbot, page.open)
    assert model.project.info.name == "Other"
