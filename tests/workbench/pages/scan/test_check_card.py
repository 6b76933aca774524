"""The Check card of the scan page: pictures of the day, run, light, figures."""

from dataclasses import replace
from datetime import date, datetime, timedelta
from typing import cast

import numpy as np
import pytest
from PySide6.QtCore import Qt

from core.calibrate.results import CameraCalibration, FanCalibration, ProposedReadjustment, Readjustment
from core.calibrate.sitting import Acquisition
from core.checks.artefact_check import Artefact, ArtefactCheck
from core.errors import InputError
from core.files.project.data import Accepted, new_project
from core.files.results.check_file import write_check
from core.files.results.rig_history import PastCheck, RigHistory
from core.messages import plain
from core.model import Camera, Fan, LightPlane
from core.pipeline.live.events import LiveChecks, LiveEnded, LiveStarted, LiveView, PlanesDetail
from core.pipeline.live.rig_check import rig_check
from core.scan.preview.preflight import Check
from tests.check_cases import TAKEN, chart, check, nowhere
from tests.workbench.hand_lane import HandLane
from workbench.pages.scan.check import CheckStage
from workbench.pages.scan.check_card import facts
from workbench.views import ask
from workbench.work import jobs

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def measuring(scan_bench):
    lane = cast(HandLane, scan_bench.measuring)
    lane.held.add(jobs.CHECK_RIG)
    return lane


@pytest.fixture
def page(measuring, scan_page):
    return scan_page


@pytest.fixture
def chosen(page, qtbot, monkeypatch, tmp_path):
    """The folder of the day's pictures is chosen by hand: the check begins."""
    folder = tmp_path / "today"
    folder.mkdir()
    monkeypatch.setattr(ask, "choose_folder", lambda *_: folder)
    qtbot.mouseClick(page.check.choose, LEFT)
    return page


def shown(page, qtbot, stage):
    qtbot.waitUntil(lambda: page.presenter.check.stage is stage)
    page.refresh()
    return page.check


def test_without_pictures_it_says_how_to_take_them(page, qtbot):
    card = shown(page, qtbot, CheckStage.NONE)
    assert card.word.text() == "Not checked"
    assert "pictures of the plane target in the fan" in card.sentence.text()
    assert not card.run.isEnabled() and card.run.toolTip() == "Choose the pictures of the check first."
    assert card.rows.isHidden()


def primary(page):
    page.refresh()
    buttons = (page.check.take, page.live_panel.start)
    return [one.text() for one in buttons if one.property("primary")]


def test_where_nobody_has_checked_today_three_pictures_are_the_next_step_and_asked_for_once(page, qtbot, measuring):
    p = page.presenter
    page.source.set_mode("live")
    qtbot.waitUntil(lambda: p.work.calibrations_read)
    assert primary(page) == ["Take 3 pictures"]
    p.work.planes_taken = Acquisition("Camera 1", *2 * [datetime.now().astimezone() - timedelta(hours=1)])
    assert primary(page) == ["Start live"], "planes of this sitting are as good as a check"
    p.work.planes_taken = Acquisition("Camera 1", *2 * [datetime.now().astimezone() - timedelta(hours=9)])
    assert primary(page) == ["Take 3 pictures"]
    p.check.use_folder(p.model.folder)
    assert primary(page) == ["Start live"], "it is being checked"
    measuring.finish(replace(check(), taken_at=datetime.now().astimezone()))
    assert primary(page) == ["Start live"]


def test_nothing_is_measured_checked_or_recorded_in_a_project_that_is_read_only(page, monkeypatch):
    p, card = page.presenter, page.check
    monkeypatch.setattr(type(p.model), "is_read_only", property(lambda _: True))
    page.refresh()
    said = "The project is read-only: go on in a copy (File, Save a copy)."
    assert p.cannot_measure == said
    for button in (page.live_panel.start, card.take, card.run):
        assert not button.isEnabled() and button.toolTip() == said
    p.live.start()
    p.check_live.start()
    assert not p.live.running and not p.check_live.running


def test_chosen_pictures_are_checked_at_once_and_can_be_given_up(chosen, qtbot):
    card = shown(chosen, qtbot, CheckStage.CHECKING)
    assert card.word.text() == "Checking …" and card.run.text() == "Cancel"
    qtbot.mouseClick(card.run, LEFT)
    shown(chosen, qtbot, CheckStage.CHOSEN)
    assert "check" not in chosen.presenter.model.results


