"""The camera page's work with real pictures, in real processes."""

from pathlib import Path

import pytest

from core.files.project.folder import project_from_set
from workbench.bench import Bench
from workbench.pages.calibration.stage import Stage
from workbench.pages.camera.presenter import CameraPresenter


@pytest.fixture
def presenter(bench: Bench, simulated: Path, tmp_path: Path) -> CameraPresenter:
    made = CameraPresenter(bench)
    bench.model.create(tmp_path / "project", project_from_set(simulated, "block"))
    return made


def test_a_recorded_set_is_calibrated_accepted_and_there_again_after_reopening(presenter, qtbot):
    qtbot.waitUntil(lambda: presenter.stage is Stage.FOUND, timeout=60_000)
    presenter.do_run()
    qtbot.waitUntil(lambda: presenter.work.judgement is not None, timeout=60_000)
    assert presenter.stage is Stage.SOLVED
    assert presenter.work.judgement.expected[1].median_mm < 0.1
    presenter.set_used([presenter.views()[0].name], False)
    qtbot.waitUntil(lambda: not presenter.work.solving, timeout=10_000)
    presenter.do_accept()
    qtbot.waitUntil(lambda: presenter.stage is Stage.ACCEPTED, timeout=20_000)
    candidate = presenter.candidate
    presenter.model.save()
    presenter.model.open(presenter.model.folder)
    qtbot.waitUntil(lambda: presenter.work.judgement is not None, timeout=20_000)
    assert presenter.candidate == candidate and presenter.blocker() == ""
    assert not presenter.bench.notices.all
    qtbot.waitUntil(lambda: not presenter.bench.quick.busy, timeout=20_000)


def test_searching_can_be_cancelled(presenter, qtbot):
    qtbot.waitUntil(lambda: presenter.stage is Stage.FOUND, timeout=60_000)
    presenter.do_run()
    presenter.work.search_task.cancel()
    qtbot.waitUntil(lambda: not presenter.work.searching, timeout=3_000)
    assert presenter.stage is Stage.FOUND
    qtbot.waitUntil(lambda: not presenter.bench.quick.busy, timeout=20_000)


@pytest.mark.accuracy
def test_views_of_the_simulated_rig_are_taken_and_become_the_source(presenter, qtbot):
    presenter.live.settings.set_id("scale = 0.25")
    presenter.do_live()
    presenter.live.view.connect(lambda _: presenter.live.shown())
    qtbot.waitUntil(lambda: presenter.live.recorded >= 2, timeout=90_000)
    presenter.do_live()
    qtbot.waitUntil(lambda: not presenter.live.running, timeout=10_000)
    assert presenter.project.sources.camera.startswith("recordings/camera-")
    assert len(list(presenter.folder.glob("*.png"))) >= 2
    qtbot.waitUntil(lambda: not presenter.work.searching and not presenter.bench.quick.busy, timeout=60_000)
