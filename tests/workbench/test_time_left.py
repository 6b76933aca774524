"""The time left in the status bar."""

from __future__ import annotations

from PySide6.QtWidgets import QApplication

from tests.workbench.clipped import clipped
from workbench.main_window import MainWindow
from workbench.work import jobs
from workbench.work.jobs import Job
from workbench.work.tasks import Task


def begun(window: MainWindow, job: Job, label: str, stage: str) -> str:
    """What is said of the time left as soon as a job has told its first stage."""
    task = Task(window.bench.measuring, window, 1, job, label)
    window.bench.measuring.task_started.emit(task)
    window.bench.measuring.task_progressed.emit(task, stage, 0, 1)
    said = window.task_bar._left.text()
    window.bench.measuring.task_ended.emit(task)
    return said


def test_a_job_that_was_never_done_says_from_the_start_how_long_it_takes(window: MainWindow) -> None:
    assert begun(window, jobs.MEASURE_SCAN, "Scan", "reference") == "about 5 s left"


def test_the_step_of_how_many_and_the_picture_of_how_many_are_named(window: MainWindow) -> None:
    task = Task(window.bench.measuring, window, 1, jobs.MEASURE_ALL, "Measuring everything")
    window.bench.measuring.task_started.emit(task)
    window.bench.measuring.task_progressed.emit(task, "plane poses", 7, 9)
    said = window.task_bar._label.text()
    window.bench.measuring.task_progressed.emit(task, "network", 1, 3)
    without = window.task_bar._label.text()
    window.bench.measuring.task_ended.emit(task)
    assert said == "2 of 5, Laser planes: plane poses, 7 of 9"
    assert without == "3 of 5, Scan: network", "what is no picture is not counted"


def test_what_it_took_the_last_time_counts_more(window: MainWindow) -> None:
    window.bench.settings.keep_stage_seconds("measure_scan", {"frames": 50.0})
    assert begun(window, jobs.MEASURE_SCAN, "Scan", "reference") == "about 53 s left"


def test_of_a_job_nobody_knows_nothing_is_said_before_it_tells_more(window: MainWindow) -> None:
    assert begun(window, jobs.PACK_PROJECT, "Packing the project", "packing") == ""


def test_stages_that_are_done_without_this_time_stay_remembered(window: MainWindow) -> None:
    settings = window.bench.settings
    settings.keep_stage_seconds("measure_scan", {"frames": 50.0, "network": 3.0})
    settings.keep_stage_seconds("measure_scan", {"network": 4.0})
    assert settings.stage_seconds("measure_scan") == {"frames": 50.0, "network": 4.0}


def test_any_time_left_has_room_before_it_is_told(window: MainWindow, qapp: QApplication) -> None:
    window.show()
    task, lane = Task(window.bench.measuring, window, 1, jobs.MEASURE_SCAN, "Scan"), window.bench.measuring
    lane.task_started.emit(task)
    widths = []
    for left in ("about 1 s left", "about 59 s left", "about 12 min left", "stopping …", ""):
        window.task_bar.progress("Scan", "frames", 0.5, left)
        qapp.processEvents()
        widths.append(window.task_bar._left.width())
    lane.task_ended.emit(task)
    assert widths == widths[:1] * 5, "and what stands beside it does not move"


def test_the_time_left_has_its_place_as_soon_as_it_is_told(window: MainWindow, qapp: QApplication) -> None:
    window.show()
    task = Task(window.bench.measuring, window, 1, jobs.MEASURE_SCAN, "Scan")
    window.bench.measuring.task_started.emit(task)
    qapp.processEvents()  # its place is that of no words yet
    window.bench.measuring.task_progressed.emit(task, "reference", 0, 1)
    cut = clipped(window.task_bar)
    window.bench.measuring.task_ended.emit(task)
    assert cut == {}