@pytest.mark.parametrize(
    ("look", "word", "symbol", "todo"),
    [
        (check(0.4), "In order. A 50 mm step may be off by 0.05 mm.", "mdi6.check-circle-outline", "not seen"),
        (check(0.005, 0.3), "In doubt", "mdi6.alert-outline", "check again"),
        (check(1e-9, 1.5), "Changed", "mdi6.close-octagon-outline", "calibrate again"),
        (nowhere(), "Changed", "mdi6.close-octagon-outline", "calibrate again"),
    ],
    ids=["green", "amber", "red", "fan elsewhere"],
)
def test_the_light_is_a_word_and_an_icon_with_what_to_do(chosen, measuring, qtbot, look, word, symbol, todo):
    measuring.finish(look)
    card = shown(chosen, qtbot, CheckStage.CHECKED)
    assert card.word.text() == word
    assert card.sign.shown[0] == symbol and card.sign.accessibleName() == word
    assert todo in card.sentence.text()


def test_it_shows_how_far_off_and_what_could_be_overlooked(chosen, measuring, qtbot):
    measuring.finish(check())
    rows = shown(chosen, qtbot, CheckStage.CHECKED).rows
    assert rows.text_of("Stripes off by") == "0.050 px"
    assert rows.text_of("Stripes off on the target by") == "0.010 mm"
    assert rows.text_of("Step of 50 mm off by") == "+0.012 ± 0.050 mm"
    assert rows.text_of("Pictures") == "2 of 3"
    assert rows.isVisible()


def test_why_a_picture_says_nothing_stands_on_a_line_of_its_own(chosen, measuring, qtbot):
    measuring.finish(check(0.005))
    lines = shown(chosen, qtbot, CheckStage.CHECKED).sentence.text().splitlines()
    assert lines[0].startswith("Camera or laser may have changed")
    assert lines[1:] == ["1 × the target is not seen: c"]


def test_a_result_is_out_of_date_with_another_calibration_and_back_with_undo(chosen, measuring, qtbot):
    measuring.finish(check())
    shown(chosen, qtbot, CheckStage.CHECKED)
    model = chosen.presenter.model
    model.edit("accept", replace(model.project, accepted=Accepted("camera-1", "fan-2")))
    card = shown(chosen, qtbot, CheckStage.OUTDATED)
    assert card.word.text() == "Out of date" and "laser planes" in card.sentence.text()
    model.undo_stack.undo()
    shown(chosen, qtbot, CheckStage.CHECKED)
    model.undo_stack.undo()
    assert model.project.sources.check == "", "the choice of the pictures is undone"
    shown(chosen, qtbot, CheckStage.OUTDATED)


def test_pictures_that_say_nothing_are_told_and_the_result_before_stays(chosen, measuring, qtbot):
    measuring.finish(check())
    card = shown(chosen, qtbot, CheckStage.CHECKED)
    done = chosen.presenter.model.results["check"]
    qtbot.mouseClick(card.run, LEFT)
    measuring.fail(InputError("no picture shows target and stripes"))
    card = shown(chosen, qtbot, CheckStage.UNREADABLE)
    assert "no picture shows target and stripes" in card.sentence.text()
    assert chosen.presenter.model.results["check"] is done


def test_a_project_opened_again_shows_its_check(chosen, measuring, scan_bench, qtbot):
    measuring.finish(check())
    shown(chosen, qtbot, CheckStage.CHECKED)
    scan_bench.model.save()
    folder = scan_bench.model.folder
    (folder / "check").mkdir()
    write_check(folder / "check" / "check.json", check(0.005))
    scan_bench.model.close()
    scan_bench.model.open(folder)
    card = shown(chosen, qtbot, CheckStage.CHECKED)
    assert card.word.text() == "In doubt"


# ---- pictures taken now


@pytest.fixture
def lane(scan_bench):
    return cast(HandLane, scan_bench.live)


@pytest.fixture
def taking(page, lane, qtbot):
    """The live source shows the plane target."""
    qtbot.waitUntil(lambda: not page.presenter.bench.quick.busy)
    page.refresh()
    qtbot.mouseClick(page.check.take, LEFT)
    lane.current.reported.emit(LiveStarted("Camera 1", (64, 48)))
    return page


