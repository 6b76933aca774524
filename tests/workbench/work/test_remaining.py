from __future__ import annotations

import pytest

from workbench.work.remaining import Remaining, in_words


class Clock:
    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


def test_nothing_is_said_of_a_job_that_never_ran_and_has_just_begun() -> None:
    assert Remaining({}, Clock()).left is None


def test_a_first_run_is_judged_by_the_share_of_its_stage() -> None:
    clock = Clock()
    remaining = Remaining({}, clock)
    remaining.tell("frames", 0, 60)
    clock.now = 10.0
    remaining.tell("frames", 20, 60)
    assert remaining.left == pytest.approx(20.0)


def test_later_stages_count_as_they_took_last_time_and_as_much_slower_as_the_others_are_now() -> None:
    clock = Clock()
    remaining = Remaining({"read": 2.0, "solve": 6.0}, clock)
    remaining.tell("read", 0, 10)
    assert remaining.left == pytest.approx(8.0)
    clock.now = 4.0  # twice as slow as the last time
    remaining.tell("solve", 0, 1)
    assert remaining.left == pytest.approx(12.0)
    assert remaining.share == pytest.approx(0.25)


def test_what_the_stages_took_is_kept_for_the_next_time() -> None:
    clock = Clock()
    remaining = Remaining({}, clock)
    remaining.tell("read", 0, 1)
    clock.now = 3.0
    remaining.tell("solve", 0, 1)
    clock.now = 4.0
    assert remaining.finish() == {"read": 3.0, "solve": 1.0}


@pytest.mark.parametrize(("seconds", "words"), [(0.2, "1 s"), (42.4, "42 s"), (100, "2 min")])
def test_durations_are_said_as_people_say_them(seconds: float, words: str) -> None:
    assert in_words(seconds) == words
