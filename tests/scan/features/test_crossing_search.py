"""All crossings of a scan in one search against pictures compared two by two."""

from __future__ import annotations

from dataclasses import fields, replace
from time import thread_time

import numpy as np
import pytest

from core.errors import Cancelled
from core.image.crossings.segments import Stack
from core.image.stripes.centreline import Centreline
from core.scan.features import crossing_search
from core.scan.features.crossing_search import all_crossings, meetings_of
from core.scan.features.crossings import CrossingTable, CrossingWindow, crossing_table, meetings, shaded
from core.stage_times import StageTimes

WINDOW = CrossingWindow(half_length_px=20.0)


def curve(rng: np.random.Generator, size: float = 600.0) -> Centreline:
    """A wavy line of any direction through a picture, with noise and with brightness that changes along it."""
    along = np.arange(-0.6 * size, 0.6 * size)
    angle, wave, phase = rng.uniform(0, np.pi), rng.uniform(60, 300), rng.uniform(0, 6)
    across = rng.uniform(0.2, 12) * np.sin(along / wave + phase) + rng.normal(0, 0.3, len(along))
    direction, normal = np.array([np.cos(angle), np.sin(angle)]), np.array([np.sin(angle), -np.cos(angle)])
    uv = rng.uniform(0.3, 0.7, 2) * size + along[:, None] * direction + across[:, None] * normal
    uv = uv[((uv > 0) & (uv < size)).all(axis=1)]
    ones = np.ones(len(uv))
    strength = 100 + 50 * np.sin(along[: len(uv)] / 50)
    return Centreline(uv, normal * ones[:, None], ones, strength, 0.3 * ones, rng.random(len(uv)) < 0.02, 3.0)


def pieces(rng: np.random.Generator) -> list[Centreline]:
    """None to three centrelines, some of them cut in two."""
    found = []
    for _ in range(rng.integers(0, 3)):
        whole = curve(rng)
        cut = int(rng.integers(1, max(2, len(whole) - 1)))
        parts = [whole.select(slice(None, cut)), whole.select(slice(cut, None))] if rng.random() < 0.5 else [whole]
        found += [part for part in parts if len(part)]
    return found


def two_by_two(fan: list[Centreline], sweeps: list[list[Centreline]]) -> CrossingTable:
    rows, ready, fixed = [], [shaded(lines, WINDOW) for lines in sweeps], shaded(fan, WINDOW)
    for a, lines in enumerate(ready):
        rows += meetings(lines, fixed, a, -1, WINDOW)
        for b in range(a + 1, len(sweeps)):
            rows += meetings(lines, ready[b], a, b, WINDOW)
    return crossing_table(rows, WINDOW)


@pytest.mark.parametrize("seed", range(6))
def test_the_crossings_are_those_of_pictures_compared_two_by_two_to_the_last_bit(seed):
    rng = np.random.default_rng(seed)
    fan, sweeps = [curve(rng) for _ in range(3)], [pieces(rng) for _ in range(12)]
    found, expected = all_crossings(fan, sweeps, WINDOW), two_by_two(fan, sweeps)
    assert len(found) > 40
    for field in fields(CrossingTable):
        one, other = getattr(found, field.name), getattr(expected, field.name)
        assert np.array_equal(one, other) and np.asarray(one).dtype == np.asarray(other).dtype, field.name


@pytest.mark.parametrize(("fan", "sweeps"), [([], []), ([], [[], []]), ([curve(np.random.default_rng(1))], [[], []])])
def test_where_nothing_is_seen_nothing_crosses(fan, sweeps):
    found, expected = all_crossings(fan, sweeps, WINDOW), two_by_two(fan, sweeps)
    assert len(found) == 0
    assert found.share_a.shape == expected.share_a.shape


def test_a_line_that_has_strayed_far_off_costs_no_memory():
    rng = np.random.default_rng(7)
    here, strayed = curve(rng), curve(rng)
    strayed = replace(strayed, uv=strayed.uv + [0.0, 1e12])
    found = all_crossings([here], [[strayed], [curve(rng)]], WINDOW)
    assert (found.a == 1).all() and len(found)


def compared_and_met(sweeps: int, apart: float) -> tuple[int, int]:
    """Runs compared, and meetings, of parallel sweeps `apart` px over a picture, with one line of the fan across."""
    along = np.arange(0.0, 800.0)
    ones = np.ones(len(along))

    def line(uv: np.ndarray) -> Centreline:
        return Centreline(uv, np.column_stack([ones, 0 * ones]), ones, 100 * ones, 0.1 * ones, ones < 0, 3.0)

    lines = [line(np.column_stack([3 * along, 400 + 0.1 * along]))]
    lines += [line(np.column_stack([apart * (k + 0.5) + 0.01 * along, along])) for k in range(sweeps)]
    met = meetings_of(Stack(lines, 20.0), np.arange(len(lines)))
    return met.compared, len(met.piece)


def test_the_cost_grows_with_the_crossings_not_with_the_pairs_of_frames():
    """Sweeps side by side cross the fan only: twice as many cost twice as much, not four times."""
    cost = [compared_and_met(sweeps, 30.0) for sweeps in (20, 40, 80)]
    assert [met for _, met in cost] == [20, 40, 80]
    per_meeting = [compared / met for compared, met in cost]
    assert max(per_meeting) < 1.5 * min(per_meeting)
    runs = 80 * 50
    assert cost[-1][0] < 0.01 * runs**2 / 2


def test_a_search_can_be_cancelled_and_tells_how_far_it_is():
    rng = np.random.default_rng(2)
    fan, sweeps = [curve(rng)], [[curve(rng)] for _ in range(40)]
    told = []
    all_crossings(fan, sweeps, WINDOW, lambda step, done, total: told.append((step, done, total)))
    assert told == sorted(told) and told[-1] == ("crossings", 40, 40) and len(told) > 2

    def stop(step, done, total):
        if done:
            raise Cancelled

    with pytest.raises(Cancelled):
        all_crossings(fan, sweeps, WINDOW, stop)


def test_the_time_of_the_fits_on_all_threads_is_that_of_the_crossings(monkeypatch):
    spent_s = []

    def fit(*_):
        began = thread_time()
        while thread_time() < began + 0.03:
            pass
        spent_s.append(thread_time() - began)

    monkeypatch.setattr(crossing_search, "_AT_ONCE", 1)
    monkeypatch.setattr(crossing_search, "_fit", fit)
    monkeypatch.setattr(crossing_search, "_table", lambda *_: None)
    rng, times = np.random.default_rng(2), StageTimes()
    all_crossings([curve(rng)], [[curve(rng)] for _ in range(4)], WINDOW, times)
    assert len(spent_s) > 2 and times.seconds()["crossings"] >= sum(spent_s)
