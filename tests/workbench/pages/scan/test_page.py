"""The scan page, clicked."""

from dataclasses import replace
from typing import cast

import numpy as np
import pytest
from numpy.testing import assert_allclose
from PySide6.QtCore import Qt

from core.errors import InputError
from core.files.pictures import write_picture
from core.files.project.data import Sources
from core.files.project.keys import finished
from core.findings.proof import OF_SCAN
from core.inspect.shown.view_frame import FrameKind
from core.messages import plain
from core.model import LightPlane
from core.pipeline.live.commands import Resume, Stop
from core.pipeline.live.events import LiveAnswered, LiveAsk, LiveChecks, LiveEnded, LiveStarted
from core.scan.preview.hints import ENOUGH
from core.scan.preview.preflight import Check
from tests.code import ROOT
from tests.workbench.hand_lane import HandLane
from tests.workbench.pages import scan_cases as cases
from tests.workbench.pages.places import moved, places
from workbench.pages.scan import overlays
from workbench.pages.scan.page import ScanPage
from workbench.pages.scan.picture import View
from workbench.pages.scan.presenter import ScanPresenter
from workbench.pages.scan.stage import Stage
from workbench.pages.whole import MeasuringAll
from workbench.views import ask
from workbench.work import jobs

STYLE = ROOT / "resources" / "style.qss"
LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def page(scan_bench, qtbot, monkeypatch):
    monkeypatch.setenv("TRISECT_NO_OPENGL", "none")
    made = ScanPage(ScanPresenter(scan_bench))
    made.presenter.opened()
    made._opened()
    qtbot.addWidget(made)
    made.resize(1100, 700)
    made.show()
    made.presenter.entered()
    return made


@pytest.fixture
def measuring(scan_bench):
    return cast(HandLane, scan_bench.measuring)


@pytest.fixture
def lane(scan_bench):
    return cast(HandLane, scan_bench.live)


@pytest.fixture
def recorded(page, scan_folder, qtbot):
    page.source.folder_chosen.emit(scan_folder)
    qtbot.waitUntil(lambda: page.presenter.scrub.up_to_date)
    return page


@pytest.fixture
def measured(recorded, measuring, qtbot):
    qtbot.mouseClick(recorded.card.buttons["run"], LEFT)
    measuring.finish(cases.summary())
    qtbot.waitUntil(lambda: recorded.presenter.work.look is not None)
    qtbot.waitUntil(lambda: recorded.presenter.scrub.up_to_date and not recorded.presenter.bench.quick.busy)
    return recorded


def start_live(page, lane, qtbot):
    qtbot.waitUntil(lambda: not page.presenter.bench.quick.busy)
    page.source.set_mode("live")
    qtbot.mouseClick(page.live_panel.start, LEFT)
    lane.current.reported.emit(LiveStarted("Camera 1", cases.SIZE))


def test_results_push_no_section(recorded, measuring, qtbot):
    before = places(recorded, qtbot)
    qtbot.mouseClick(recorded.card.buttons["run"], LEFT)
    assert not moved(before, places(recorded, qtbot))
    measuring.finish(cases.summary())
    qtbot.waitUntil(lambda: recorded.presenter.stage is Stage.MEASURED)
    assert not moved(before, places(recorded, qtbot))
    recorded.presenter.set_used([recorded.presenter.work.names[0]], False)
    assert recorded.presenter.stage is Stage.OUTDATED
    assert not moved(before, places(recorded, qtbot))
    bar = recorded.scrolled.verticalScrollBar()
    bar.setValue(bar.maximum())
    at_end = places(recorded, qtbot)
    qtbot.mouseClick(recorded.card.buttons["run"], LEFT)
    assert recorded.presenter.stage is Stage.MEASURING
    assert places(recorded, qtbot)["Settings"] == at_end["Settings"], "the result before stays"


def test_what_a_result_was_made_from_is_folded_as_its_project_is_opened(measured):
    assert measured.source_fold.isExpanded(), "it came while the page was in use"
    measured._opened()
    assert not measured.source_fold.isExpanded()


def test_how_good_the_scan_is_is_seen_without_scrolling(measured, qtbot):
    places(measured, qtbot)
    assert not measured.card.words.visibleRegion().isEmpty()
    assert "points, median σ 0." in measured.card.words.text()


# ---- the frame of the points


TABLE = LightPlane.from_normal([0.05, -0.1, 0.99], 640.0)


