"""Decisions of the inspect page."""

from dataclasses import replace

import numpy as np
import pytest

from core.errors import InputError
from core.files.pictures import write_picture
from core.files.project.data import Accepted
from core.files.project.keys import finished
from core.inspect.results import PairCandidate
from core.inspect.uncertainty.part import MATERIALS, Part
from core.report.facts.of_repeats import repeat_facts
from tests.workbench.pages import inspect_cases as cases
from workbench.pages.inspect.part import MATERIAL_NAMES
from workbench.pages.inspect.presenter import RELIEF, InspectPresenter
from workbench.pages.inspect.stage import Stage
from workbench.pages.inspect.words import repeats_tsv
from workbench.work import jobs

TRIANGLE = np.array([[10.0, 10.0], [20.0, 10.0], [15.0, 20.0]])


@pytest.fixture
def measuring(measuring):
    measuring.held = {jobs.MEASURE_GAUGE}
    return measuring


@pytest.fixture
def quick(quick):
    quick.answers[jobs.OUTLINE_SELECTED] = lambda folder, numbers, face: TRIANGLE
    return quick


@pytest.fixture
def empty(hand_bench, measuring, quick, tmp_path):
    """An open project without a scan; the page is shown."""
    made = InspectPresenter(hand_bench)
    hand_bench.model.create(tmp_path / "project", cases.project(nominal_mm=50.0, tolerance_mm=0.2))
    made.entered()
    return made


def scanned(presenter, qtbot, *, inspected=True):
    for step, done in cases.results(presenter.project, inspected=inspected).items():
        presenter.model.record(step, done)
    qtbot.waitUntil(lambda: presenter.scan.view is not None and not presenter.scan.stale)


@pytest.fixture
def shown(empty, qtbot):
    """A scan with its thickness is shown."""
    scanned(empty, qtbot)
    return empty


@pytest.fixture
def unmeasured(empty, quick, qtbot):
    """A scan without a thickness is shown."""
    quick.answers[jobs.INSPECTION_VIEW] = lambda folder, project: cases.view()
    scanned(empty, qtbot, inspected=False)
    return empty


def undo(presenter):
    presenter.model.undo_stack.undo()


def warnings(presenter):
    return [notice.text for notice in presenter.bench.notices.all]


# ---- what is missing, what may come next


def test_without_a_scan_next_is_blocked_with_a_sentence(empty):
    assert empty.stage is Stage.NO_SCAN
    assert empty.blocker() == empty.cannot_measure == "Scan the part first."
    empty.do_run()
    assert not empty.bench.measuring.busy


def test_with_a_scan_one_may_go_on_without_a_thickness(unmeasured):
    assert unmeasured.stage is Stage.UNMEASURED
    assert unmeasured.blocker() == ""
    assert unmeasured.warning() == "Measure the thickness, or go on without one: then the report has none."


def test_a_finished_scan_is_read_when_the_page_is_first_shown(hand_bench, measuring, quick, tmp_path, qtbot):
    made = InspectPresenter(hand_bench)
    hand_bench.model.create(tmp_path / "project", cases.project())
    for step, done in cases.results(made.project).items():
        made.model.record(step, done)
    qtbot.wait(20)
    assert quick.ran == [] and made.stage is Stage.READING
    made.entered()
    qtbot.waitUntil(lambda: made.scan.view is not None)
    made.left()
    made.entered()
    qtbot.wait(20)
    assert quick.ran == [jobs.INSPECTION_VIEW]
    assert made.stage is Stage.MEASURED and made.warning() == ""


def test_a_scan_that_cannot_be_read_is_told_and_can_be_read_again(empty, quick, qtbot):
    def damaged(folder, project):
        raise InputError("this is no whole PLY file", where="cloud.ply")

    quick.answers[jobs.INSPECTION_VIEW] = damaged
    for step, done in cases.results(empty.project).items():
        empty.model.record(step, done)
    qtbot.waitUntil(lambda: empty.stage is Stage.UNREADABLE)
    assert empty.scan.problem == "cloud.ply: this is no whole PLY file."
    assert empty.cannot_measure == "The scan cannot be read."


