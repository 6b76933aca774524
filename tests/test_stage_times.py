"""What the stages of a job cost: processor time by step, on all threads."""

import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from core.stage_times import StageTimes, stage


def work(seconds):
    until = time.thread_time() + seconds
    while time.thread_time() < until:
        pass


def test_time_is_booked_to_the_step_told_last():
    told = []
    times = StageTimes(lambda *step: told.append(step))
    times("first", 0, 1)
    work(0.04)
    times("second", 0, 1)
    assert times.seconds()["first"] == pytest.approx(0.04, abs=0.02)
    assert times.seconds()["second"] < 0.02
    assert told == [("first", 0, 1), ("second", 0, 1)]


def test_stages_on_other_threads_add_up_and_waiting_for_them_costs_nothing():
    times = StageTimes()

    def job(_):
        with stage(times, "reading"):
            work(0.03)

    times("frames", 0, 1)
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(job, range(2)))
    assert times.seconds()["reading"] == pytest.approx(0.06, abs=0.03)
    assert times.seconds()["frames"] < 0.03


def test_a_stage_on_the_own_thread_is_not_booked_twice():
    times = StageTimes()
    times("scan", 0, 1)
    with stage(times, "writing"):
        work(0.04)
    assert times.seconds()["scan"] < 0.02


def test_nobody_need_want_to_know():
    with stage(None, "reading"):
        pass