@pytest.fixture
def on_table(measured, scan_bench, qtbot):
    """The page with a scan whose thickness was measured while another page was shown."""
    p = measured.presenter
    p.left()
    cast(HandLane, scan_bench.quick).answers[jobs.SHOW_SCAN] = lambda folder: replace(cases.look(), ground=TABLE)
    p.model.record("gauge", replace(p.model.results["gauge"], key="another"))
    p.entered()
    qtbot.waitUntil(lambda: p.work.look.ground is not None)
    measured.refreshing.at_once()
    return measured


def test_without_a_thickness_the_points_are_in_the_cameras_frame(measured):
    assert measured.cloud.scene.frame.kind is FrameKind.CAMERA
    assert not measured.cloud.frame.action.isEnabled() and "Inspect" in measured.cloud.frame.action.toolTip()


def test_a_thickness_measured_since_stands_the_points_on_the_lower_face(on_table):
    scene = on_table.cloud.scene
    assert scene.frame.kind is FrameKind.GROUND
    points = on_table.presenter.work.look.points
    assert_allclose(scene.frame.coordinates(points)[:, 2], -TABLE.distances(points), atol=1e-9)


def test_a_page_entered_again_reads_nothing_twice(on_table, scan_bench, qtbot):
    quick = cast(HandLane, scan_bench.quick)
    read = quick.ran.count(jobs.SHOW_SCAN)
    on_table.presenter.left()
    on_table.presenter.entered()
    qtbot.waitUntil(lambda: not quick.busy)
    assert quick.ran.count(jobs.SHOW_SCAN) == read


def test_points_that_grow_are_in_the_cameras_frame_until_the_part_is_known(on_table, measuring, qtbot):
    quick = cast(HandLane, on_table.presenter.bench.quick)
    quick.answers[jobs.DISPLAY_PICTURE] = lambda *_: (np.full((24, 32), 70, np.uint8), 2)
    qtbot.mouseClick(on_table.card.buttons["run"], LEFT)
    measuring.current.reported.emit(cases.detail(0, renewed=True))
    qtbot.waitUntil(lambda: on_table.cloud.scene.state().points == 30)
    assert on_table.cloud.scene.frame.kind is FrameKind.CAMERA
    measuring.finish(cases.summary())
    qtbot.waitUntil(lambda: on_table.cloud.scene.state().points == 1500)
    assert on_table.cloud.scene.frame.kind is FrameKind.GROUND


def test_the_choice_of_the_frame_is_that_of_all_pages(on_table, qtbot):
    settings = on_table.presenter.bench.settings
    settings.part_frame = False
    assert on_table.cloud.scene.frame.kind is FrameKind.CAMERA and not on_table.cloud.frame.action.isChecked()
    qtbot.mouseClick(on_table.cloud.scene._buttons.widgetForAction(on_table.cloud.frame.action), LEFT)
    assert settings.part_frame and on_table.cloud.scene.frame.kind is FrameKind.GROUND


# ---- what is seen when


def test_an_empty_page_offers_to_start_where_a_live_source_is_chosen(page, lane, qtbot):
    start = page.picture.image.empty_state.button
    qtbot.waitUntil(lambda: not page.presenter.bench.quick.busy)
    assert page.source.mode == "live" and start.text() == "Start live"
    qtbot.mouseClick(start, LEFT)
    assert lane.current is not None and page.presenter.stage is Stage.LIVE


def test_the_next_part_of_a_series_measured_from_folders_begins_with_the_choice_of_a_folder(page, qtbot):
    model = page.presenter.model
    model.edit("series", replace(model.project, sources=Sources(camera="/set/camera", planes="/set/planes")))
    page._opened()
    assert page.source.mode == "folder"
    qtbot.waitUntil(lambda: page.picture.image.empty_state.button.text() == "Choose folder …")