def test_another_project_forgets_the_scan(shown, tmp_path):
    shown.model.create(tmp_path / "other", cases.project())
    assert shown.scan.view is None and shown.stage is Stage.NO_SCAN


# ---- measuring


def measured_again(presenter, measuring, qtbot):
    presenter.do_run()
    assert presenter.stage is Stage.MEASURING
    assert presenter.cannot_measure == "The thickness is being measured."
    measuring.finish(cases.gauge())
    qtbot.waitUntil(lambda: not presenter.scan.stale)


def test_measuring_records_the_thickness_and_shows_it(unmeasured, measuring, quick, qtbot):
    quick.answers[jobs.INSPECTION_VIEW] = lambda folder, project: cases.view(cases.gauge())
    told = []
    unmeasured.measured.connect(lambda: told.append(unmeasured.scan.gauge))
    measured_again(unmeasured, measuring, qtbot)
    done = unmeasured.model.results["gauge"]
    assert done.rests_on["scan"] == unmeasured.model.results["scan"].key
    assert unmeasured.stage is Stage.MEASURED
    assert [gauge.thickness_mm for gauge in told] == [50.012]


def test_between_measuring_and_reading_the_old_thickness_is_not_called_done(shown, measuring, qtbot):
    shown.do_run()
    measuring.finish(cases.gauge())
    assert shown.stage is Stage.READING
    assert shown.repeats.cannot_add
    qtbot.waitUntil(lambda: shown.stage is Stage.MEASURED)


def test_the_recording_that_was_measured_counts_whatever_is_chosen_now(shown, measuring, qtbot):
    sources = replace(shown.project.sources, scan="recordings/scan-2")
    shown.model.edit("choose", replace(shown.project, sources=sources))
    shown.do_run()
    _, _, args, _ = measuring.waiting[0]
    assert args[1].sources.scan == cases.RECORDING
    measuring.finish(cases.gauge())
    qtbot.waitUntil(lambda: not shown.bench.quick.busy)


def test_a_measurement_that_fails_says_why_until_something_changes(unmeasured, measuring):
    unmeasured.do_run()
    measuring.fail(InputError("among 1 plane faces no two are parallel", where="point cloud"))
    assert unmeasured.stage is Stage.FAILED
    assert "no two are parallel" in unmeasured.problem_of_measuring
    assert unmeasured.blocker() == "" and "surface only" in unmeasured.warning()
    unmeasured.faces.set_number("tolerance_mm", 0.1)
    assert unmeasured.stage is Stage.UNMEASURED


def test_a_cancelled_measurement_leaves_everything_as_it_was(shown, measuring):
    before = dict(shown.model.results)
    shown.do_run()
    measuring.cancel(measuring.current)
    assert shown.stage is Stage.MEASURED and dict(shown.model.results) == before


def test_no_old_value_stands_under_a_new_time_where_reading_the_new_one_was_cancelled(shown, quick, qtbot):
    quick.held = {jobs.INSPECTION_VIEW}
    model = shown.model
    model.record("gauge", finished("gauge", shown.project, model.results))
    assert shown.stage is Stage.READING
    quick.cancel(quick.current)
    assert shown.stage is Stage.READING, "the value shown is of the measurement before"
    quick.held = set()
    shown.entered()
    qtbot.waitUntil(lambda: shown.stage is Stage.MEASURED)


def test_a_measurement_of_a_project_that_was_closed_is_dropped(shown, measuring, tmp_path):
    shown.do_run()
    task, *_ = measuring.waiting[0]
    shown.model.create(tmp_path / "other", cases.project())
    measuring._end(task, lambda: task.done.emit(cases.gauge()))
    assert dict(shown.model.results) == {} and shown.stage is Stage.NO_SCAN


