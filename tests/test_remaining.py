from __future__ import annotations

import itertools
import math
import random

import pytest

from core.remaining import COUNTED, USUAL_S, Remaining, in_words, page_of

SMALL_SET_S = {
    **{"camera views": 1.21, "Calibrating the camera": 0.9, "plane poses": 2.88, "fan poses": 0.17, "crossings": 0.08},
    **{"network": 1.33, "calibration uncertainty": 0.65, "mesh": 0.2, "normals": 0.33, "faces": 0.41, "report": 1.77},
}
"""Measured: a set with pictures of a quarter the size of a camera's and half as many frames as the sample's."""


class Clock:
    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


REPORTS = {
    **{"camera views": 10, "Calibrating the camera": 5, "plane poses": 9, "fan poses": 9, "reference": 1, "frames": 48},
    **{"crossings": 48, "network": 3, "calibration uncertainty": 9, "normals": 2, "mesh": 3},
    **{"faces": 8, "features": 8, "report": 1},
}
"""How often a stage tells how far it is."""


def replayed(usual, took):
    """Shares and seconds left as shown, and the truth, at moments all through a job whose stages `took` so long."""
    clock = Clock()
    remaining = Remaining(usual, clock=clock)
    whole, shown = sum(took.values()), []
    for stage, seconds in took.items():
        began = clock.now
        for number in range(40):
            clock.now = began + seconds * number / 40
            remaining.report(stage, number * REPORTS[stage] // 40, REPORTS[stage])
            shown.append((clock.now / whole, remaining.share, remaining.left, whole - clock.now))
        clock.now = began + seconds
    return shown


def under_load(usual, random, load):
    """Seconds left as shown, and the truth, at moments of a job; from `load`, a share of its work, on it is slower.

    Stages take 0.8 to 1.25 times what is usual, on a machine of any speed, and each report a quarter more or less. The
    third of each moment tells whether other work has begun, or ended, by then.
    """
    clock = Clock()
    remaining = Remaining(usual, clock=clock)
    machine = 60 / sum(usual.values()) * random.choice((0.3, 1.0, 8.0))
    slower, steps = random.choice(load[1]), []
    for stage, seconds in usual.items():
        parts = [math.exp(random.gauss(0, 0.25)) for _ in range(REPORTS[stage])]
        whole = seconds * machine * random.choice((0.8, 1.0, 1.25)) / sum(parts)
        steps += [(stage, number, part * whole) for number, part in enumerate(parts)]
    work, begin = sum(seconds for _, _, seconds in steps), random.uniform(*load[0])
    done, moments = 0.0, []
    for stage, number, seconds in steps:
        remaining.report(stage, number, REPORTS[stage])
        for moment in range(8):
            quiet = done + seconds * moment / 8
            clock.now = min(quiet, begin * work) + max(quiet - begin * work, 0.0) * slower
            moments.append((clock.now, remaining.left, quiet > begin * work))
        done += seconds
    end = begin * work + (1 - begin) * work * slower
    return [(left, end - at, loaded) for at, left, loaded in moments if 0.1 * end < at < 0.97 * end]


JOBS = [job for job in USUAL_S if len(USUAL_S[job]) > 1 or job in ("find_views", "find_poses")]


@pytest.mark.parametrize(
    ("load", "least"),
    [(((1.0, 1.0), (1.0,)), 0.9), (((0.1, 0.7), (2.0, 3.0)), 0.8), (((0.1, 0.7), (1 / 2, 1 / 3)), 0.75)],
    ids=["alone", "other work begins", "other work ends"],
)
def test_from_a_tenth_on_the_time_left_is_within_30_per_cent_also_once_other_work_begins(load, least):
    """What is going to happen nobody can know: moments before the load count in the first case only."""
    chance, right = random.Random(39), []
    for job in JOBS:
        for _ in range(8):
            moments = under_load(USUAL_S[job], chance, load)
            right += [abs(left - truth) <= 0.3 * truth for left, truth, loaded in moments if loaded or load[0][0] == 1]
    print(f"{sum(right) / len(right):.3f} of {len(right)} moments within 30 %")
    assert sum(right) / len(right) > least


def is_right(left, truth, whole):
    """Within a factor of two; near the end, where the last stage may tell nothing, within a tenth of the whole."""
    return truth / 2 <= left <= truth * 2 or abs(left - truth) < 0.1 * whole


def test_a_whole_job_has_the_stages_of_its_steps_in_the_order_of_work():
    steps = [stage for job in ("camera", "planes", "scan") for stage in USUAL_S[job]]
    assert list(USUAL_S["measure_set"]) == [*steps, "faces", "report"]
    beside = [stage for stage in USUAL_S["measure_set"] if stage in USUAL_S["run"]]
    assert list(USUAL_S["measure_all"]) == [*beside[:-1], "features", "report"]
    assert list(USUAL_S["run"]) == beside and "frames" not in beside, "the second process looks at the frames"


def test_a_stage_of_a_job_of_several_steps_is_told_by_its_step_and_their_number():
    assert page_of("measure_all", "plane poses") == (2, 5, "planes")
    assert page_of("measure_all", "features") == page_of("measure_all", "faces") == (4, 5, "inspect")
    assert page_of("measure_scan", "frames") == (1, 2, "scan")
    assert page_of("camera", "camera views") is None, "there is no other step"
    assert page_of("measure_all", "something else") is None
    assert all(any(stage in stages for stages in USUAL_S.values()) for stage in COUNTED)


@pytest.mark.parametrize("slower", [0.3, 1.0, 8.0])
@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("job", [job for job in USUAL_S if job != "make_report"])
def test_from_a_fifth_of_a_job_on_the_time_left_is_right_within_a_factor_of_two(job, seed, slower):
    """On a machine of any speed, some stages a quarter longer than usual and others a fifth shorter.

    The report by itself tells nothing until it is there, so it is known on a machine of the usual speed only.
    """
    factors, minute = random.Random(seed), 60.0 / sum(USUAL_S[job].values())
    took = {
        stage: seconds * minute * slower * factors.choice((0.8, 1.0, 1.25)) for stage, seconds in USUAL_S[job].items()
    }
    for part, share, left, truth in replayed(USUAL_S[job], took):
        assert share is not None
        assert left is not None
        assert part < 0.2 or is_right(left, truth, sum(took.values())), (part, left, truth)


@pytest.mark.parametrize("slower", [1.0, 8.0])
def test_it_is_for_a_run_of_another_set_as_well(slower):
    took = {stage: seconds * slower for stage, seconds in SMALL_SET_S.items()}
    for part, _, left, truth in replayed(USUAL_S["run"], took):
        assert part < 0.2 or is_right(left, truth, sum(took.values())), (part, left, truth)


@pytest.mark.parametrize("job", USUAL_S)
def test_what_is_shown_never_goes_back(job):
    took = {
        stage: seconds * (0.2 if number % 2 else 5.0) for number, (stage, seconds) in enumerate(USUAL_S[job].items())
    }
    shares = [share for _, share, _, _ in replayed(USUAL_S[job], took)]
    assert all(one <= other for one, other in itertools.pairwise(shares))
    assert shares[-1] > 0.75


def test_a_whole_job_of_which_only_the_end_is_to_be_done_does_not_wait_for_its_beginning():
    clock = Clock()
    remaining = Remaining(USUAL_S["measure_all"], clock=clock)
    remaining.report("faces", 0, 1)
    assert remaining.left < 0.5 * sum(USUAL_S["measure_all"].values())


def test_nothing_is_said_of_a_job_that_is_not_known_and_has_just_begun():
    assert Remaining({}, clock=Clock()).left is None


def test_a_job_that_is_not_known_is_judged_by_the_share_of_its_stage():
    clock = Clock()
    remaining = Remaining({}, clock=clock)
    remaining.report("frames", 0, 60)
    clock.now = 10.0
    remaining.report("frames", 20, 60)
    assert remaining.left == pytest.approx(20.0)


def test_what_is_remembered_of_the_last_time_takes_the_place_of_what_is_usual():
    remaining = Remaining({"read": 1.0, "solve": 1.0, "write": 1.0}, {"solve": 7.0, "read": 2.0}, Clock())
    remaining.report("read", 0, 10)
    assert remaining.left == pytest.approx(10.0)


def test_later_stages_count_as_much_slower_as_the_others_are_now():
    clock = Clock()
    remaining = Remaining({"read": 2.0, "solve": 6.0}, clock=clock)
    remaining.report("read", 0, 10)
    assert remaining.left == pytest.approx(8.0)
    clock.now = 4.0  # twice as slow as the last time
    remaining.report("solve", 0, 1)
    assert remaining.left == pytest.approx(12.0, rel=0.1)
    assert remaining.share == pytest.approx(0.25, rel=0.1)


@pytest.mark.parametrize("slower", [0.3, 1.0, 3.0])
def test_a_stage_that_tells_thousands_of_pieces_at_once_is_not_taken_to_be_late(slower):
    """A cloud of a million points is written in fifty batches: a report is a fiftieth of the stage."""
    clock, points, batches = Clock(), 1_000_000, 50
    remaining = Remaining({"write": 10.0, "read": 10.0}, clock=clock)
    for batch in range(batches):
        for moment in range(4):
            clock.now = 10.0 * slower * (batch + moment / 4) / batches
            remaining.report("write", batch * points // batches, points)
            assert batch < 5 or remaining.left == pytest.approx(20.0 * slower - clock.now, rel=0.3)
            assert batch > 0 or remaining.left == pytest.approx(20.0 - clock.now, rel=0.1), "nothing is known yet"


def test_batches_that_stay_away_are_late():
    clock = Clock()
    remaining = Remaining({"write": 10.0}, clock=clock)
    for batch in range(6):
        clock.now = float(batch)
        remaining.report("write", batch * 100, 1000)
    in_time = remaining.left
    clock.now = 10.0
    assert in_time == pytest.approx(5.0, rel=0.1)
    assert remaining.left > 3 * in_time


def test_what_the_stages_took_is_kept_for_the_next_time():
    clock = Clock()
    remaining = Remaining({}, clock=clock)
    remaining.report("read", 0, 1)
    clock.now = 3.0
    remaining.report("solve", 0, 1)
    clock.now = 4.0
    assert remaining.finish() == {"read": 3.0, "solve": 1.0}


@pytest.mark.parametrize(("seconds", "words"), [(0.2, "1 s"), (42.4, "42 s"), (100, "2 min")])
def test_durations_are_said_as_people_say_them(seconds, words):
    assert in_words(seconds) == words
