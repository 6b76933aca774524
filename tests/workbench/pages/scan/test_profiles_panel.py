"""Fixed lines alone, on the scan page: what is asked of one line, and what is said of the result."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from core.files.project.data import new_project
from core.files.project.results import ProfilesSummary
from core.files.results.profile_file import PictureStep
from core.inspect.results import Face, GaugeResult
from core.messages import plain
from core.model import LightPlane
from core.settings.options import StatedTilt
from workbench.bench import Bench
from workbench.pages.scan.profiles import ProfilesPanel


def gauge() -> GaugeResult:
    face = Face(LightPlane(np.array([0, 0, 0.002])), np.arange(3), np.zeros(3), 0.01, 0.01)
    return GaugeResult(20.004, 0.01, 2.0, face, face, 0.0, (), notes=(plain("The part was at rest."),), doubts=())


@pytest.fixture
def panel(bench: Bench, qtbot: Any, tmp_path: Path) -> Iterator[ProfilesPanel]:
    made = ProfilesPanel(bench)
    qtbot.addWidget(made)
    made.show()
    yield made


def opened(panel: ProfilesPanel, bench: Bench, folder: Path, lines: int) -> None:
    project = new_project("Block")
    bench.model.create(folder, replace(project, rig=replace(project.rig, lines=lines)))
    panel.refresh("")


def test_only_one_line_asks_how_the_faces_stand(panel: ProfilesPanel, bench: Bench, tmp_path: Path) -> None:
    opened(panel, bench, tmp_path / "three", 3)
    assert not panel.form.isVisible()
    assert panel.tilt() is None
    opened(panel, bench, tmp_path / "one", 1)
    assert panel.form.isVisible()
    assert panel.tilt() is None
    panel.form.edited.emit("stage", "pose03")
    panel.form.edited.emit("tilt_sd", 0.5)
    assert panel.tilt() == StatedTilt("pose03", float(np.radians(0.5)))


def test_the_result_is_told_with_every_picture_that_gave_none(
    panel: ProfilesPanel, bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened(panel, bench, tmp_path / "three", 3)
    given: dict[str, Any] = {}

    def run_long(_self: Bench, *args: Any, **more: Any) -> object:
        given.update(args=args, **more)
        return object()

    monkeypatch.setattr(type(bench), "run_long", run_long)
    panel.measure.click()
    assert not panel.measure.isEnabled()
    pictures = (PictureStep(0, "scan/a.png", 20.0, 0.01, (5, 5)), PictureStep.none(1, "scan/b.png", plain("no face")))
    given["on_done"](ProfilesSummary(gauge(), pictures, (), tmp_path / "report.pdf"))
    assert panel.measure.isEnabled()
    assert panel.open.isVisible()
    told = panel.said.text()
    assert "20.004\u00a0±\u00a00.020\u00a0mm" in told
    assert "Pictures: 1 of 2" in told
    assert "1 × no face: b.png" in told
    assert "The part was at rest." in told


def test_another_project_forgets_the_result(panel: ProfilesPanel, bench: Bench, tmp_path: Path) -> None:
    opened(panel, bench, tmp_path / "one", 1)
    panel.form.edited.emit("stage", "pose03")
    opened(panel, bench, tmp_path / "two", 1)
    assert panel.tilt() is None
    assert not panel.said.isVisible()


def test_without_calibrations_nothing_is_measured(panel: ProfilesPanel, bench: Bench, tmp_path: Path) -> None:
    opened(panel, bench, tmp_path / "one", 1)
    panel.refresh("Accept a camera calibration first.")
    assert not panel.measure.isEnabled()
    assert panel.measure.toolTip() == "Accept a camera calibration first."


def test_a_result_of_the_project_before_is_not_told_in_another(
    panel: ProfilesPanel, bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened(panel, bench, tmp_path / "one", 3)
    given: dict[str, Any] = {}

    class Job:
        def cancel(self) -> None:
            given["cancelled"] = True

    def run_long(_self: Bench, *_args: Any, **more: Any) -> Job:
        given.update(more)
        return Job()

    monkeypatch.setattr(type(bench), "run_long", run_long)
    panel.measure.click()
    opened(panel, bench, tmp_path / "two", 3)
    assert panel.measure.isEnabled(), "the job of the project before is not this one's"
    assert given["cancelled"]
    given["on_done"](ProfilesSummary(gauge(), (), (), tmp_path / "report.pdf"))
    assert panel.said.text() == ""
    assert not panel.open.isVisible()