def test_a_changed_nominal_value_makes_the_thickness_out_of_date_and_undo_brings_it_back(shown):
    shown.faces.set_number("nominal_mm", 49.9)
    assert shown.stage is Stage.OUTDATED
    assert "nominal thickness" in shown.state.sentence
    assert shown.warning() == "Measure again, or the report prints the thickness as it was."
    undo(shown)
    assert shown.stage is Stage.MEASURED


def test_a_scan_that_is_out_of_date_itself_is_named_as_the_reason(shown):
    shown.model.edit("accept", replace(shown.project, accepted=Accepted("camera-2", "fan-2")))
    assert shown.stage is Stage.OUTDATED and "scan" in shown.state.sentence
    assert shown.warning() == "Measure the scan again first, on the page before."
    assert shown.repeats.cannot_add.startswith("The scan is out of date")
    undo(shown)
    assert shown.stage is Stage.MEASURED and shown.repeats.cannot_add == ""


# ---- nominal value and tolerance


def test_a_nominal_value_waits_for_its_tolerance(empty):
    empty.model.edit("none", replace(empty.project, rig=replace(empty.project.rig, gauge=None)))
    empty.faces.set_number("nominal_mm", 20.0)
    assert empty.project.rig.gauge is None
    assert empty.faces.values() == {"nominal_mm": 20.0, "tolerance_mm": None}
    assert empty.faces.complaint("tolerance_mm").startswith("Enter the tolerance too")
    assert empty.faces.complaint("nominal_mm") == ""
    empty.faces.set_number("tolerance_mm", 0.05)
    assert (empty.faces.spec.nominal_mm, empty.faces.spec.tolerance_mm) == (20.0, 0.05)
    assert empty.faces.complaint("tolerance_mm") == ""
    undo(empty)
    assert empty.project.rig.gauge is None and empty.faces.values()["nominal_mm"] is None


def test_clearing_both_measures_without_a_verdict(empty):
    empty.faces.set_number("tolerance_mm", None)
    assert empty.faces.complaint("tolerance_mm") and empty.faces.spec.tolerance_mm == 0.2
    empty.faces.set_number("nominal_mm", None)
    assert empty.project.rig.gauge is None
    undo(empty)
    assert empty.faces.spec.nominal_mm == 50.0


def test_a_tolerance_alone_asks_for_its_nominal_value(empty):
    empty.faces.set_number("nominal_mm", None)
    assert empty.faces.complaint("nominal_mm").startswith("Enter the nominal value too")


# ---- regions


def test_a_region_drawn_takes_the_other_face_as_it_was_found(shown):
    shown.faces.set_region("upper", TRIANGLE)
    spec = shown.faces.spec
    assert np.array_equal(spec.upper_polygon_px, TRIANGLE)
    assert np.array_equal(spec.lower_polygon_px, cases.LOWER_OUTLINE)
    assert shown.stage is Stage.OUTDATED and "thickness regions" in shown.state.sentence
    assert shown.model.undo_stack.undoText() == "draw the upper face"
    undo(shown)
    assert not shown.faces.own and shown.stage is Stage.MEASURED


def test_without_a_thickness_the_first_region_waits_for_the_second(unmeasured):
    unmeasured.faces.set_region("lower", TRIANGLE)
    assert unmeasured.faces.spec.lower_polygon_px is None
    assert np.array_equal(unmeasured.faces.region("lower"), TRIANGLE)
    assert unmeasured.cannot_measure == "Draw the upper face too, or let the faces be found automatically."
    unmeasured.do_run()
    assert not unmeasured.bench.measuring.busy
    unmeasured.faces.set_region("upper", TRIANGLE + 20)
    assert unmeasured.faces.own and unmeasured.cannot_measure == ""
    unmeasured.model.save()  # what is kept can be written


def test_a_waiting_region_can_be_given_up(unmeasured):
    unmeasured.faces.set_region("upper", TRIANGLE)
    assert unmeasured.cannot_measure.startswith("Draw the lower face too")
    assert unmeasured.faces.buttons.automatic == ""
    unmeasured.faces.find_automatically()
    assert unmeasured.faces.region("upper") is None and unmeasured.cannot_measure == ""


