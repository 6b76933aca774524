"""The laser planes page's work with real pictures, in real processes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from core.files.project.folder import read_project
from tests.simulated import TINY
from workbench.bench import Bench
from workbench.pages.calibration.stage import Stage
from workbench.pages.planes.presenter import PlanesPresenter


@pytest.fixture
def page(bench: Bench, measured_project: Path, qtbot: Any) -> PlanesPresenter:
    made = PlanesPresenter(bench)
    bench.model.open(measured_project)
    qtbot.waitUntil(lambda: made.candidate != "" and not bench.quick.busy, timeout=60_000)
    return made


def stage(page: PlanesPresenter) -> Stage:
    """Read anew each time."""
    return page.stage


def settled(qtbot: Any, page: PlanesPresenter, seconds: float = 60) -> None:
    qtbot.waitUntil(lambda: not page.bench.quick.busy and not page.bench.measuring.busy, timeout=int(1000 * seconds))


def test_a_finished_project_shows_what_it_was_made_from_and_can_be_changed(page: PlanesPresenter, qtbot: Any) -> None:
    assert stage(page) is Stage.ACCEPTED
    accepted, first = page.candidate, page.views()[0].name
    assert page.seen_by.camera is not None
    kept = [entry.id for entry in page.history.entries]
    page.set_used([first], False)
    settled(qtbot, page)
    assert stage(page) is Stage.SOLVED
    page.do_accept()
    qtbot.waitUntil(lambda: page.stage is Stage.ACCEPTED, timeout=20_000)
    settled(qtbot, page)
    assert [entry.id for entry in page.history.entries] == [page.candidate, *kept]
    page.history.choose(accepted)
    page.history.restore()
    assert page.project.accepted.planes == accepted
    page.do_run()
    settled(qtbot, page)
    assert page.candidate != accepted, "one pose is still left out"
    assert stage(page) is Stage.OTHER
    page.set_used([first], True)
    settled(qtbot, page)
    assert page.candidate == accepted
    assert stage(page) is Stage.ACCEPTED
    page.model.save()
    assert page.model.folder is not None
    assert read_project(page.model.folder).project.accepted.planes == accepted
    assert [notice.text for notice in page.bench.notices.all] == []


@pytest.mark.accuracy
@pytest.mark.parametrize("pairs", [True, False])
def test_poses_of_the_simulated_rig_are_taken_with_or_without_the_laser_off_and_calibrated(
    page: PlanesPresenter, qtbot: Any, pairs: bool
) -> None:
    page.live.settings.set_id(f"scale = {TINY.scale}")  # as large as the project's pictures
    page.set_pairs(pairs)
    page.live.view.connect(lambda _: page.live.shown())
    page.do_live()
    qtbot.waitUntil(lambda: page.live.recorded >= 5, timeout=90_000)
    page.do_live()
    qtbot.waitUntil(lambda: not page.live.running, timeout=10_000)
    settled(qtbot, page)
    assert page.project.sources.planes.startswith("recordings/planes-")
    assert page.folder is not None
    names = sorted(path.stem for path in page.folder.glob("*.png"))
    assert any(name.endswith("_off") for name in names) == pairs
    assert page.stage is Stage.SOLVED, page.work.problem
    assert sum(pose.used for pose in page.views()) >= 5
