"""Statistics of repeats, against the paper's Table 2 and by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest

from core.inspect.causes import Cause
from core.inspect.results import Contribution
from core.report.facts.of_budget import EFFECTIVE, freedom_fact
from core.report.facts.of_studies import study_facts
from core.report.wording import Words
from core.study.budget import from_budgets, from_stated
from core.study.repeats import RepeatStatistics, Requirement, histogram, repeat_statistics, repeat_study, run_chart

TABLE_1 = {
    70: (69.920, 70.101, 70.063, 70.042, 69.929, 69.918, 69.892, 70.102, 70.097, 70.114),
    60: (60.102, 60.085, 59.989, 60.092, 60.112, 60.003, 59.888, 59.933, 59.848, 59.887),
    50: (50.122, 50.089, 49.923, 49.906, 50.104, 50.113, 49.896, 50.091, 50.132, 49.899),
    40: (39.902, 39.893, 40.113, 40.136, 40.104, 39.915, 39.911, 40.163, 40.072, 40.085),
}
"""Sun et al. 2023: ten scans of each of four blocks."""

TABLE_2 = {60: (59.994, 0.0957, 0.1007), 50: (50.026, 0.1039, 0.1056), 40: (40.030, 0.1083, 0.1099)}
"""Mean, RMSE and STD as printed; the 70 mm column does not follow from Table 1 and is left out."""


@pytest.mark.parametrize("nominal", TABLE_2)
def test_the_papers_second_table_follows_from_its_first(nominal):
    found = repeat_statistics(TABLE_1[nominal], nominal)
    mean, rmse, std = TABLE_2[nominal]
    assert found.n == 10
    assert found.mean_mm == pytest.approx(mean, abs=0.0016)  # 50.0275 is printed as 50.026
    assert found.rmse_mm == pytest.approx(rmse, abs=1e-4)
    assert found.std_mm == pytest.approx(std, abs=1e-4)


def test_the_70_mm_column_gives_what_its_ten_values_say_and_not_what_is_printed():
    found = repeat_statistics(TABLE_1[70], 70)
    assert found.mean_mm == pytest.approx(70.0178, abs=1e-9)
    assert (found.rmse_mm, found.std_mm) == pytest.approx((0.0886, 0.0915), abs=5e-5)


def test_the_figures_to_beat_are_the_largest_over_all_blocks():
    found = [repeat_statistics(values, nominal) for nominal, values in TABLE_1.items()]
    assert max(one.largest_error_mm for one in found) == pytest.approx(0.163, abs=1e-9)
    assert max(one.std_mm for one in found) == pytest.approx(0.110, abs=5e-4)


def test_largest_error_is_a_magnitude_and_the_mean_error_has_its_sign():
    found = repeat_statistics([49.8, 50.1], 50.0)
    assert found.error_mm == pytest.approx(-0.05)
    assert found.largest_error_mm == pytest.approx(0.2)
    assert found.rmse_mm == pytest.approx(math.sqrt((0.04 + 0.01) / 2))
    assert found.std_mm == pytest.approx(0.3 / math.sqrt(2))


def test_one_scan_alone_says_nothing_of_the_spread():
    found = repeat_statistics([50.1], 50.0)
    assert (found.n, found.mean_mm) == (1, 50.1)
    assert math.isnan(found.std_mm)
    assert found.error_mm == found.largest_error_mm == pytest.approx(0.1)


def test_without_a_nominal_value_there_is_no_error():
    assert repeat_statistics([50.0, 50.2]) == RepeatStatistics(2, 50.1, None, None, pytest.approx(0.2 / 2**0.5), None)


@pytest.mark.parametrize("values", [[], [50.0, math.nan], [math.inf]])
def test_nothing_and_unknown_thicknesses_are_refused(values):
    with pytest.raises(ValueError, match="finite thickness"):
        repeat_statistics(values, 50.0)


def test_the_run_chart_has_the_limits_of_individual_values_and_names_what_leaves_them():
    steady = [50.0, 50.1, 50.0, 50.1, 50.0, 50.1]
    chart = run_chart(np.array(steady))
    assert (chart.lower, chart.upper) == pytest.approx((50.05 - 2.66 * 0.1, 50.05 + 2.66 * 0.1))
    assert chart.outside == ()
    values = np.array([50.0, 50.01, 50.0, 50.01, 50.0, 50.01, 50.0, 50.01, 50.0, 50.2])
    assert run_chart(values).outside == (9,)
    assert run_chart(np.array([50.0])) is None


@pytest.mark.parametrize("values", [TABLE_1[70], [50.0] * 4, list(np.random.default_rng(0).normal(0, 1, 5000))])
def test_the_histogram_counts_every_value_once_in_few_bins(values):
    found = histogram(np.array(values))
    assert found.counts.sum() == len(values)
    assert len(found.edges) == len(found.counts) + 1 <= 21


def study(values, u, **asked):
    return repeat_study(values, from_stated(values, u), complete=u is not None, asked=Requirement(**asked))


def test_the_verdict_is_that_of_the_mean_with_its_own_uncertainty():
    values = [50.02, 50.04, 50.03, 50.03]
    good = study(values, 0.01, nominal=50.0, limits=(-0.1, 0.1))
    assert good.verdict == "conforming"
    assert good.budget.u == pytest.approx(math.hypot(0.01, np.std(values, ddof=1) / 2))
    assert study(values, 0.04, nominal=50.0, limits=(-0.1, 0.1)).verdict == "not proven"
    assert study(values, 0.04, nominal=50.0, limits=(-0.1, 0.1), r=0).verdict == "conforming"
    assert study(values, 0.01, nominal=49.0, limits=(-0.1, 0.1)).verdict == "not conforming"
    assert study(values, 0.01).verdict == ""


def test_scatter_alone_proves_nothing_because_what_is_common_is_not_in_it():
    found = study([50.0, 50.001, 50.0], None, nominal=50.0, limits=(-1, 1))
    assert found.verdict == "not proven"
    assert any("nothing is proven" in str(note) for note in found.notes)


def test_what_is_common_to_all_repeats_does_not_average_out_and_their_own_noise_does():
    budget = (
        Contribution(Cause.CAMERA, 0.003),
        Contribution(Cause.POINT_NOISE, 0.02),
        Contribution(Cause.SWEEP_PLANES, 0.01),
    )
    rng = np.random.default_rng(0)
    values = rng.normal(50, math.hypot(0.02, 0.01) / 2, 100)  # no more scatter than stated
    rows = {row.source: row for row in from_budgets(values, [budget] * 100).rows}
    assert rows.keys() == {Cause.CAMERA, Cause.POINT_NOISE, Cause.SWEEP_PLANES}
    assert rows[Cause.CAMERA].u_mm == pytest.approx(0.003)
    assert rows[Cause.POINT_NOISE].u_mm == pytest.approx(0.002)
    assert rows[Cause.SWEEP_PLANES].u_mm == pytest.approx(0.001)


def test_scatter_above_the_stated_noise_takes_its_place():
    budget = (Contribution(Cause.CAMERA, 0.003), Contribution(Cause.POINT_NOISE, 0.006))
    values = 50 + 0.01 * np.array([-1, 1, -1, 1, -1, 1, -1, 1]) * math.sqrt(7 / 8)  # s is 0.01
    found = from_budgets(values, [budget] * 8)
    assert [row.source for row in found.rows] == [Cause.CAMERA, Cause.OBSERVED]
    assert (found.rows[1].point_mm, found.rows[1].dof) == (pytest.approx(0.01), 7)
    assert found.u == pytest.approx(math.sqrt(0.003**2 + 0.01**2 / 8))
    assert found.value == pytest.approx(50)


def test_budgets_that_differ_from_scan_to_scan_enter_by_their_quadratic_mean():
    found = from_budgets([1.0, 1.0], [(Contribution(Cause.CAMERA, 0.3),), (Contribution(Cause.CAMERA, 0.4, dof=5),)])
    assert found.rows[0].u_mm == pytest.approx(math.sqrt((0.09 + 0.16) / 2))
    assert found.rows[0].dof == 5


def test_one_value_of_unknown_uncertainty_has_no_budget():
    with pytest.raises(ValueError, match="one value alone"):
        from_stated([50.0], None)
    assert from_stated([50.0], 0.01).u == pytest.approx(0.01)


@pytest.mark.parametrize("actual", [0.008, 0.015])
def test_U_of_the_mean_holds_the_truth_in_95_of_100_series_whether_or_not_the_noise_is_as_stated(actual):
    rng = np.random.default_rng(4)
    budget = (Contribution(Cause.CAMERA, 0.004), Contribution(Cause.POINT_NOISE, 0.008))
    held = []
    for _ in range(2000):
        values = 50 + 0.004 * rng.normal() + actual * rng.normal(size=5)
        found = from_budgets(values, [budget] * 5)
        held.append(abs(found.value - 50) <= found.U)
    assert 0.93 < np.mean(held) < 0.98  # the larger of the stated and the observed noise counts, of five scans


@pytest.mark.parametrize("dof", [5.25, 12.5, 5000.0, math.inf])
def test_degrees_of_freedom_are_told_in_the_words_and_digits_of_a_budget(dof):
    found = study([1.0, 1.1, 1.05], None)
    of_mean = replace(found, budget=replace(found.budget, dof=dof))
    told = [(one.label, one.text(Words())) for one in study_facts(of_mean)]
    assert (EFFECTIVE, freedom_fact("ν", dof).text(Words())) in told
