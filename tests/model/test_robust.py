"""Robust weights and scale: what far residuals may do."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import pytest

from core.model.robust import TUKEY, Schedule, Weigh, huber_weights, irls, mad_sd, median, tukey_weights


def test_far_residuals_pull_no_harder_than_near_ones():
    weights = huber_weights(np.array([0.5, -2.0, 20.0, -200.0]), 2.0)
    assert weights * [0.5, 2, 20, 200] == pytest.approx([0.5, 2, 2, 2])


def test_far_residuals_pull_not_at_all():
    weights = tukey_weights(np.array([0.0, 0.5 * TUKEY, -TUKEY, 200.0]))
    assert weights == pytest.approx([1.0, 0.5625, 0.0, 0.0])


def test_the_scale_of_normal_residuals_is_found_among_outliers():
    residuals = np.random.default_rng(5).normal(0, 3.0, 20_001)
    assert mad_sd(residuals) == pytest.approx(3.0, rel=0.03)
    assert mad_sd(np.where(np.arange(20_001) % 20 == 0, 1e6, residuals)) == pytest.approx(3.0, rel=0.12)


@pytest.mark.parametrize("count", [1, 2, 3, 8, 301, 302])
def test_the_median_is_that_of_numpy_to_the_last_bit_and_not_known_where_a_value_is_not(count: int) -> None:
    values = np.random.default_rng(count).normal(0, 3.0, (count, 2))[:, :1]
    before = values.copy()
    assert median(values) == np.median(values)
    assert np.array_equal(values, before)
    values[count // 2] = np.nan
    assert np.isnan(median(values))


def test_no_values_have_no_median() -> None:
    assert np.isnan(median(np.zeros(0)))


def rounds_of(schedule: Schedule, settles: Sequence[bool]) -> str:
    """What the rounds of a fit were weighted by, H or T, where they settle as given; the last one goes on."""
    kinds: list[str] = []

    def improve(found: int, weigh: Weigh) -> int:
        assert weigh.round == found
        kinds.append("T" if weigh.rejects else "H")
        return found + 1

    def settled(_: int, now: int) -> bool:
        return settles[min(now, len(settles)) - 1]

    irls(0, improve, schedule, settled)
    return "".join(kinds)


@pytest.mark.parametrize(
    ("schedule", "settles", "rounds"),
    [
        (Schedule(3), [False], "HHH"),
        (Schedule(9), [False, True], "HH"),
        (Schedule(5, huber=2), [False], "HHTTT"),
        (Schedule(5, huber=0), [False], "TTTTT"),
        (Schedule(6, huber=2, counts_from=3), [True], "HHTT"),
        (Schedule(9, huber=4, early=True, settles=2), [True, False, True], "HTT"),
        (Schedule(9, huber=4, early=True, settles=2), [False], "HHHHTTTTT"),
        (Schedule(9, huber=4, settles=2), [True], "HH"),
    ],
)
def test_a_schedule_says_what_each_round_is_weighted_by_and_which_is_the_last(
    schedule: Schedule, settles: list[bool], rounds: str
) -> None:
    assert rounds_of(schedule, settles) == rounds


def test_all_rounds_are_done_where_nothing_says_when_they_have_settled() -> None:
    assert irls(0, lambda found, _: found + 1, Schedule(7)) == 7


def test_what_watches_sees_every_round_of_a_fit_that_ends_before() -> None:
    seen: list[int] = []

    def watched(rounds: range) -> Iterator[int]:
        for one in rounds:
            seen.append(one)
            yield one

    assert irls(0, lambda found, _: found + 1, Schedule(6), lambda _, now: now == 2, watched) == 2
    assert seen == list(range(6))


def test_limits_are_multiples_of_the_unit() -> None:
    residuals = np.array([0.0, 3.0, -6.0, 30.0])
    schedule = Schedule(2, huber=1, huber_at=2.0, tukey_at=5.0)
    assert np.array_equal(Weigh(schedule, 0, rejects=False)(residuals, 3.0), huber_weights(residuals, 6.0))
    assert np.array_equal(Weigh(schedule, 1, rejects=True)(residuals, 3.0), tukey_weights(residuals, 15.0))


def test_a_mean_among_outliers_is_that_of_the_others() -> None:
    values = np.concatenate([np.random.default_rng(2).normal(10.0, 1.0, 200), np.full(40, 90.0)])

    def mean(found: float, weigh: Weigh) -> float:
        weights = weigh(values - found, mad_sd(values - found))
        return float(weights @ values / weights.sum())

    found = irls(float(np.median(values)), mean, Schedule(40, huber=8))
    assert found == pytest.approx(float(values[:200].mean()), abs=0.05)