def seen(sentence):
    detail = PlanesDetail(
        0, np.array([[20.0, 20.0], [40.0, 20.0]]), (np.array([[10.0, 30.0], [50.0, 30.0]]),), (0,), plain(sentence),
        np.zeros((6, 8), bool), (), 1, True,
    )  # fmt: skip
    return LiveView(np.full((24, 32), 40, np.uint8), 2, 0, 12.0, 1, 0, detail)


def test_the_live_picture_shows_the_target_and_what_to_do(taking, lane):
    lane.current.view.emit(seen("Hold still."))
    taking.refresh()
    card = taking.check
    assert card.take.text() == "Stop" and card.word.text() == "1 poses taken · 12 frames/s"
    assert "Hold still." in card.sentence.text()
    assert {"target", "stripe 0"} <= set(taking.picture.image.layer_names())
    assert not card.choose.isEnabled() and "being taken" in card.choose.toolTip()
    assert "being taken" in card.run.toolTip() and not taking.live_panel.start.isEnabled()


def test_pictures_taken_are_checked_when_there_are_enough(taking, lane, measuring, qtbot):
    request = taking.presenter.check_live
    folder = taking.presenter.model.folder / "recordings" / "check-1"
    folder.mkdir(parents=True)
    (folder / "pose00.png").write_bytes(b"")
    assert request.running
    lane.finish(LiveEnded(folder, 1, 0))
    shown(taking, qtbot, CheckStage.CHECKING)
    assert taking.presenter.project.sources.check == "recordings/check-1"
    measuring.finish(check())
    shown(taking, qtbot, CheckStage.CHECKED)


def test_nothing_taken_checks_nothing(taking, lane, qtbot):
    lane.finish(LiveEnded(taking.presenter.model.folder / "recordings" / "check-1", 0, 0))
    shown(taking, qtbot, CheckStage.NONE)


def test_without_calibrations_there_is_nothing_to_check(page):
    model = page.presenter.model
    model.edit("forget", replace(model.project, accepted=Accepted()))
    page.refresh()
    assert not page.check.take.isEnabled() and "Accept camera and laser planes" in page.check.take.toolTip()


def test_the_scan_is_told_what_the_check_said(chosen, measuring, qtbot):
    assert chosen.presenter.live.check() is None
    look = check()
    measuring.finish(look)
    shown(chosen, qtbot, CheckStage.CHECKED)
    assert chosen.presenter.live.check() is look
    model = chosen.presenter.model
    model.edit("accept", replace(model.project, accepted=Accepted("camera-1", "fan-2")))
    assert chosen.presenter.live.check() is None, "a check of other calibrations says nothing of these"


# ---- the history


def with_history(page, measuring, qtbot, look, before):
    """The check is made; the rig has so many checks before it."""
    quick = cast(HandLane, page.presenter.bench.quick)
    quick.answers[jobs.CHECK_HISTORY] = lambda folder, project: chart(look, before)
    measuring.finish(look)
    qtbot.waitUntil(lambda: page.presenter.check.past is not None)
    return shown(page, qtbot, CheckStage.CHECKED)


def test_a_check_within_its_history_stays_green_and_is_charted(chosen, measuring, qtbot):
    card = with_history(chosen, measuring, qtbot, check(), 9)
    assert card.word.text().startswith("In order. ")
    assert card.chart.isVisible() and card.chart.axis_text("left") == "step off by [mm]"
    assert [card.rows.text_of(name) for name in ("Allowed from", "Allowed to")] == ["+0.005 mm", "+0.017 mm"]


def test_a_drift_that_the_pictures_alone_do_not_show_is_amber(chosen, measuring, qtbot):
    card = with_history(chosen, measuring, qtbot, replace(check(), error_mm=0.06), 9)
    assert card.word.text() == "In doubt" and card.sign.shown[0] == "mdi6.alert-outline"
    assert "the 9 checks before" in card.sentence.text()