def test_everything_can_be_measured_from_here_where_the_window_has_that(page, scan_folder, qtbot):
    run, whole, cancel = (page.card.buttons[name] for name in ("run", "whole", "cancel"))
    assert whole.isHidden() and cancel.isVisible(), "a page by itself"
    page.presenter.offer_whole(MeasuringAll(page.presenter.bench))
    page.presenter.changed.emit()
    qtbot.waitUntil(whole.isVisible)
    assert cancel.isHidden()
    assert not whole.isEnabled() and "Choose or record the pictures first" in whole.toolTip()
    page.source.folder_chosen.emit(scan_folder)
    qtbot.waitUntil(whole.isEnabled)
    lane = cast(HandLane, page.presenter.bench.measuring)
    lane.held = {jobs.MEASURE_ALL, jobs.WATCH_SCAN}
    qtbot.mouseClick(whole, LEFT)
    qtbot.waitUntil(lambda: not whole.isEnabled())
    assert [job for _, job, *_ in lane.waiting] == [jobs.MEASURE_ALL]
    assert whole.toolTip() == "Everything is being measured."
    lane.current.cancel()
    qtbot.waitUntil(whole.isEnabled)
    qtbot.mouseClick(run, LEFT)
    qtbot.waitUntil(cancel.isVisible)
    assert whole.isHidden() and cancel.isEnabled()


def test_an_empty_page_says_why_it_cannot_start(page, qtbot):
    start = page.picture.image.empty_state.button
    page.presenter.live.cannot_start = lambda: "There is no camera."
    page.presenter.live.changed.emit()
    qtbot.waitUntil(lambda: not start.isEnabled() and start.toolTip() == "There is no camera.")


def test_an_empty_page_says_what_to_do_next_and_offers_it(page, qtbot, monkeypatch, scan_folder):
    image = page.picture.image
    page.source.set_mode("folder")
    qtbot.waitUntil(lambda: image.empty_state.button.text() == "Choose folder …")
    assert "Record a scan with a live source" in image.empty_state.message
    assert page.card.title.text() == "No recording yet"
    assert page.below.isHidden() and page.result_fold.isHidden() and page.frames_fold.isHidden()
    assert page.live_panel.start.property("primary")
    monkeypatch.setattr(ask, "choose_folder", lambda *_: scan_folder)
    qtbot.mouseClick(image.empty_state.button, LEFT)
    qtbot.waitUntil(lambda: page.presenter.stage is Stage.RECORDED)


def test_greyed_buttons_say_why(page):
    for button in page.card.buttons.values():
        assert not button.isEnabled() and button.toolTip()


def test_a_recording_can_be_looked_through_before_it_is_measured(recorded):
    assert recorded.card.title.text() == "6 frames, not measured yet"
    assert recorded.card.buttons["run"].property("primary") and not recorded.live_panel.start.property("primary")
    assert recorded.source.detail.text() == "6 frames, with a reference"
    assert not recorded.bar.isHidden() and recorded.picture.image.has_picture
    assert recorded.bar.said.text() == "Frame 4 of 6 (frame0003.png): 3 crossings by itself; not measured yet."
    assert not recorded.bar.stages[View.POINTS].isEnabled()
    assert recorded.bar.stages[View.POINTS].toolTip() == "Measure the scan first."


def test_the_measured_scan_shows_its_quality_with_units_and_the_reasons_counted(measured):
    quality, reasons = measured.result.rows, measured.result.reasons
    assert quality.text_of("Points") == "1\u00a0500" and quality.text_of("Triangles") == "2\u00a0800"
    assert quality.text_of("Frames used") == "5 of 6"
    assert quality.text_of("Median σ") == "0.021 mm"
    assert quality.text_of("Covered of what was lit") == "63 %"
    assert reasons.text() == ("1 × its light plane is too uncertain for any point to pass the σ cut: frame0005.png")
    assert "relief" in measured.result.notes.text()
    assert measured.result_fold.isExpanded()
    assert not any(button.property("primary") for button in measured.card.buttons.values())


def test_a_change_of_the_rig_is_said_first_in_red_and_once(recorded, measuring, qtbot, monkeypatch):
    told = replace(cases.look(), notes=(*cases.look().notes, OF_SCAN["rig_changed"].note, OF_SCAN["rig_changed"].note))
    monkeypatch.setattr(recorded.presenter.work, "look", told)
    recorded.result.refresh()
    shown = recorded.result
    assert shown.alarm.text() == str(OF_SCAN["rig_changed"].note) and not shown.alarm.isHidden()
    assert f"QLabel#{shown.alarm.objectName()} {{ color: palette(bright-text); }}" in STYLE.read_text()
    assert shown.notes.text() == "The relief fixes the scale well."
    assert shown.layout().indexOf(shown.alarm) == 0


def test_a_scan_without_thickness_says_so(recorded, measuring, qtbot):
    qtbot.mouseClick(recorded.card.buttons["run"], LEFT)
    measuring.finish(cases.summary(gauge=None))
    qtbot.waitUntil(lambda: recorded.presenter.work.look is not None)
    assert "There are no two parallel faces" in recorded.result.notes.text()


