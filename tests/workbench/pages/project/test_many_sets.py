"""Tools, Measure many sets: what is chosen is measured, each set for itself, and shown in one table."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import pytest
from PySide6.QtCore import QUrl
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QMainWindow

from core.image.stripes.stripe import StripeSettings
from core.messages import Message
from core.pipeline.set_result import SetProgress, SetResult
from core.scan.method import Method
from core.settings.options import Options
from tests.workbench.hand_lane import HandLane
from workbench.bench import Bench
from workbench.pages.project.many_sets import ManySets, ManySetsWindow
from workbench.views import ask
from workbench.work import jobs
from workbench.work.worker import Failure


@pytest.fixture
def many(hand_bench: Bench, qtbot: Any) -> ManySets:
    window = QMainWindow()
    qtbot.addWidget(window)
    made = ManySets(hand_bench, window)
    made.setProperty("window", window)
    made.open()
    return made


@pytest.fixture
def shown(many: ManySets) -> ManySetsWindow:
    assert many.shown is not None and many.shown.isVisible()
    return many.shown


def measuring(shown: ManySetsWindow) -> HandLane:
    return cast(HandLane, shown._bench.measuring)


def sets(folder: Path, *names: str) -> Path:
    for name in names:
        (folder / name).mkdir(parents=True)
        (folder / name / "rig.toml").touch()
    return folder


@pytest.fixture
def choose(shown: ManySetsWindow, qtbot: Any, monkeypatch: pytest.MonkeyPatch) -> Callable[[Path, Path, int], None]:
    """Choose folders as a user does; the number is of sets that are in the table then."""

    def choose(folder: Path, out: Path, number: int) -> None:
        monkeypatch.setattr(ask, "choose_folder", lambda *_: folder)
        shown.add.click()
        qtbot.waitUntil(lambda: len(shown.table.rows()) == number)
        monkeypatch.setattr(ask, "choose_folder", lambda *_: out)
        shown.browse.click()

    return choose


def states(shown: ManySetsWindow) -> list[str]:
    return [row[1] for row in shown.table.rows()]


@pytest.mark.accuracy
def test_sets_of_a_folder_are_measured_and_one_that_fails_costs_the_others_nothing(
    shown: ManySetsWindow,
    choose: Callable[[Path, Path, int], None],
    qtbot: Any,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    tiny_set: Path,
) -> None:
    folder, out = sets(tmp_path / "sets", "an empty one"), tmp_path / "out"
    shutil.copytree(tiny_set, folder / "block")
    told: list[tuple[int, SetProgress | SetResult | None]] = []
    assert shown.reason.text() == "Add recording sets first." and not shown.bar.isVisible()
    choose(folder, out, 2)
    assert states(shown) == ["to do", "to do"]
    for field, value in (("method", Method.THREE_CROSSINGS.value), ("sigma_cut_mm", 0.5)):
        shown.form.edited.emit(field, value)
    qtbot.waitUntil(lambda: shown.form.values()["sigma_cut_mm"] == 0.5)
    shown.measure.click()
    assert shown._task is not None
    assert shown.bar.isVisible() and shown.within.isVisible()
    shown._task.reported.connect(told.append)
    qtbot.waitUntil(lambda: states(shown) == ["not measured", "done"], timeout=60_000)
    empty, block = shown.table.rows()
    assert empty[2] == "" and "rig.toml" in empty[-1]
    assert float(block[2]) == pytest.approx(50, abs=2) and float(block[3]) > 0 and block[-1] == ""
    assert sorted(number for number, what in told if isinstance(what, SetResult)) == [0, 1]
    assert any(isinstance(what, SetProgress) and 0 < what.share < 1 for _, what in told)
    assert shown.bar.value() == shown.bar.maximum() and shown.counted.text() == "2 of 2 sets"
    opened: list[str] = []

    def open_url(url: QUrl) -> bool:
        opened.append(url.toLocalFile())
        return True

    monkeypatch.setattr(QDesktopServices, "openUrl", open_url)
    shown.table.set_current_row(1)
    shown.report.click()
    shown.folder.click()
    assert opened == [str(out / "block" / "report.pdf"), str(out / "block")]
    assert Path(opened[0]).is_file()
    shown.table.set_current_row(0)
    assert not shown.report.isEnabled() and not shown.folder.isEnabled() and shown.reason.text() == empty[-1]


def test_each_set_tells_its_state_and_stop_keeps_what_is_done(
    shown: ManySetsWindow, choose: Callable[[Path, Path, int], None], qtbot: Any, tmp_path: Path
) -> None:
    lane = measuring(shown)
    lane.held = {jobs.MEASURE_SETS}
    folder = sets(tmp_path, "a", "b", "c")
    choose(folder, tmp_path / "out", 3)
    shown.measure.click()
    task = lane.current
    assert task is not None and not shown.measure.isEnabled() and not shown.add.isEnabled()
    done = SetResult(folder / "a", tmp_path / "out" / "a", 50.0123, 0.0241, "conforming", 1000, 8, 7, 2.0)
    bad = SetResult(folder / "b", tmp_path / "out" / "b", error=Message("set.empty", "the recording set is empty"))
    for told in ((0, None), (1, None), (0, done), (1, bad), (2, None), (2, SetProgress("network", 0.43))):
        task.reported.emit(told)
    task.progressed.emit("measuring sets", 243, 300)
    assert states(shown) == ["done", "not measured", "being measured, 43\u00a0%"]
    assert shown.table.rows()[0][2:5] == ("50.012", "0.024", "conforming")
    assert (shown.within.value(), shown.stage.text()) == (430, "c: network")
    assert (shown.bar.value(), shown.counted.text()) == (810, "2 of 3 sets")
    shown.stop.click()
    qtbot.waitUntil(lambda: states(shown) == ["done", "not measured", "to do"])
    assert shown.measure.isEnabled() and not shown.stop.isEnabled()
    shown.measure.click()
    assert [path.name for path in lane.waiting[0][2][0]] == ["b", "c"]


def test_what_runs_goes_on_while_the_window_is_closed(
    many: ManySets, shown: ManySetsWindow, choose: Callable[[Path, Path, int], None], qtbot: Any, tmp_path: Path
) -> None:
    lane = measuring(shown)
    lane.held = {jobs.MEASURE_SETS}
    choose(sets(tmp_path, "a"), tmp_path / "out", 1)
    shown.measure.click()
    shown.close()
    lane.finish((SetResult(tmp_path / "a", tmp_path / "out" / "a", 50.0, 0.02, "conforming"),))
    many.open()
    assert many.shown is shown and shown.isVisible() and states(shown) == ["done"]


def test_bars_are_within_the_chosen_set_and_over_all_and_the_time_left_is_told(
    shown: ManySetsWindow,
    choose: Callable[[Path, Path, int], None],
    qtbot: Any,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    lane = measuring(shown)
    lane.held = {jobs.MEASURE_SETS}
    choose(sets(tmp_path, "a", "b"), tmp_path / "out", 2)
    shown.measure.click()
    task = lane.current
    assert task is not None
    for told in ((0, SetProgress("frames", 0.2)), (1, SetProgress("normals", 0.7))):
        task.reported.emit(told)
    assert (shown.within.value(), shown.stage.text()) == (200, "a: frames"), "the first of those that are measured"
    shown.table.set_current_row(1)
    assert (shown.within.value(), shown.stage.text()) == (700, "b: normals")
    seconds = iter(range(0, 1000, 30))
    monkeypatch.setattr(shown._remaining, "_clock", lambda: float(next(seconds)))
    task.progressed.emit("measuring sets", 0, 200)
    task.progressed.emit("measuring sets", 90, 200)
    assert shown.bar.value() == 450
    assert shown.counted.text().startswith("0 of 2 sets; about ") and shown.counted.text().endswith(" left")


def test_settings_are_those_of_the_command_and_what_was_measured_otherwise_is_measured_again(
    shown: ManySetsWindow, choose: Callable[[Path, Path, int], None], qtbot: Any, tmp_path: Path
) -> None:
    lane = measuring(shown)
    lane.held = {jobs.MEASURE_SETS}
    choose(sets(tmp_path, "a"), tmp_path / "out", 1)
    assert not shown.form.isVisible()
    shown.settings.click()
    assert shown.form.isVisible()
    shown.measure.click()
    assert lane.waiting[0][2][2] == Options() and not shown.form.isEnabled()
    lane.finish((SetResult(tmp_path / "a", tmp_path / "out" / "a", 50.0, 0.02, "conforming"),))
    assert states(shown) == ["done"] and shown.form.isEnabled()
    for field, value in (
        ("method", Method.THREE_CROSSINGS.value),
        ("sigma_cut_mm", 0.1),
        ("automatic", False),
        ("width_px", 7.0),
        ("contrast", 60.0),
        ("channel", "red"),
    ):
        shown.form.edited.emit(field, value)
    qtbot.waitUntil(lambda: shown.form.values()["channel"] == "red")
    assert states(shown) == ["to do"]
    shown.measure.click()
    stripe = StripeSettings(7.0, 60.0)
    assert lane.waiting[0][2][2] == Options(
        Method.THREE_CROSSINGS, 0.1, stripe=stripe, plane_stripe=stripe, channel="red"
    )
    shown.stop.click()


def test_a_setting_that_cannot_be_is_told_in_the_window_and_not_taken(shown: ManySetsWindow, qtbot: Any) -> None:
    shown.form.edited.emit("sigma_cut_mm", 20.0)
    qtbot.waitUntil(lambda: "at most 10 mm" in shown.problem.text())
    assert shown._options == Options() and shown.problem.isVisible() and shown._bench.notices.all == []
    shown.form.edited.emit("sigma_cut_mm", 0.1)
    qtbot.waitUntil(shown.problem.isHidden)


def test_a_fault_of_the_program_is_told_in_the_window_and_its_details_in_the_messages(
    shown: ManySetsWindow, choose: Callable[[Path, Path, int], None], tmp_path: Path
) -> None:
    lane = measuring(shown)
    lane.held = {jobs.MEASURE_SETS}
    choose(sets(tmp_path, "a"), tmp_path / "out", 1)
    shown.measure.click()
    lane.fail(Failure("ValueError", "no such thing", "Traceback …"))
    assert "Something went wrong" in shown.problem.text() and states(shown) == ["to do"]
    assert [one.details for one in shown._bench.notices.all] == ["Traceback …"]


def test_without_sets_or_a_folder_for_results_measure_says_what_is_missing(
    shown: ManySetsWindow, choose: Callable[[Path, Path, int], None], qtbot: Any, tmp_path: Path
) -> None:
    assert not shown.measure.isEnabled() and "Add recording sets" in shown.measure.toolTip()
    shown.add_folder(tmp_path)
    qtbot.waitUntil(lambda: "a recording set" in shown.problem.text())
    assert shown.problem.isVisible() and shown._bench.notices.all == []
    choose(sets(tmp_path / "sets", "a"), tmp_path / "out", 1)
    assert shown.problem.isHidden()
    assert shown.measure.isEnabled()
    shown.out.clear()
    assert not shown.measure.isEnabled() and "folder for the results" in shown.measure.toolTip()
    shown.table.set_current_row(0)
    shown.remove.click()
    assert shown.table.rows() == ()


def test_a_batch_that_is_refused_can_be_measured_again(
    shown: ManySetsWindow, choose: Callable[[Path, Path, int], None], qtbot: Any, tmp_path: Path
) -> None:
    choose(sets(tmp_path / "monday", "a"), tmp_path / "out", 1)
    choose(sets(tmp_path / "tuesday", "a"), tmp_path / "out", 2)
    shown.measure.click()
    qtbot.waitUntil(lambda: "same name" in shown.problem.text())
    assert shown._bench.notices.all == [], "what this window cannot do is told in it"
    assert states(shown) == ["to do", "to do"] and shown.measure.isEnabled()
