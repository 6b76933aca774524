"""Work side by side: in order, and interruptible while it waits."""

import threading
import time

import pytest

from core.errors import Cancelled
from core.progress import StepProgress
from core.threads import ordered_map


def test_results_come_in_the_order_of_the_items():
    def slow_first(item):
        time.sleep(0.05 if item == 0 else 0)
        return item * item

    assert list(ordered_map(slow_first, range(10), workers=4)) == [item * item for item in range(10)]


def test_while_a_result_is_waited_for_the_caller_is_asked_now_and_then():
    asked = []
    list(ordered_map(lambda _: time.sleep(0.7), range(1), idle=lambda: asked.append(threading.current_thread())))
    assert len(asked) >= 2
    assert set(asked) == {threading.current_thread()}


def test_who_cancels_while_waiting_does_not_wait_for_the_job():
    finish = threading.Event()
    begun = []

    def job(item):
        begun.append(item)
        finish.wait(10)

    def stop():
        raise Cancelled

    start = time.perf_counter()
    with pytest.raises(Cancelled):
        list(ordered_map(job, range(100), workers=2, idle=stop))
    waited = time.perf_counter() - start
    finish.set()
    assert waited < 8  # the job ends after ten
    assert len(begun) <= 2


def test_a_jobs_own_timeout_is_raised_as_it_is():
    def late(_):
        raise TimeoutError("the camera is silent")

    with pytest.raises(TimeoutError, match="the camera is silent"):
        list(ordered_map(late, range(3), idle=lambda: None))


def test_a_part_of_a_step_repeats_where_the_whole_step_is():
    heard = []
    told = StepProgress(lambda *words: heard.append(words))
    told.within_step("rounds", 1, 12)
    told("network", 1, 3)
    told.within_step("rounds", 2, 12)
    assert heard == [("rounds", 1, 12), ("network", 1, 3), ("network", 1, 3)]