def test_faces_found_become_regions_and_go_again(shown):
    assert shown.faces.buttons.take_found == ""
    shown.faces.take_found()
    assert np.array_equal(shown.faces.region("upper"), cases.UPPER_OUTLINE)
    assert "already" in shown.faces.buttons.take_found
    shown.faces.set_region("lower", TRIANGLE)
    assert shown.model.undo_stack.undoText() == "change the lower face"
    shown.faces.find_automatically()
    assert not shown.faces.own and "automatically already" in shown.faces.buttons.automatic
    undo(shown)
    assert np.array_equal(shown.faces.region("lower"), TRIANGLE)
    undo(shown)
    assert np.array_equal(shown.faces.region("lower"), cases.LOWER_OUTLINE)


def test_one_of_several_pairs_of_faces_is_confirmed_and_that_is_undone(shown):
    corners = tuple(map(tuple, TRIANGLE)), tuple(map(tuple, cases.LOWER_OUTLINE))
    other = PairCandidate(20.04, (100, 200), (30.0, 20.0), (10.0, 10.0), corners)
    unknown = replace(other, outlines_px=((), ()))
    gauge = cases.gauge(candidates=(other, unknown))
    shown.scan.view = replace(shown.scan.view, gauge=gauge)
    assert shown.faces.candidates == (other,)
    shown.faces.confirm(other)
    assert shown.model.undo_stack.undoText() == "confirm the faces 20.0 mm apart"
    assert np.array_equal(shown.faces.region("upper"), TRIANGLE)
    assert np.array_equal(shown.faces.region("lower"), cases.LOWER_OUTLINE)
    assert shown.faces.candidates == ()
    undo(shown)
    assert not shown.faces.own and shown.faces.candidates == (other,)


def test_regions_can_be_exchanged(shown):
    shown.faces.take_found()
    shown.faces.exchange()
    assert np.array_equal(shown.faces.region("upper"), cases.LOWER_OUTLINE)
    undo(shown)
    assert np.array_equal(shown.faces.region("upper"), cases.UPPER_OUTLINE)


def test_a_region_of_two_corners_is_none(shown):
    shown.faces.set_region("upper", TRIANGLE[:2])
    assert not shown.faces.own


def test_nominal_value_and_regions_do_not_disturb_each_other(shown):
    shown.faces.take_found()
    shown.faces.set_number("tolerance_mm", 0.1)
    assert shown.faces.own and shown.faces.spec.tolerance_mm == 0.1
    shown.faces.find_automatically()
    assert shown.faces.spec.tolerance_mm == 0.1


def test_points_chosen_in_3d_become_the_outline_of_their_face(shown, quick, qtbot):
    asked = []
    quick.answers[jobs.OUTLINE_SELECTED] = lambda folder, numbers, face: asked.append((face, numbers)) or TRIANGLE
    chosen = np.zeros(400, bool)
    chosen[[3, 5]] = True
    shown.outline("upper", chosen)
    assert shown.outlining == "upper"
    qtbot.waitUntil(lambda: shown.faces.own)
    assert shown.outlining == ""
    assert asked[0][0] == "upper" and np.array_equal(asked[0][1], shown.scan.view.number[[3, 5]])
    assert np.array_equal(shown.faces.region("upper"), TRIANGLE)
    undo(shown)
    assert not shown.faces.own


def test_an_empty_choice_is_told(shown, quick):
    shown.outline("upper", np.zeros(400, bool))
    assert warnings(shown) == ["There are no points in that region."]
    assert shown.outlining == ""


def test_points_that_hold_no_face_are_told(shown, quick, qtbot):
    def refuse(folder, numbers, face):
        raise InputError("there is no plane face among the 3 chosen points", where="region")

    quick.answers[jobs.OUTLINE_SELECTED] = refuse
    shown.outline("lower", np.ones(3, bool))
    qtbot.waitUntil(lambda: shown.outlining == "")
    assert "no plane face" in warnings(shown)[0] and not shown.faces.own


# ---- what is shown


