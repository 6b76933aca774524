"""Whether the plate is left beside the part is asked once in a project, and a live scan then takes its picture."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from core.files.project.data import new_project
from core.files.project.folder import read_project
from workbench.main_window import MainWindow


@pytest.fixture
def asking(window: MainWindow, tmp_path: Path) -> Any:
    window.model.create(tmp_path / "project", new_project("Part"))
    window.go_to("scan")
    page: Any = window.pages["scan"]
    page.refreshing.at_once()
    return page


@pytest.mark.parametrize(("button", "boards"), [("yes", ("plate",)), ("no", ())])
def test_an_answer_is_kept_and_it_is_asked_no_more(asking: Any, button: str, boards: tuple[str, ...]) -> None:
    model = asking.presenter.model
    assert not asking.plate.isHidden() and asking.presenter.boards == ()
    getattr(asking.plate, button).click()
    asking.refreshing.at_once()
    assert asking.plate.isHidden()
    assert asking.presenter.boards == boards == asking.presenter.live._request(model.folder).boards
    model.save()
    assert read_project(model.folder / "project.json").project.plate_beside is (button == "yes")
    model.undo_stack.undo()
    asking.refreshing.at_once()
    assert not asking.plate.isHidden()
