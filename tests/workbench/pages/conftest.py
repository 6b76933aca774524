"""A project with views that need not be looked for, and one with a scan."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from core.calibrate.board_shape import BoardTolerance
from core.calibrate.camera.views import SeenView, SeenViews, ViewsJudgement, judge_views
from core.calibrate.results import CameraCalibration
from core.errors import InputError
from core.files.pictures import write_picture
from core.files.project.data import Accepted, Project, new_project
from core.messages import plain
from core.pipeline.steps.camera_step import solve_camera
from core.settings.options import Options
from tests.calibrate.camera_views import TRUTH, synthetic_views
from tests.workbench.hand_lane import HandLane
from tests.workbench.pages import scan_cases
from workbench.bench import Bench
from workbench.pages.scan.page import ScanPage
from workbench.pages.scan.presenter import ScanPresenter
from workbench.work import jobs

VIEWS = 9


@pytest.fixture(scope="session")
def views_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Small pictures that stand for views of the target."""
    folder: Path = tmp_path_factory.mktemp("views") / "camera"
    folder.mkdir()
    for number in range(VIEWS):
        write_picture(folder / f"view{number:02d}.png", np.full((12, 16), 20 * number, np.uint8))
    return folder


@cache
def views() -> SeenViews:
    """What the target in those pictures would be found as; one picture shows none, one view is poor."""
    views = [replace(view, name=f"camera/{view.name}") for view in synthetic_views(1, VIEWS - 1)]
    rng = np.random.default_rng(5)
    views[3] = replace(views[3], uv=views[3].uv + rng.normal(0, 0.06, views[3].uv.shape))
    lost = SeenView(f"camera/view{VIEWS - 1:02d}.png", None, plain("no checkerboard"), TRUTH.image_size)
    return SeenViews((*(SeenView(view.name, view, None, TRUTH.image_size) for view in views), lost), "camera")


@cache
def solved(options: Options, board: BoardTolerance) -> CameraCalibration:
    """The calibration of those views; solved once for all tests."""
    return solve_camera(views(), options.for_camera, tolerance=board)


def find(folder: Path, project: Project) -> SeenViews:
    """What finding the target gives."""
    if "circle" in type(project.rig.camera_target).__name__.lower():
        raise InputError("the camera target was found in none of 9 pictures", todo="check the target")
    return views()


def solve(folder: Path, project: Project, found: SeenViews) -> CameraCalibration:
    """The calibration as a process would send it: another object each time."""
    if found is not views():  # what the project has kept
        return solve_camera(found, project.options.for_camera, tolerance=project.rig.camera_board)
    return replace(solved(project.options, project.rig.camera_board))


JUDGED: dict[tuple[int, frozenset[str]], tuple[CameraCalibration, ViewsJudgement]] = {}
"""By the camera, which is kept alive beside it, and by what is left out."""


def judge(seen: SeenViews, excluded: Collection[str], calibration: CameraCalibration | None) -> ViewsJudgement:
    """The judgement of the views; of a calibration out of `solved` it is made once for all tests."""
    if calibration is None or seen is not views():
        return judge_views(seen, excluded, calibration)
    key = id(calibration.camera), frozenset(excluded)
    if key not in JUDGED:
        JUDGED[key] = calibration, judge_views(seen, excluded, calibration)
    return JUDGED[key][1]


@pytest.fixture
def camera_bench(hand_bench: Bench, tmp_path: Path) -> Bench:
    """An open project without pictures; the target is found at once in whatever it is given."""
    cast(HandLane, hand_bench.measuring).answers[jobs.FIND_VIEWS] = find
    cast(HandLane, hand_bench.quick).answers |= {jobs.SOLVE_VIEWS: solve, jobs.JUDGE_VIEWS: judge}
    hand_bench.model.create(tmp_path / "project", new_project("block"))
    return hand_bench


@pytest.fixture
def scan_folder(tmp_path: Path) -> Path:
    """A recording of a few small pictures, with a reference."""
    folder = tmp_path / "recorded" / "scan"
    folder.mkdir(parents=True)
    names = [scan_cases.name_of(number).removeprefix("scan/") for number in range(scan_cases.FRAMES)]
    for name in ("reference.png", *names):
        write_picture(folder / name, np.full(scan_cases.SIZE[::-1], 40, np.uint8))
    return folder


@pytest.fixture
def scan_bench(hand_bench: Bench, tmp_path: Path) -> Bench:
    """An open project with both calibrations accepted; measuring waits for the test, frames are looked at at once."""
    cast(HandLane, hand_bench.measuring).held = {jobs.WATCH_SCAN}
    quick = cast(HandLane, hand_bench.quick)
    quick.answers[jobs.ACCEPTED_CALIBRATION] = lambda folder, project: ("camera", "fan", None)
    quick.answers[jobs.ARTEFACT_CHECKS] = lambda folder, project: ()
    quick.answers[jobs.ARTEFACT_CHARTS] = lambda folder, project: ()
    quick.answers[jobs.SHOW_SCAN] = lambda folder: scan_cases.look()
    quick.answers[jobs.SHOW_FRAME] = lambda folder, project, name: scan_cases.stages(name)
    hand_bench.model.create(tmp_path / "project", replace(new_project("block"), accepted=Accepted("camera-1", "fan-1")))
    return hand_bench


@pytest.fixture
def scan_page(scan_bench: Bench, qtbot: Any, monkeypatch: pytest.MonkeyPatch) -> ScanPage:
    """The scan page of that project, shown without 3D."""
    monkeypatch.setenv("TRISECT_NO_OPENGL", "none")
    made = ScanPage(ScanPresenter(scan_bench))
    made.presenter.opened()
    qtbot.addWidget(made)
    made.resize(1100, 700)
    made.show()
    return made
