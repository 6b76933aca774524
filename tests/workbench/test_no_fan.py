"""A project whose rig states no fan: nothing about the fan stands in the way, and nothing about it is offered."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from core.calibrate.board_shape import TRUE
from core.files.pictures import write_picture
from core.files.project.data import Accepted, Project, Sources, new_project
from core.files.project.keys import finished, left_to_do
from core.pipeline.live.events import ScanDetail
from core.scan.preview.shown import PreviewCloud, stripes_alone
from core.simulate.scene.corner import corner_planes
from core.states import NO_FAN
from tests.workbench.pages import scan_cases
from workbench.main_window import MainWindow
from workbench.pages.calibration.stage import Stage
from workbench.pages.scan.guidance import Situation, guidance
from workbench.pages.scan.stage import Stage as ScanStage
from workbench.pages.scan.words import NO_LIVE_SCAN, frame_line, frame_sentence


def without_fan(folder: Path) -> Project:
    """With an accepted camera, and small pictures that stand for those of planes, a check and a scan."""
    for part in ("planes", "check", "scan"):
        (folder / part).mkdir(parents=True)
        for number in range(3):
            name = scan_cases.name_of(number).removeprefix("scan/")
            write_picture(folder / part / name, np.full(scan_cases.SIZE[::-1], 40, np.uint8))
    made = new_project("Corner")
    sources = Sources(**{part: (folder / part).as_posix() for part in ("planes", "check", "scan")})
    return replace(made, rig=replace(made.rig, lines=0, angle=0.0), sources=sources, accepted=Accepted("camera-1", ""))


@pytest.fixture
def opened(window: MainWindow, tmp_path: Path) -> MainWindow:
    model = window.model
    model.create(tmp_path / "project", without_fan(tmp_path / "pictures"))
    model.record("camera", finished("camera", model.project, {}))
    return window


def test_next_and_back_go_past_the_laser_planes(opened: MainWindow) -> None:
    opened.go_to("camera")
    opened.go(1)
    assert opened.current == "scan"
    opened.go(-1)
    assert opened.current == "camera"
    states = opened.model.states
    assert opened.rail.state_of("planes") == "not needed" and states["planes"].sentence == NO_FAN
    assert states["scan"].state == "ready"
    assert left_to_do(opened.model.project, opened.model.results) == ("scan", "report")


def test_the_laser_planes_say_why_they_are_not_needed_and_offer_nothing(opened: MainWindow, qtbot: Any) -> None:
    opened.go_to("planes")
    page: Any = opened.pages["planes"]
    p = page.presenter
    qtbot.waitUntil(lambda: not opened.bench.quick.busy)
    assert page.picture.image._empty.message == NO_FAN and not page.side_panel.isVisible()
    assert p.stage is Stage.NOT_NEEDED and p.blocker() == ""
    assert {p.cannot_search, p.cannot_accept, p.cannot_reject, p.live.why_not_start} == {NO_FAN}
    assert not p.work.searching


def test_a_scan_can_be_measured_with_the_camera_alone_and_no_check_is_offered(opened: MainWindow, qtbot: Any) -> None:
    opened.go_to("scan")
    page: Any = opened.pages["scan"]
    p = page.presenter
    qtbot.waitUntil(lambda: p.stage is ScanStage.RECORDED)
    page.refreshing.at_once()
    assert p.cannot_measure == "" and p.calibrated
    assert p.live.why_not_start == NO_LIVE_SCAN
    assert page.card.isVisible() and not page.check.isVisible() and not page.profiles_fold.isVisible()


def test_a_fan_that_is_stated_again_is_wanted_again(opened: MainWindow) -> None:
    model = opened.model
    model.edit("state a fan", replace(model.project, rig=replace(model.project.rig, lines=3)))
    assert model.states["planes"].state == "ready"
    assert model.states["scan"].sentence.startswith("First: calibrate the laser planes")
    assert "planes" in left_to_do(model.project, model.results)


def test_without_a_recording_its_folder_is_asked_for(opened: MainWindow, qtbot: Any) -> None:
    model = opened.model
    model.edit("no scan", replace(model.project, sources=replace(model.project.sources, scan="")))
    opened.go_to("scan")
    page: Any = opened.pages["scan"]
    qtbot.waitUntil(lambda: page.picture.image._empty.message == NO_LIVE_SCAN)
    assert page.card.words.text() == NO_LIVE_SCAN and page.source.mode == "folder"


def with_boards(model: Any) -> None:
    project = model.project
    model.edit("state boards", replace(project, rig=replace(project.rig, known_planes=corner_planes("charuco", TRUE))))


def test_with_boards_that_are_stated_a_scan_can_be_recorded_live(opened: MainWindow, qtbot: Any) -> None:
    model = opened.model
    with_boards(model)
    opened.go_to("scan")
    page: Any = opened.pages["scan"]
    qtbot.waitUntil(lambda: page.presenter.work.calibrations_read)
    assert page.presenter.live.why_not_start == ""
    request = page.presenter.live._request(model.folder)
    assert request.boards == ("far", "near") and not request.rig.has_fan
    model.edit("no camera", replace(model.project, accepted=Accepted("", "")))
    assert page.presenter.live.why_not_start == "Accept a camera calibration first."


def test_the_rail_has_five_pages_numbered_without_a_gap(opened: MainWindow) -> None:
    rail = opened.rail
    shown = [button.text() for name, button in rail._buttons.items() if not button.isHidden()]
    assert [text.split()[0] for text in shown] == ["1", "2", "3", "4", "5"]
    assert not any("planes" in text for text in shown)
    model = opened.model
    model.edit("state a fan", replace(model.project, rig=replace(model.project.rig, lines=3)))
    opened._refresh()
    assert not any(button.isHidden() for button in rail._buttons.values())


def test_while_the_boards_are_taken_the_guide_speaks_of_no_fan() -> None:
    nothing = Situation("", False, False, ("", ""), False, None, (), has_fan=False)
    cells = np.zeros((2, 2), bool)
    none = PreviewCloud.joined([])

    def said(stage: Any) -> str:
        return guidance(
            nothing._replace(detail=ScanDetail(-1, stage, None, (), cells, cells, 0.0, none, False))
        ).sentence

    assert said("boards").startswith("Taking the boards")
    assert said("reference") == "Taking the reference: all lasers are off, nothing moves."


def test_a_frame_is_not_said_to_cross_no_line_of_the_fan() -> None:
    record = scan_cases.records()[1]
    said = frame_sentence(1, 6, record.name, record, None, has_fan=False)
    assert "fan" not in said and said.endswith("20 crossings with other sweeps, 1 left out.")


def test_while_it_is_measured_a_frame_shows_its_stripe_and_claims_no_points(opened: MainWindow, qtbot: Any) -> None:
    opened.go_to("scan")
    page: Any = opened.pages["scan"]
    qtbot.waitUntil(lambda: page.presenter.stage is ScanStage.RECORDED)
    seen = stripes_alone(1, scan_cases.name_of(1), None, scan_cases.preview(1).centrelines)
    detail = replace(scan_cases.detail(1), preview=seen, fan_lines=(), share=0.0)
    page.picture.show_measured(detail, np.full(scan_cases.SIZE[::-1], 40, np.uint8), 1)
    page.running.show_detail(detail, float(scan_cases.SIZE[0]))
    assert set(page.picture.image.layer_names()) == {"sweep"}
    assert page.running.covered.text() == ""
    assert frame_line(None, (0, None)) == ""