@pytest.mark.parametrize(
    ("measured_mm", "due", "level"),
    [(50.004, None, "good"), (50.004, date(2026, 1, 31), "warn"), (50.04, None, "bad")],
    ids=["in order", "lapsed", "wrong"],
)
def test_artefacts_of_the_same_calibrations_are_shown_with_their_certificates(
    page, scan_bench, qtbot, measured_mm, due, level
):
    block = Artefact("GB 50-7", 50.0003, 0.0004, 2.0, "D-K-15070 2026-03", due)
    measured = ArtefactCheck(block, measured_mm, 0.009, TAKEN.date())
    cast(HandLane, scan_bench.quick).answers[jobs.ARTEFACT_CHECKS] = lambda folder, project: (measured,)
    page.presenter.opened()
    qtbot.waitUntil(lambda: page.presenter.artefacts.checks == (measured,))
    card = shown(page, qtbot, CheckStage.NONE)
    assert card.rows.isVisible(), "an artefact needs no pictures of the day"
    assert card.rows.text_of("GB 50-7, measured") == f"{measured_mm:.3f} ± 0.018 mm"
    assert card.rows.text_of("GB 50-7, certified") == "50.00030 ± 0.00040 mm"
    assert card.rows.text_of("GB 50-7, E_n") == f"{measured.e_n:.2f}"
    assert card.rows.text_of("GB 50-7, valid until") == ("2026-01-31" if due else "not stated")
    assert card.rows.text_of("GB 50-7, certificate") == "D-K-15070 2026-03"
    (verdict,) = (fact for fact in facts(None, None, [measured]) if fact.grade and fact.level == 1)
    assert verdict.grade == level


def charted_block(page, qtbot, count):
    """A block was measured so many times, once a day."""
    block = Artefact("GB 50-7", 50.0003, 0.0004, 2.0, "D-K-15070 2026-03")
    history = RigHistory("bench")
    for day in range(count):
        measured = ArtefactCheck(block, 50.004 + 0.001 * (day % 3), 0.009, TAKEN.date())
        taken = TAKEN + timedelta(days=day - count)
        history = history.added(PastCheck.of_measured(measured, taken, ("cal", f"frames {day}"), 20.5))
    charts = history.artefact_charts("cal")
    cast(HandLane, page.presenter.bench.quick).answers[jobs.ARTEFACT_CHARTS] = lambda folder, project: charts
    page.presenter.artefacts.opened()
    qtbot.waitUntil(lambda: page.presenter.artefacts.charts == charts)


def test_an_artefact_measured_several_times_is_charted_without_any_check_by_pictures(page, qtbot):
    charted_block(page, qtbot, 9)
    card = shown(page, qtbot, CheckStage.NONE)
    assert card.chart.isVisible() and card.chart.axis_text("left") == "artefact off by [mm]"
    assert card.charted.isHidden(), "there is nothing to choose"
    assert "E_n = 0.26" in card.chart._tip(2, 0) and "20.5 °C" in card.chart._tip(2, 0)


def test_of_pictures_and_artefacts_one_chart_is_chosen(chosen, measuring, qtbot):
    charted_block(chosen, qtbot, 9)
    card = with_history(chosen, measuring, qtbot, check(), 9)
    assert card.charted.isVisible() and card.chart.axis_text("left") == "step off by [mm]"
    card.charted.setCurrentIndex(1)
    card.charted.activated.emit(1)
    assert card.charted.currentText() == "GB 50-7" and card.chart.axis_text("left") == "artefact off by [mm]"
    chosen.refresh()
    assert card.charted.currentText() == "GB 50-7", "the choice stays"


def test_a_first_check_is_held_to_what_is_stated_without_a_chart(chosen, measuring, qtbot):
    card = with_history(chosen, measuring, qtbot, check(), 0)
    assert card.chart.isHidden()
    assert [card.rows.text_of(name) for name in ("Allowed from", "Allowed to")] == ["−0.117 mm", "+0.117 mm"]


def test_that_nobody_checked_today_stays_in_sight_while_it_is_scanned(page, lane, qtbot):
    qtbot.waitUntil(lambda: not page.presenter.bench.quick.busy)
    page.presenter.do_live()
    lane.current.reported.emit(LiveStarted("Camera 1", (64, 48)))
    others = (Check("focus", "unknown", plain("?")), Check("lines", "ok", plain("All lines.")))
    lane.current.reported.emit(LiveChecks((*others, rig_check(None, TAKEN))))
    page.presenter.live_stage = "scanning"
    page.refresh()
    (sentence,) = page.checks.sentences
    assert "not checked today" in sentence