def test_the_cloud_is_shown_in_3d_coloured_by_sigma_up_to_the_cut(measured):
    scene = measured.cloud.scene
    assert scene.state().points == 1500
    assert scene._scene.colouring.limits == (0.0, 0.05) and scene._scene.colouring.unit == "mm"


def test_a_failed_measurement_is_told_on_the_page(recorded, measuring, qtbot):
    recorded.refreshing.at_once()
    qtbot.mouseClick(recorded.card.buttons["run"], LEFT)
    measuring.fail(InputError("no sweep can be located"))
    recorded.refreshing.at_once()
    assert recorded.card.title.text() == "Not measured"
    assert "no sweep can be located" in recorded.card.words.text()
    assert recorded.card.buttons["run"].property("primary")


# ---- frames


def test_frames_are_listed_with_points_sigma_crossings_and_reasons(measured):
    rows = measured.frames.rows()
    assert [row.title for row in rows[:2]] == ["frame0000.png", "frame0001.png"]
    assert rows[1].text == "0.020 mm" and rows[1].reason == "200 points"
    assert rows[-1].text == "" and rows[-1].reason == cases.UNCERTAIN and rows[-1].used


def test_frames_in_sight_get_small_pictures_which_are_made_once(recorded, qtbot):
    quick, thumbnails = recorded.presenter.bench.quick, recorded.presenter.thumbnails
    recorded.resize(1100, 800)
    qtbot.waitUntil(lambda: len(thumbnails.pictures) >= 4)
    assert all(row.thumbnail is not None for row in recorded.frames.rows() if row.name in thumbnails.pictures)
    made = quick.ran.count(jobs.STRIPE_THUMBNAILS)
    recorded.frames.table.viewport().repaint()
    recorded.presenter.scrub.step(1)
    qtbot.waitUntil(lambda: not quick.busy)
    assert quick.ran.count(jobs.STRIPE_THUMBNAILS) == made
    recorded.presenter.use_folder(recorded.presenter.folder.parent)
    assert thumbnails.pictures == {}


def test_frames_out_of_sight_get_no_small_picture(page, qtbot, tmp_path):
    folder = tmp_path / "long" / "scan"
    folder.mkdir(parents=True)
    for number in range(60):
        write_picture(folder / f"frame{number:04d}.png", np.full(cases.SIZE[::-1], 40, np.uint8))
    page.presenter.use_folder(folder)
    qtbot.waitUntil(lambda: len(page.presenter.thumbnails.pictures) >= 3)
    qtbot.waitUntil(lambda: not page.presenter.bench.quick.busy)
    assert len(page.presenter.thumbnails.pictures) < 30
    page.frames.table.scrollToTop()
    qtbot.waitUntil(lambda: "scan/frame0000.png" in page.presenter.thumbnails.pictures)


