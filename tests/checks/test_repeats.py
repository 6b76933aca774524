"""Statistics of repeats, against the paper's Table 2 and by hand."""

import math

import numpy as np
import pytest

from core.checks.repeats import RepeatStatistics, histogram, repeat_statistics, run_chart

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
