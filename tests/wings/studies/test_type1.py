"""Type-1 studies against the bias example of the AIAG manual and by hand."""

import math

import numpy as np
import pytest

from core.wings.studies.kinds.type1 import CAPABLE, NOT_CAPABLE, type1_study

AIAG_BIAS = (5.8, 5.7, 5.9, 5.9, 6.0, 6.1, 6.0, 6.1, 6.4, 6.3, 6.0, 6.1, 6.2, 5.6, 6.0)
"""AIAG, Measurement systems analysis, 4th ed., table III-B 1: fifteen readings of a reference value of 6.00."""


def spread(mean, s, n=50):
    """n values of exactly this mean and standard deviation."""
    steps = np.linspace(-1, 1, n)
    return mean + s * steps / steps.std(ddof=1)


def test_the_bias_of_the_manuals_example_is_tested_as_printed_in_table_III_B_2():
    found = type1_study(AIAG_BIAS, 6.0, 4.0)
    assert (found.n, found.dof) == (15, 14)
    assert (found.mean, found.s) == (pytest.approx(6.0067, abs=5e-5), pytest.approx(0.2120, abs=5e-5))
    assert found.t == pytest.approx(0.12, abs=5e-3)
    assert found.bias_interval == pytest.approx((-0.1107, 0.1241), abs=5e-5)
    assert not found.bias_is_significant


def test_a_printed_report_of_fifty_readings_has_our_t_and_p():
    """SPC for Excel, example of a type-1 report: 12.285 to 12.335, reference 12.306, bias 0.00150, s 0.00485."""
    found = type1_study(spread(12.3075, 0.00485), 12.306, 0.05, resolution=0.0001)
    assert found.t == pytest.approx(2.185, abs=0.01)  # bias and s are printed to three digits
    assert round(found.p, 2) == 0.03
    assert found.bias_is_significant
    assert found.resolution_share == pytest.approx(0.002)
    assert found.verdict == NOT_CAPABLE


def test_a_spread_of_37_50_percent_of_the_tolerance_has_the_cg_printed_with_it():
    """Minitab's help on type-1 studies: %Var (repeatability) = 6 s / T = 37.50 %, Cg = 0.53."""
    assert round(type1_study(spread(0.0, 0.375 / 6), 0.0, 1.0).cg, 2) == 0.53


def test_cg_and_cgk_are_what_their_formulas_say():
    found = type1_study(spread(50.02, 0.01), 50.0, 1.0)
    assert found.cg == pytest.approx(0.2 / 0.06)
    assert found.cgk == pytest.approx((0.1 - 0.02) / 0.03)
    assert found.verdict == CAPABLE
    assert found.bias_is_significant
    assert found.p == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize(("cg", "verdict"), [(1.33 + 1e-6, CAPABLE), (1.33 - 1e-6, NOT_CAPABLE)])
def test_the_limit_is_1_33(cg, verdict):
    found = type1_study(spread(10.0, 0.2 / (6 * cg)), 10.0, 1.0)
    assert found.cg == pytest.approx(cg)
    assert found.verdict == verdict


def test_a_bias_alone_can_make_a_gauge_incapable_and_the_note_says_so():
    found = type1_study(spread(10.08, 0.01), 10.0, 1.0)
    assert found.cg > 1.33 > found.cgk
    assert found.verdict == NOT_CAPABLE
    assert any("bias does not" in str(note) for note in found.notes)


def test_the_smallest_tolerance_is_the_one_for_which_the_gauge_is_just_capable():
    found = type1_study(spread(10.005, 0.01), 10.0, 1.0)
    again = type1_study(spread(10.005, 0.01), 10.0, found.smallest_tolerance)
    assert min(again.cg, again.cgk) == pytest.approx(1.33)


@pytest.mark.parametrize(("resolution", "suffices"), [(0.05, True), (0.051, False), (None, None)])
def test_the_resolution_may_be_a_twentieth_of_the_tolerance(resolution, suffices):
    found = type1_study(spread(10.0, 0.01), 10.0, 1.0, resolution=resolution)
    assert found.resolution_suffices is suffices
    assert found.verdict == (NOT_CAPABLE if suffices is False else CAPABLE)


def test_the_interval_of_cg_holds_the_true_one_in_95_of_100_studies():
    rng = np.random.default_rng(1)
    true = 0.2 / (6 * 0.02)
    studies = [type1_study(rng.normal(0.0, 0.02, 20), 0.0, 1.0) for _ in range(1500)]
    inside = np.mean([one.cg_interval[0] <= true <= one.cg_interval[1] for one in studies])
    found = np.mean([one.bias_is_significant for one in studies])
    assert inside == pytest.approx(0.95, abs=0.017)  # three standard deviations of 1500 draws
    assert found == pytest.approx(0.05, abs=0.017)  # there is no bias to be found


def test_values_all_the_same_are_capable_only_where_the_bias_allows_and_say_what_is_wrong():
    right, wrong = type1_study([10.0] * 30, 10.0, 1.0), type1_study([10.2] * 30, 10.0, 1.0)
    assert (right.cg, right.cgk, right.t, right.p) == (math.inf, math.inf, 0.0, 1.0)
    assert (wrong.cgk, wrong.verdict) == (-math.inf, NOT_CAPABLE)
    assert any("resolution hides" in str(note) for note in right.notes)


def test_few_repeats_are_said_to_be_few():
    assert any("10 repeats" in str(note) for note in type1_study(spread(1, 0.1, 10), 1.0, 1.0).notes)


@pytest.mark.parametrize(
    ("values", "tolerance", "resolution"),
    [([1.0], 1.0, None), ([1.0, math.nan], 1.0, None), ([1, 2], 0, None), ([1, 2], math.inf, None), ([1, 2], 1, 0)],
)
def test_what_no_study_can_be_made_of_is_refused(values, tolerance, resolution):
    with pytest.raises(ValueError, match=r"type-1 study needs|resolution must be above 0"):
        type1_study(values, 1.0, tolerance, resolution=resolution)