def test_the_view_is_cut_by_sigma_and_nothing_else_changes(shown):
    assert shown.points_shown() == cases.POINTS and shown.triangles_shown() == 2
    shown.clip(0.03)
    assert shown.points_shown() == np.count_nonzero(shown.scan.view.sigma <= np.float32(0.03))
    assert shown.triangles_shown() == 1
    assert shown.stage is Stage.MEASURED and not shown.model.undo_stack.canUndo()
    shown.clip(None)
    assert shown.points_shown() == cases.POINTS


def test_a_recorded_picture_is_read_when_it_is_chosen(shown, qtbot):
    folder = shown.model.folder / cases.RECORDING
    folder.mkdir(parents=True)
    write_picture(folder / "frame0001.png", np.full(cases.SIZE[::-1], 7, np.uint8))
    ready = []
    shown.picture_ready.connect(lambda name, picture: ready.append((name, int(picture[0, 0]))))
    shown.choose_picture(cases.PICTURES[2])
    qtbot.waitUntil(lambda: bool(ready))
    assert ready == [(cases.PICTURES[2], 7)]


def test_a_picture_that_is_gone_is_told_and_the_surface_shown(shown, qtbot):
    shown.choose_picture(cases.PICTURES[1])
    qtbot.waitUntil(lambda: shown.picture == RELIEF)
    assert len(warnings(shown)) == 1


# ---- points and distances


def test_picked_points_say_where_how_sure_and_in_which_frame(shown):
    shown.picks.start("point")
    shown.picks.pick(4)
    pick = shown.picks.items[0]
    assert pick.name == "P1" and np.array_equal(pick.place, shown.scan.view.points[4])
    assert pick.sigma_mm == pytest.approx(float(shown.scan.view.sigma[4]))
    assert pick.frame == cases.PICTURES[1]
    assert pick.uv == pytest.approx(tuple(shown.scan.view.uv[4]))


def test_two_clicks_make_a_distance(shown):
    picks = shown.picks
    picks.start("distance")
    assert picks.hint() == "Click the first end of the distance."
    picks.pick(0)
    assert picks.hint() == "Click the second end of the distance."
    picks.pick(0)  # a double click
    assert picks.items == []
    picks.pick(1)
    span = picks.items[0]
    between = shown.scan.view.points[1] - shown.scan.view.points[0]
    assert span.name == "D1" and span.result.distance_mm == pytest.approx(np.linalg.norm(between))
    assert 0 < span.result.u_mm < 0.03
    assert picks.first is None and picks.mode == "distance"


def test_the_list_can_be_shortened_and_emptied_and_is_no_edit(shown):
    shown.picks.start("point")
    for point in (1, 2, 3):
        shown.picks.pick(point)
    shown.picks.remove("P2")
    assert [item.name for item in shown.picks.items] == ["P1", "P3"]
    shown.picks.clear()
    assert shown.picks.items == [] and shown.picks.mode == ""
    assert not shown.model.undo_stack.canUndo()


def test_picks_stay_with_a_new_thickness_and_go_with_a_new_scan(shown, measuring, qtbot):
    shown.picks.start("point")
    shown.picks.pick(1)
    measured_again(shown, measuring, qtbot)
    assert len(shown.picks.items) == 1
    other = replace(shown.project, sources=replace(shown.project.sources, scan="recordings/scan-2"))
    shown.model.edit("another scan", other)
    shown.model.record("scan", finished("scan", other, {}))
    qtbot.waitUntil(lambda: not shown.scan.stale)
    assert shown.picks.items == []


def test_leaving_the_page_ends_picking(shown):
    shown.picks.start("point")
    shown.left()
    assert shown.picks.mode == ""


# ---- repeats


def with_repeats(presenter, *repeats):
    presenter.model.edit("repeats", replace(presenter.project, repeats=repeats))