def test_unchecking_a_frame_in_the_list_leaves_it_out_and_undo_lets_it_in(measured, qtbot):
    table = measured.frames.table
    table.scrollTo(measured.frames.model.index(1, 0))
    place = table.visualRect(measured.frames.model.index(1, 0))
    measured.refreshing.at_once()
    qtbot.mouseClick(table.viewport(), LEFT, pos=place.topLeft() + type(place.topLeft())(12, place.height() // 2))
    measured.refreshing.at_once()
    assert measured.presenter.project.options.excluded == {cases.name_of(1)}
    assert measured.card.title.text() == "Out of date"
    assert measured.card.words.text() == "Out of date: changed since: left-out frames. Measure again."
    assert measured.card.buttons["run"].text() == "Measure again" and measured.card.buttons["run"].property("primary")
    measured.presenter.model.undo_stack.undo()
    measured.refreshing.at_once()
    assert measured.frames.rows()[1].used and measured.card.title.text() == "Measured"


def test_the_box_by_the_slider_leaves_out_the_frame_that_is_shown(measured, qtbot):
    name = measured.presenter.scrub.current
    qtbot.mouseClick(measured.bar.used, LEFT, pos=measured.bar.used.rect().center().transposed() / 2)
    assert measured.presenter.project.options.excluded == {name}
    assert not measured.bar.used.isChecked()


def test_slider_buttons_list_and_arrows_go_through_the_frames_together(measured, qtbot):
    scrub = measured.presenter.scrub
    measured.bar.slider.setValue(0)
    measured.refreshing.at_once()
    assert scrub.index == 0 and not measured.bar.back.isEnabled()
    assert measured.bar.back.toolTip() == "It is the first frame." and "→" in measured.bar.on.toolTip()
    qtbot.mouseClick(measured.bar.on, LEFT)
    measured.refreshing.at_once()
    assert scrub.index == 1 and measured.frames.current() == cases.name_of(1)
    measured.picture.image.setFocus()
    qtbot.keyClick(measured.picture.image, Qt.Key.Key_Right)
    measured.refreshing.at_once()
    assert scrub.index == 2 and measured.bar.slider.value() == 2
    qtbot.keyClick(measured.picture.image, Qt.Key.Key_Left)
    measured.refreshing.at_once()
    assert scrub.index == 1
    measured.frames.table.setCurrentIndex(measured.frames.model.index(4, 0))
    measured.refreshing.at_once()
    assert scrub.index == 4
    qtbot.waitUntil(lambda: scrub.up_to_date)
    measured.refreshing.at_once()
    assert measured.bar.said.text().startswith(
        "Frame 5 of 6 (frame0004.png): 500 points, median σ 0.050 mm; 3 crossings"
    )


def test_arrows_pan_a_picture_that_is_not_shown_whole(measured, qtbot):
    image, scrub = measured.picture.image, measured.presenter.scrub
    image.one_to_one()
    before = scrub.index
    qtbot.keyClick(image, Qt.Key.Key_Right)
    assert scrub.index == before


@pytest.mark.parametrize(
    ("view", "layers"),
    [
        (View.RECORDED, set()),
        (View.DIFFERENCE, set()),
        (View.RIDGE, set()),
        (View.CENTRELINES, {"fan 1", "fan ?", "sweep"}),
        (View.CROSSINGS, {"fan 1", "fan ?", "sweep", "good", "weak", "left out"}),
        (View.POINTS, {"fan 1", "fan ?", "sweep", "points"}),
    ],
)
def test_every_stage_of_a_frame_can_be_seen(measured, qtbot, view, layers):
    qtbot.mouseClick(measured.bar.stages[view], LEFT)
    image = measured.picture.image
    assert set(image.layer_names()) == layers
    shown = {View.DIFFERENCE: 80, View.RIDGE: 120}.get(view, 40)
    assert image._picture.picture[0, 0] == shown


def test_known_planes_are_outlined_with_their_names_once_the_scan_is_measured(recorded, scan_bench, measuring, qtbot):
    corners = np.array([[4.0, 4.0], [40.0, 4.0], [40.0, 30.0], [4.0, 30.0]])
    cast(HandLane, scan_bench.quick).answers[jobs.SHOW_SCAN] = lambda folder: replace(
        cases.look(), known_planes={"plate": corners}
    )
    image = recorded.picture.image
    assert "known planes" not in image.layer_names()
    qtbot.mouseClick(recorded.card.buttons["run"], LEFT)
    measuring.finish(cases.summary())
    qtbot.waitUntil(lambda: "known planes" in image.layer_names())
    assert "known planes" in image.legend_titles
    assert [text for _, text, _ in image._layers["known planes"]._labels] == ["plate"]
    qtbot.mouseClick(recorded.bar.stages[View.RECORDED], LEFT)
    assert set(image.layer_names()) == {"known planes"}
    scan_bench.model.edit("other", replace(scan_bench.model.project, sources=Sources()))
    assert recorded.presenter.work.known_planes() == {}


def test_second_bounces_are_seen_as_such_and_listed(measured):
    image, (own, mirrored) = measured.picture.image, (cases.line(4, 30, 10.0), cases.line(34, 60, 14.0))
    overlays.show_swept(image, (own, mirrored), (1,))
    assert {"sweep", "second bounces"} <= set(image.layer_names())
    assert "second bounce, left out" in image.legend_titles
    overlays.show_swept(image, (own,), ())
    assert "second bounces" not in image.layer_names()


def test_a_crossing_says_on_hover_why_it_is_weak(measured, qtbot):
    layer = measured.picture.image._layers["weak"]
    assert layer.tip(0) == cases.WEAK


# ---- settings


def test_settings_are_changed_in_the_form_and_undone(measured, qtbot):
    form = measured.settings.form
    form.edited.emit("sigma_cut_mm", 0.2)
    qtbot.waitUntil(lambda: measured.presenter.project.options.sigma_cut_mm == 0.2)
    measured.refreshing.at_once()
    assert measured.card.title.text() == "Out of date"
    measured.presenter.model.undo_stack.undo()
    measured.refreshing.at_once()
    assert form.values()["sigma_cut_mm"] == 0.05


def test_stripe_settings_wait_for_the_tick_to_be_taken_away(measured, qtbot):
    form = measured.settings.form
    assert not form.editor("width_px").isEnabled() and "tick" in form.editor("width_px").toolTip()
    assert form.values()["width_px"] == 5.9
    form.edited.emit("automatic", False)
    qtbot.waitUntil(lambda: form.editor("width_px").isEnabled())
    assert measured.presenter.project.options.stripe.width_px == 5.9


def test_every_setting_has_a_line_of_help(page):
    for key in ("method", "sigma_cut_mm", "automatic", "width_px", "contrast"):
        assert page.settings.form.help_of(key).endswith(".")


# ---- while it is measured


def test_a_recording_that_is_measured_shows_frames_marks_gauges_and_a_growing_cloud(recorded, measuring, qtbot):
    quick = cast(HandLane, recorded.presenter.bench.quick)
    quick.answers[jobs.DISPLAY_PICTURE] = lambda *_: (np.full((24, 32), 70, np.uint8), 2)
    recorded.refreshing.at_once()
    qtbot.mouseClick(recorded.card.buttons["run"], LEFT)
    recorded.refreshing.at_once()
    assert recorded.bar.isHidden() and not recorded.running.isHidden()
    cancel = recorded.card.buttons["cancel"]
    recorded.refreshing.at_once()
    assert cancel.isEnabled() and not cancel.property("primary"), "to wait is what there is to do"
    assert recorded.running.hints._label.text() == "What could be better is said here."
    measuring.current.reported.emit(cases.detail(0, renewed=True, hints=("Tilt the laser more.",)))
    qtbot.waitUntil(lambda: recorded.picture.image._picture.picture[0, 0] == 70)
    recorded.refreshing.at_once()
    assert recorded.running.condition.value_text == "good" and recorded.running.speed.value_text == "1 px/frame · good"
    assert recorded.running.covered.text() == "covered 63 % of what was lit"
    assert recorded.running.hints.text == "Tilt the laser more."
    titles = recorded.picture.image.legend_titles
    recorded.refreshing.at_once()
    assert "sweep: σ 0 … 0.2 mm, else grey" in titles and "lit, no points yet" in titles
    for number in (1, 2):
        measuring.current.reported.emit(cases.detail(number))
    qtbot.waitUntil(lambda: recorded.cloud.scene.state().points == 90)
    measuring.current.reported.emit(cases.detail(3, renewed=True))
    qtbot.waitUntil(lambda: recorded.cloud.scene.state().points == 30)
    qtbot.waitUntil(lambda: recorded.frames.current() == cases.name_of(3))
    recorded.refreshing.at_once()
    assert recorded.frames.rows()[0].reason == "30 points in the preview"


def test_a_cancelled_measurement_shows_the_result_before_again(measured, measuring, qtbot):
    quick = cast(HandLane, measured.presenter.bench.quick)
    quick.answers[jobs.DISPLAY_PICTURE] = lambda *_: (np.full((24, 32), 70, np.uint8), 2)
    measured.refreshing.at_once()
    qtbot.mouseClick(measured.card.buttons["run"], LEFT)
    measured.refreshing.at_once()
    assert measured.cloud.scene.state().points == 1500
    measuring.current.reported.emit(cases.detail(0, renewed=True))
    qtbot.waitUntil(lambda: measured.cloud.scene.state().points == 30)
    measured.refreshing.at_once()
    qtbot.mouseClick(measured.card.buttons["cancel"], LEFT)
    measured.refreshing.at_once()
    assert measured.cloud.scene.state().points == 1500


def test_cancel_leaves_the_recording_as_it_was(recorded, measuring, qtbot):
    recorded.refreshing.at_once()
    qtbot.mouseClick(recorded.card.buttons["run"], LEFT)
    recorded.refreshing.at_once()
    qtbot.mouseClick(recorded.card.buttons["cancel"], LEFT)
    recorded.refreshing.at_once()
    assert recorded.presenter.stage is Stage.RECORDED and not measuring.busy
    assert not recorded.bar.isHidden()


# ---- live


def test_a_live_scan_goes_from_the_reference_to_the_result(page, lane, measuring, scan_folder, qtbot):
    start_live(page, lane, qtbot)
    lane.current.view.emit(cases.live_view(0, stage="reference"))
    page.refreshing.at_once()
    assert page.guide.sentence.text().startswith("Taking the reference") and page.card.isHidden()
    assert not page.takes_the_window and not page.side_panel.isHidden()
    lane.current.reported.emit(LiveAsk(plain("Switch the hand-held laser on, press Start."), "Start", Resume()))
    page.refreshing.at_once()
    assert (
        page.guide.go.text() == "Start" and page.guide.sentence.text() == "Switch the hand-held laser on, press Start."
    )
    assert page.strip.isHidden(), "what is asked is said once"
    qtbot.mouseClick(page.guide.go, LEFT)
    page.presenter.do_capture()
    page.refreshing.at_once()
    assert [type(sent) for sent in lane.sent[-2:]] == [Resume, Resume]
    lane.current.reported.emit(LiveAnswered())
    lane.current.view.emit(cases.live_view(1, renewed=True, condition=np.inf))
    page.refreshing.at_once()
    assert page.guide.go.text() == "Stop" and page.guide.covered.text() == "63 %"
    assert page.guide.counts.text() == "2 frames" and page.guide.needed.text() == "of 70 % needed"
    assert {"covered", "fan 3", "sweep", "good", "weak", "left out"} <= set(page.picture.image.layer_names())
    assert "2 frames recorded" in page.live_panel.counts.text()
    assert page.cloud.scene.state().points == 30
    assert lane.sent.count("shown") == 2
    lane.finish(LiveEnded(scan_folder, cases.FRAMES, 0))
    page.refreshing.at_once()
    assert page.card.title.text() == "Measuring the recording …"
    assert "by itself" in page.card.words.text()
    assert page.picture.image.has_picture and page.cloud.scene.state().points == 30
    measuring.finish(cases.summary())
    qtbot.waitUntil(lambda: page.presenter.stage is Stage.MEASURED and page.presenter.scrub.up_to_date)


def test_the_fan_s_lines_are_drawn_anew_when_they_have_changed_and_only_then(page, lane, qtbot):
    start_live(page, lane, qtbot)
    layers = page.picture.image._layers
    lane.current.view.emit(cases.live_view(0))
    fan, sweep = layers["fan 1"], layers["sweep"]
    lane.current.view.emit(cases.live_view(1))
    assert layers["fan 1"] is fan and layers["sweep"] is not sweep
    moved = cases.live_view(2)
    detail = replace(moved.detail, fan_lines=((cases.line(2, 62, 9.0),), *moved.detail.fan_lines[1:]))
    lane.current.view.emit(replace(moved, detail=detail))
    assert layers["fan 1"] is not fan
    lane.current.view.emit(replace(moved, detail=replace(moved.detail, fan_lines=((), (), ()))))
    assert not any(name.startswith("fan") for name in layers)


def test_checks_stand_there_until_the_scan_begins_and_those_that_failed_after_that(page, lane, qtbot):
    start_live(page, lane, qtbot)
    good, bad = Check("reference", "ok", plain("It holds.")), Check("lines", "failed", plain("Only 2 lines."))
    lane.current.reported.emit(LiveChecks((good, bad)))
    lane.current.view.emit(cases.live_view(0, stage="ready"))
    page.refreshing.at_once()
    assert page.checks.sentences == ("It holds.", "Only 2 lines.") and not page.checks.isHidden()
    lane.current.view.emit(cases.live_view(1))
    page.refreshing.at_once()
    assert page.checks.sentences == ("Only 2 lines.",)
    lane.current.reported.emit(LiveChecks((good,)))
    page.refreshing.at_once()
    assert page.checks.isHidden()


def test_while_paused_no_sweep_and_no_crossings_are_shown(page, lane, qtbot):
    start_live(page, lane, qtbot)
    lane.current.view.emit(cases.live_view(0))
    page.refreshing.at_once()
    assert "good" in page.picture.image.layer_names()
    lane.current.view.emit(cases.live_view(0, stage="paused"))
    page.refreshing.at_once()
    assert "good" not in page.picture.image.layer_names()


def test_while_frames_are_recorded_the_picture_has_the_page_and_nothing_else_is_asked(page, lane, qtbot):
    start_live(page, lane, qtbot)
    lane.current.view.emit(cases.live_view(0))
    page.refreshing.at_once()
    assert page.takes_the_window and page.side_panel.isHidden() and page.below.isHidden() and not page.guide.isHidden()
    assert page.picture.image.legend_titles == []
    qtbot.waitUntil(lambda: page.views.sizes()[0] > 1.5 * page.views.sizes()[1])
    qtbot.keyClick(page, Qt.Key.Key_X)
    assert page.views.sizes()[0] < page.views.sizes()[1]
    qtbot.keyClick(page, Qt.Key.Key_L)
    assert page.picture.image.legend_titles != []
    qtbot.keyClick(page, Qt.Key.Key_Space)
    assert isinstance(lane.sent[-1], Stop)
    page.refreshing.at_once()
    assert page.guide.sentence.text() == "Stopping …" and not page.guide.go.isEnabled()


def test_after_the_recording_the_page_is_as_it_was(page, lane, scan_folder, qtbot):
    start_live(page, lane, qtbot)
    lane.current.view.emit(cases.live_view(0))
    page.refreshing.at_once()
    lane.finish(LiveEnded(scan_folder, cases.FRAMES, 0))
    page.refreshing.at_once()
    assert not page.takes_the_window and not page.side_panel.isHidden() and page.guide.isHidden()
    qtbot.waitUntil(lambda: abs(page.views.sizes()[0] - page.views.sizes()[1]) < 50)
    sent = len(lane.sent)
    qtbot.keyClick(page, Qt.Key.Key_Space)
    assert len(lane.sent) == sent, "its keys are off"


def test_a_sound_says_once_that_enough_is_covered(page, lane, qtbot):
    start_live(page, lane, qtbot)
    sounds = []
    page.presenter.live.sounded.connect(lambda: sounds.append(1))
    for number, share in enumerate((0.5, ENOUGH, 0.8)):
        view = cases.live_view(number)
        lane.current.view.emit(replace(view, detail=replace(view.detail, share=share)))
    assert len(sounds) == 1


def test_without_calibrations_a_live_scan_shows_stripes_only(page, lane, qtbot):
    presenter = page.presenter
    presenter.model.edit("x", type(presenter.project)(presenter.project.info, presenter.project.rig))
    start_live(page, lane, qtbot)
    lane.current.view.emit(cases.live_view(0))
    page.picture.image.set_legend_visible(True)
    assert page.picture.image.legend_titles.count("sweep") == 1
    assert "good" not in page.picture.image.layer_names()
    assert "no points without accepted calibrations" in page.cloud.scene._message


def test_every_live_picture_is_answered_even_when_the_page_is_hidden(page, lane, qtbot):
    start_live(page, lane, qtbot)
    page.hide()
    lane.current.view.emit(cases.live_view(0))
    assert lane.sent[-1] == "shown"


def test_a_recording_that_ends_before_it_began_leaves_the_page_empty(page, lane, scan_folder, qtbot):
    start_live(page, lane, qtbot)
    lane.fail(InputError("there is no camera"))
    assert page.presenter.stage is Stage.NONE
    assert "Record a scan" in page.picture.image.empty_state.message


# ---- the two views


def test_each_view_can_have_all_the_room_and_give_it_back(recorded, qtbot):
    views = recorded.views
    title, _ = views._panes[1]
    qtbot.mouseDClick(title, LEFT)
    assert views.alone == 1 and not recorded.picture.isVisible() and recorded.cloud.isVisible()
    qtbot.mouseClick(title.button, LEFT)
    assert views.alone is None and recorded.picture.isVisible() and recorded.cloud.isVisible()


def test_an_empty_3d_view_says_what_to_do(page, recorded):
    assert recorded.cloud.scene._message == "Press Measure: the points will grow here."


def test_a_result_without_points_says_what_to_change(measured, scan_bench, measuring, qtbot):
    cast(HandLane, scan_bench.quick).answers[jobs.SHOW_SCAN] = lambda folder: cases.look(points=0)
    qtbot.mouseClick(measured.card.buttons["run"], LEFT)
    measuring.finish(cases.summary(gauge=None))
    qtbot.waitUntil(lambda: "larger σ" in measured.cloud.scene._message)


def test_a_result_whose_calibration_is_out_of_date_is_not_told_to_be_measured_again(measured):
    model = measured.presenter.model
    camera = finished("camera", measured.presenter.project, {})
    model.record("camera", replace(camera, rests_on={**camera.rests_on, "left-out views": "others"}))
    measured.refreshing.at_once()
    assert measured.card.words.text() == "Out of date, because this is: calibrate the camera."