def test_with_the_recording_of_a_set_comes_the_check_of_its_day(page, scan_folder, measuring, qtbot):
    p = page.presenter
    (scan_folder.parent / "check").mkdir()
    p.use_folder(scan_folder)
    shown(page, qtbot, CheckStage.CHECKING)
    assert p.check.folder == scan_folder.parent / "check"
    p.check.cancel()
    p.model.undo_stack.undo()
    assert p.check.folder is None and p.folder == scan_folder


# ---- re-adjustment


def proposal() -> ProposedReadjustment:
    """The picture has drifted by 2 px."""
    record = Readjustment(
        "cam-fan", TAKEN, "0123456789ab", {}, 3, np.array([0, 0, 0, 0, 0, 0, 2.0, 1.2, 0]), np.full(9, 0.01),
        np.ones(4), 1e-9, 0.4, np.zeros((1, 19)), ("readjusted",),
    )  # fmt: skip
    plane = LightPlane(np.array([0, 0, 0.002]))
    fan = FanCalibration(Fan((plane,)), Fan((plane,)), (0.0,), (), (), 0.0, None, None, (), readjusted=record)
    camera = Camera((64, 48), np.array([[50.0, 0, 32], [0, 50, 24], [0, 0, 1]]), np.zeros(5))
    known = CameraCalibration(camera, np.zeros((10, 10)), (), 0.1, 0.1, 1.0, 0.5, 0.01)
    return ProposedReadjustment(known, fan, (0.9, 0.03), (0.4, 0.01), 50.0, 0.323, 0.026)


def failed_check(page, measuring, qtbot):
    measuring.held.add(jobs.PROPOSE_READJUSTMENT)
    measuring.finish(check(1e-9, 1.5))
    return shown(page, qtbot, CheckStage.CHECKED)


def test_a_rig_that_passes_is_offered_no_readjustment(chosen, measuring, qtbot):
    measuring.finish(check())
    assert shown(chosen, qtbot, CheckStage.CHECKED).readjust.isHidden()


@pytest.mark.parametrize("answer", [0, 1], ids=["accepted", "rejected"])
def test_a_readjustment_is_explained_and_then_decided_and_undoable(chosen, measuring, qtbot, monkeypatch, answer):
    card, asked = failed_check(chosen, measuring, qtbot), []
    model = chosen.presenter.model
    before = model.project.accepted
    quick = cast(HandLane, chosen.presenter.bench.quick)
    quick.answers[jobs.ACCEPT_READJUSTMENT] = lambda *_: "fan-adjusted"
    monkeypatch.setattr(ask, "ask", lambda parent, title, text, answers: (asked.append(text), answer)[1])
    assert card.readjust.isVisible() and card.readjust.isEnabled()
    qtbot.mouseClick(card.readjust, LEFT)
    chosen.refresh()
    assert not card.readjust.isEnabled()
    measuring.finish(proposal())
    qtbot.waitUntil(lambda: not quick.busy)
    (text,) = asked
    assert "picture by 2.33 px" in text
    assert text.splitlines()[-3:] == [
        "Stripes off by, before: 0.900 px", "Stripes off by, after: 0.030 px",
        "Step of 50 mm larger by: +0.323 ± 0.052 mm",
    ], "as the command says it"  # fmt: skip
    if answer:
        assert model.project.accepted == before
        return
    assert model.project.accepted == replace(before, planes="fan-adjusted")
    shown(chosen, qtbot, CheckStage.OUTDATED)
    model.undo_stack.undo()
    assert model.project.accepted == before
    shown(chosen, qtbot, CheckStage.CHECKED)


def test_why_nothing_is_readjusted_is_said_on_the_card(chosen, measuring, qtbot):
    card = failed_check(chosen, measuring, qtbot)
    qtbot.mouseClick(card.readjust, LEFT)
    measuring.fail(InputError("nothing was re-adjusted: the target moved"))
    qtbot.waitUntil(lambda: "the target moved" in card.sentence.text())


def test_a_readjustment_is_given_up_with_its_project(chosen, measuring, qtbot, monkeypatch, tmp_path):
    card, asked = failed_check(chosen, measuring, qtbot), []
    monkeypatch.setattr(ask, "ask", lambda *_, **__: (asked.append(True), 1)[1])
    qtbot.mouseClick(card.readjust, LEFT)
    qtbot.waitUntil(lambda: measuring.busy)
    chosen.presenter.model.create(tmp_path / "next", new_project("next"))
    qtbot.waitUntil(lambda: not measuring.busy)
    assert not asked, "it is asked about in no other project"