def test_a_scan_is_added_once(shown):
    assert shown.repeats.cannot_add == ""
    shown.repeats.add()
    repeat = shown.project.repeats[0]
    assert (repeat.scan, repeat.thickness_mm, repeat.U_mm) == (cases.RECORDING, 50.012, 0.024)
    assert repeat.calibration_id == "cal-1" and repeat.measured_at == cases.AT
    shown.repeats.add()
    assert len(shown.project.repeats) == 1
    assert warnings(shown)[0].startswith("This scan is among the repeats already. A repeat is another scan of the part")
    undo(shown)
    assert shown.project.repeats == ()


def test_an_out_of_date_thickness_is_not_added(shown):
    shown.faces.set_number("nominal_mm", 49.0)
    assert shown.repeats.cannot_add == "The thickness is out of date; measure it again."
    shown.repeats.add()
    assert shown.project.repeats == ()


def test_without_a_thickness_there_is_nothing_to_add(unmeasured):
    assert unmeasured.repeats.cannot_add == "Measure the thickness first."


def test_removing_a_repeat_is_undone(shown):
    with_repeats(shown, cases.repeat(2, 50.0), cases.repeat(3, 50.1), cases.repeat(4, 50.2))
    shown.repeats.remove([1])
    assert [repeat.scan[-1] for repeat in shown.project.repeats] == ["2", "4"]
    undo(shown)
    assert [repeat.scan[-1] for repeat in shown.project.repeats] == ["2", "3", "4"]


def test_the_series_has_its_statistics(shown):
    assert shown.repeats.statistics() is None
    with_repeats(shown, cases.repeat(2, 50.0), cases.repeat(3, 50.1, calibration="cal-2"))
    statistics = shown.repeats.statistics()
    assert statistics.mean_mm == pytest.approx(50.05) and statistics.largest_error_mm == pytest.approx(0.1)
    assert shown.repeats.calibrations() == 2


def test_the_series_is_copied_with_all_digits(shown):
    with_repeats(shown, cases.repeat(2, 50.0123456), cases.repeat(3, 50.1))
    facts = repeat_facts(shown.repeats.statistics(), nominal=50.0)
    lines = repeats_tsv(shown.repeats.all, facts).splitlines()
    assert lines[0].split("\t")[:3] == ["scan", "thickness [mm]", "U [mm]"]
    assert lines[1].split("\t")[:2] == ["recordings/scan-2", "50.012346"]
    assert lines[1].split("\t")[5].startswith("2025-03-04T10:30:00")
    assert [line.split("\t")[0] for line in lines[4:]] == [
        "repeats", "mean [mm]", "s (n − 1) [mm]", "nominal [mm]", "bias [mm]", "largest error [mm]", "RMSE [mm]",
    ]  # fmt: skip
    assert lines[5].split("\t")[1] == "50.056173", "all its digits"


def put_repeats(presenter, values):
    repeats = tuple(cases.repeat(number, value) for number, value in enumerate(values, 2))
    presenter.model.edit("repeats", replace(presenter.project, repeats=repeats))


# ---- the part


def test_what_is_known_of_the_part_makes_the_thickness_out_of_date_and_is_undone(shown, qtbot):
    assert shown.part.values()["material"] == "" and shown.part.values()["celsius"] is None
    shown.part.set_value("material", "steel")
    assert shown.part.part.material == "steel"
    assert shown.stage is Stage.OUTDATED
    undo(shown)
    assert shown.part.part == Part()


def test_an_estimate_and_its_uncertainty_come_and_go_together(empty):
    empty.part.set_value("u_celsius", 0.3)
    assert (empty.part.part.celsius, empty.part.part.u_celsius) == (20.0, 0.3)
    undo(empty)
    empty.part.set_value("celsius", 21.5)
    assert (empty.part.part.celsius, empty.part.part.u_celsius) == (21.5, 0.5)
    empty.part.set_value("u_celsius", 0.3)
    empty.part.set_value("celsius", 22.0)
    assert (empty.part.part.celsius, empty.part.part.u_celsius) == (22.0, 0.3)
    empty.part.set_value("u_celsius", None)
    assert empty.part.part == Part()


def test_every_material_has_a_name_in_the_window():
    assert MATERIAL_NAMES.keys() == MATERIALS.keys()
