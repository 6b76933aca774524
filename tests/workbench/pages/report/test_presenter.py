"""What the report page decides, with drawings that come when the test says so."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from PySide6.QtWidgets import QApplication

from core.errors import InputError
from core.files.project.data import KeptStudy, Project, Repeat, new_project
from core.files.project.keys import finished
from core.files.project.view_file import read_view, write_view
from core.files.results.export_list import exports
from core.inspect.plan.feature_spec import Deviation, FeatureSpec, Section
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.shown.seen_from import SeenFrom
from core.messages import plain
from core.translations import PSEUDO, language
from tests.workbench.hand_lane import HandLane
from workbench.bench import Bench
from workbench.language import choose
from workbench.pages.report import presenter
from workbench.pages.report.presenter import ReportPresenter
from workbench.pages.report.stage import Stage
from workbench.step_state import State
from workbench.work import jobs

PAGES = (np.full((14, 10, 3), 250, np.uint8),)


class Drawing:
    """The quick lane, whose drawings the test finishes; the measuring lane answers at once."""

    def __init__(self, bench: Bench) -> None:
        self.lane = cast(HandLane, bench.quick)
        self.lane.held = {jobs.PREVIEW_REPORT}
        self.measuring = cast(HandLane, bench.measuring)
        self.made: list[Project] = []
        self.exported: list[tuple[str, Path]] = []
        self.in_camera_frame: list[bool] = []
        self.measuring.answers[jobs.MAKE_REPORT] = self._make
        self.measuring.answers[jobs.EXPORT] = self._export

    @property
    def asked(self) -> int:
        """How many drawings wait."""
        return len(self.lane.waiting)

    def done(self, pages: Any = PAGES) -> None:
        self.lane.finish(pages)

    def _make(self, folder: Path, project: Project) -> Path:
        self.made.append(project)
        return folder / "results" / "report.pdf"

    def _export(self, _folder: Path, _project: Project, kind: str, path: Path, in_camera_frame: bool) -> Path:
        self.exported.append((kind, path))
        self.in_camera_frame.append(in_camera_frame)
        return path


@pytest.fixture
def drawing(hand_bench: Bench) -> Drawing:
    return Drawing(hand_bench)


@pytest.fixture
def report(hand_bench: Bench, drawing: Drawing, tmp_path: Path) -> ReportPresenter:
    """An open project without any result."""
    made = ReportPresenter(hand_bench)
    hand_bench.model.create(tmp_path / "project", new_project("Block"))
    return made


@pytest.fixture
def shown(report: ReportPresenter, drawing: Drawing) -> ReportPresenter:
    """A measured project; its pages are drawn and looked at."""
    measured(report)
    report.entered()
    drawing.done()
    assert report.pages is PAGES
    return report


def measured(report: ReportPresenter, *steps: str) -> None:
    for step in steps or ("camera", "planes", "scan", "gauge"):
        report.model.record(step, finished(step, report.project, report.model.results))


def with_info(report: ReportPresenter, **fields: Any) -> None:
    report.model.edit("change", replace(report.project, info=replace(report.project.info, **fields)))


# ---- how far it is


def test_without_a_scan_there_is_nothing_to_report(report: ReportPresenter, drawing: Drawing) -> None:
    report.entered()
    assert report.stage is Stage.NONE
    assert report.blocker() == "Scan the part first; then there is something to report."
    assert drawing.asked == 0
    report.do_run()
    assert not drawing.measuring.busy
    assert all(report.export_missing(kind) for kind in ("pdf", "cloud", "mesh", "stl", "csv", "json"))


def test_making_the_report_records_it_and_any_change_puts_it_out_of_date(
    shown: ReportPresenter, drawing: Drawing, qtbot: Any
) -> None:
    assert (shown.stage, shown.state.state) == (Stage.READY, State.READY)
    shown.do_run()
    stages = [shown.stage]
    assert shown.why_not_make() == "The report is being made."
    shown.do_run()
    qtbot.waitUntil(lambda: not drawing.measuring.busy)
    stages.append(shown.stage)
    assert len(drawing.made) == 1, "pressed twice, made once"
    with_info(shown, customer="Somebody")
    stages.append(shown.stage)
    assert shown.state.sentence == "Out of date: changed since: project fields."
    shown.model.undo_stack.undo()
    stages.append(shown.stage)
    assert stages == [Stage.MAKING, Stage.MADE, Stage.OUTDATED, Stage.MADE]


def test_what_changes_while_the_report_is_made_puts_it_out_of_date(
    shown: ReportPresenter, drawing: Drawing, qtbot: Any
) -> None:
    shown.do_run()
    with_info(shown, customer="Somebody")
    qtbot.waitUntil(lambda: not drawing.measuring.busy)
    assert shown.stage is Stage.OUTDATED


def test_a_report_of_a_project_that_was_left_is_not_recorded_in_the_next(
    shown: ReportPresenter, drawing: Drawing, tmp_path: Path, qtbot: Any
) -> None:
    shown.do_run()
    shown.model.create(tmp_path / "next", new_project("Next"))
    qtbot.waitUntil(lambda: not drawing.measuring.busy)
    assert dict(shown.model.results) == {}
    assert shown.stage is Stage.NONE


@pytest.mark.parametrize("end", ["fail", "cancel"])
def test_a_report_that_is_not_made_can_be_made_again(shown: ReportPresenter, drawing: Drawing, end: str) -> None:
    drawing.measuring.held = {jobs.MAKE_REPORT}
    shown.do_run()
    if end == "fail":
        drawing.measuring.fail(InputError("cannot be written, because the disk is full", where="report.pdf"))
    else:
        drawing.measuring.cancel_all()
    assert shown.stage is Stage.READY
    assert shown.why_not_make() == ""


def test_a_scan_out_of_date_is_told_beside_the_report(shown: ReportPresenter) -> None:
    assert shown.warning() == ""
    options = replace(shown.project.options, sigma_cut_mm=0.2)
    shown.model.edit("cut", replace(shown.project, options=options))
    assert shown.warning().startswith("Scan: Out of date: changed since: scan settings.")


# ---- what is in it


def test_each_choice_is_one_edit_that_can_be_undone(report: ReportPresenter) -> None:
    report.choose_section("maps", False)
    report.choose_paper("Letter")
    assert report.project.report.hidden == {"maps"}
    assert str(report.project.report.paper) == "Letter"
    assert report.model.undo_stack.undoText() == "print on Letter"
    report.model.undo_stack.undo()
    assert report.project.report.paper == "A4"
    assert report.model.undo_stack.undoText().startswith("leave out “Residuals")
    report.model.undo_stack.undo()
    assert report.project.report.hidden == frozenset()
    report.choose_section("maps", True)
    assert report.model.undo_stack.canRedo(), "nothing was changed"


def test_sections_with_nothing_to_print_say_why(report: ReportPresenter) -> None:
    empty = {name for name, _, _ in report.sections() if report.empty_section(name)}
    assert empty == {"repeats", "studies", "remarks", "budget", "sections", "deviation", "view"}
    at = finished("scan", report.project, {}).at
    repeats, study = (
        (Repeat("a", 50.0, 0.02, 2.0, "c", at),),
        KeptStudy("c0ffee", "grr", plain("3 parts"), included=False),
    )
    report.model.edit("add", replace(report.project, repeats=repeats, studies=(study,)))
    assert "ticked" in report.empty_section("studies")
    report.model.edit("tick", replace(report.project, studies=(replace(study, included=True),)))
    with_info(report, notes="A remark")
    measured(report, "scan", "gauge")
    nominal = FeatureSpec("nominal", "deviation", deviation=Deviation("part.stl", tolerance_mm=0.1))
    profile = FeatureSpec("profile", "section", section=Section(((0.0, 0.0), (9.0, 0.0))))
    plan = InspectionPlan((nominal, profile))
    report.model.edit("features", replace(report.project, inspection=plan))
    assert report.model.folder is not None
    write_view(report.model.folder, SeenFrom(np.eye(3), np.zeros(3), 50.0, 1.5), "")
    report.entered()
    assert not any(report.empty_section(name) for name, _, _ in report.sections())


# ---- preview


def test_pages_are_drawn_when_somebody_looks_and_not_again_for_nothing(
    report: ReportPresenter, drawing: Drawing
) -> None:
    measured(report)
    assert drawing.asked == 0
    report.entered()
    assert (drawing.asked, report.drawing) == (1, True)
    drawing.done()
    report.left()
    report.entered()
    assert (drawing.asked, report.drawing) == (0, False)


@pytest.mark.parametrize("what", ["field", "section", "paper", "lines", "scan", "gauge", "view"])
def test_everything_that_is_printed_is_drawn_anew_and_the_old_pages_stay_meanwhile(
    shown: ReportPresenter, drawing: Drawing, what: str
) -> None:
    if what == "field":
        with_info(shown, operator="Somebody else")
    elif what == "section":
        shown.choose_section("frame", False)
    elif what == "paper":
        shown.choose_paper("Letter")
    elif what == "view":
        assert shown.model.folder is not None
        shown.left()
        write_view(shown.model.folder, SeenFrom(np.eye(3), np.zeros(3), 50.0, 1.5), "")
        shown.entered()
    elif what == "lines":
        shown.model.edit("lines", replace(shown.project, rig=replace(shown.project.rig, lines=2)))
    else:
        measured(shown, what)  # measured again: the project is the same, the result is not
    state = [(shown.drawing, len(shown.pages))]
    drawing.done(PAGES * 2)
    assert [*state, (shown.drawing, len(shown.pages))] == [(True, 1), (False, 2)]


def test_the_view_left_in_3d_is_not_read_at_each_key(shown: ReportPresenter, monkeypatch: pytest.MonkeyPatch) -> None:
    folder, read = shown.model.folder, []
    assert folder is not None

    def reading(folder: Path) -> SeenFrom | None:
        read.append(folder)
        return read_view(folder)

    write_view(folder, SeenFrom(np.eye(3), np.zeros(3), 50.0, 1.5), "")
    monkeypatch.setattr(presenter, "read_view", reading)
    with_info(shown, notes="A remark")
    with_info(shown, notes="A remark of more words")
    assert shown.empty_section("view") and len(read) == 0
    measured(shown, "scan")  # another part may have been measured
    assert (shown.empty_section("view"), len(read)) == ("", 1)
    shown.left()
    shown.entered()
    assert len(read) == 2


def test_what_is_not_printed_is_not_drawn(shown: ReportPresenter) -> None:
    options = replace(shown.project.options, excluded=frozenset({"camera/view00.png"}))
    shown.model.edit("leave out", replace(shown.project, options=options))
    assert not shown.drawing


def test_many_changes_in_a_row_are_drawn_once_more_not_once_each(shown: ReportPresenter, drawing: Drawing) -> None:
    for name in ("A", "B", "C"):
        with_info(shown, operator=name)
    assert drawing.asked == 1
    drawing.done()
    assert (drawing.asked, shown.drawing) == (1, True), "the last state, once"
    drawing.done()
    assert (drawing.asked, shown.drawing) == (0, False)


def test_pages_of_a_project_that_was_left_are_not_shown(
    shown: ReportPresenter, drawing: Drawing, tmp_path: Path
) -> None:
    with_info(shown, operator="Somebody else")
    shown.model.create(tmp_path / "next", new_project("Next"))
    assert shown.pages == ()
    drawing.done()
    assert (shown.pages, shown.drawing) == ((), False)


def test_why_nothing_can_be_drawn_is_told_in_place_of_the_pages(shown: ReportPresenter, drawing: Drawing) -> None:
    with_info(shown, operator="Somebody else")
    drawing.lane.fail(InputError("the file is missing", where="cloud.ply", todo="measure the scan again"))
    assert shown.pages == ()
    assert shown.problem == "cloud.ply: the file is missing; measure the scan again."
    assert not shown.drawing


def test_features_that_have_changed_since_are_told(shown: ReportPresenter) -> None:
    plan = InspectionPlan((FeatureSpec("top", "plane"),))
    shown.model.edit("add", replace(shown.project, inspection=plan))
    measured(shown, "camera", "planes", "scan", "gauge", "inspection")
    assert not shown.warning()
    shown.model.edit("remove", replace(shown.project, inspection=InspectionPlan()))
    assert "prints what was measured then" in shown.warning()


# ---- how it looks


def test_the_language_is_chosen_and_taken_back(shown: ReportPresenter) -> None:
    shown.choose_language("de")
    assert shown.project.report.language == "de"
    shown.model.undo_stack.undo()
    assert shown.project.report.language == ""


@pytest.mark.parametrize(("window_speaks", "printed"), [("de", "de"), ("zh_CN", "zh_CN"), (PSEUDO, "en")])
def test_a_report_is_in_the_windows_language_unless_the_project_states_one(
    report: ReportPresenter, drawing: Drawing, qtbot: Any, window_speaks: str, printed: str
) -> None:
    measured(report)
    app = QApplication.instance()
    assert app is not None
    choose(language(window_speaks), app)
    try:
        report.do_run()
        qtbot.waitUntil(lambda: len(drawing.made) == 1)
        report.choose_language("en")
        report.do_run()
        qtbot.waitUntil(lambda: len(drawing.made) == 2)
    finally:
        choose(language("en"), app)
    assert [project.report.language for project in drawing.made] == [printed, "en"]


def test_a_template_brings_what_it_names_and_is_put_away_again(
    shown: ReportPresenter, drawing: Drawing, tmp_path: Path, qtbot: Any
) -> None:
    drawing.lane.held = set()
    drawing.lane.answers[jobs.PREVIEW_REPORT] = lambda folder, project, width: PAGES
    path = tmp_path / "project" / "house.toml"
    path.write_text('name = "Laboratory"\npaper = "Letter"\nlanguage = "de"\n', encoding="utf-8")
    shown.choose_template(path)
    qtbot.waitUntil(lambda: shown.project.report.template == "house.toml")
    assert (shown.project.report.paper, shown.project.report.language) == ("Letter", "de")
    shown.choose_template(None)
    qtbot.waitUntil(lambda: shown.project.report.template == "")
    shown.model.undo_stack.undo()
    shown.model.undo_stack.undo()
    assert (shown.project.report.template, shown.project.report.paper) == ("", "A4")


def test_a_template_that_cannot_be_read_is_told_and_changes_nothing(
    shown: ReportPresenter, drawing: Drawing, tmp_path: Path, qtbot: Any
) -> None:
    drawing.lane.held = set()
    drawing.lane.answers[jobs.PREVIEW_REPORT] = lambda folder, project, width: PAGES
    before = shown.project
    shown.choose_template(tmp_path / "missing.toml")
    qtbot.waitUntil(lambda: bool(shown.bench.notices.all))
    assert "missing.toml" in shown.bench.notices.all[-1].text and shown.project == before


# ---- hand over


@pytest.mark.parametrize(
    ("kind", "name"),
    [
        ("cloud", "Block.ply"),
        ("mesh", "Block surface.ply"),
        ("stl", "Block.stl"),
        ("csv", "Block.csv"),
        ("qif", "Block results.qif"),
    ],
)
def test_a_copy_is_written_where_it_is_wanted_and_the_next_is_proposed_there(
    shown: ReportPresenter, drawing: Drawing, tmp_path: Path, qtbot: Any, kind: str, name: str
) -> None:
    assert shown.export_place(kind) == tmp_path / "project" / name
    (tmp_path / "out").mkdir()
    shown.export(kind, tmp_path / "out" / "mine")
    qtbot.waitUntil(lambda: not drawing.measuring.busy)
    ((exported, path),) = drawing.exported
    assert (exported, path.name) == (kind, f"mine{Path(name).suffix}"), "the ending is added"
    assert shown.export_place("stl").parent == tmp_path / "out"
    assert "Written: " in shown.bench.notices.all[-1].text


def test_the_pdf_is_made_first_where_it_is_not_up_to_date(
    shown: ReportPresenter, drawing: Drawing, tmp_path: Path, qtbot: Any
) -> None:
    shown.export("pdf", tmp_path / "a.pdf")
    qtbot.waitUntil(lambda: bool(drawing.exported) and not drawing.measuring.busy)
    assert (len(drawing.made), drawing.exported) == (1, [("pdf", tmp_path / "a.pdf")])
    assert shown.stage is Stage.MADE
    shown.export("pdf", tmp_path / "b.pdf")
    qtbot.waitUntil(lambda: len(drawing.exported) == 2)
    assert len(drawing.made) == 1, "it was up to date"


def test_a_read_only_projects_report_is_exported_elsewhere_but_not_kept_with_it(
    shown: ReportPresenter, drawing: Drawing, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, qtbot: Any
) -> None:
    monkeypatch.setattr(os, "access", lambda *_: False)
    assert "go on in a copy (File, Save a copy)" in shown.why_not_make()
    shown.do_run()
    shown.export("pdf", tmp_path / "out.pdf")
    qtbot.waitUntil(lambda: drawing.exported == [("pdf", tmp_path / "out.pdf")])
    assert drawing.made == []


def test_every_export_has_a_place_to_be_written_to(report: ReportPresenter) -> None:
    places = {kind: report.export_place(kind).name for kind in exports()}
    assert len(set(places.values())) == len(places)


def test_without_a_thickness_only_its_file_is_missing(report: ReportPresenter) -> None:
    measured(report, "camera", "planes", "scan")
    missing = {kind: report.export_missing(kind) for kind in exports()}
    assert {kind for kind, why in missing.items() if why} == {
        "table",
        "xlsx",
        "results",
        "dfq",
        "qif",
        "dcc",
        "dxf",
        "json",
    }
    assert missing["json"] == "Measure the thickness first."


def test_a_part_may_be_called_what_no_file_can_be(report: ReportPresenter) -> None:
    with_info(report, part='50/30 "A": <new>\n')
    assert report.export_place("pdf").name == "50-30 -A-- -new--.pdf"
    with_info(report, part=" . ", name="")
    assert report.export_place("pdf").name == "result.pdf"
