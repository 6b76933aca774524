"""The study of a series: what it claims, and when it claims nothing."""

import math

import numpy as np
import pytest

from core.errors import WrongValue
from core.findings.proof import Doubt
from core.inspect.causes import Cause
from core.inspect.results import Contribution
from core.wings.studies.kinds.doubted import DoubtedResult
from core.wings.studies.kinds.series import StatedUncertainty, series_study, stated_uncertainty
from core.wings.studies.kinds.series_chart import FEWEST_POINTS
from tests.wings.studies.spc_tables import FLOW_RATES, PISTON_RINGS


def steady(n=100, sigma=0.01, seed=5):
    return 50 + sigma * np.random.default_rng(seed).standard_normal(n)


def codes(study):
    return [note.code for note in study.notes]


def test_the_piston_rings_within_74_plus_or_minus_0_05_mm_have_the_cp_of_montgomerys_sigma():
    """His σ of example 6.3 is 0.0100 mm: 0.1 / (6 · 0.0100) = 1.67."""
    study = series_study(PISTON_RINGS.ravel(), (73.95, 74.05), size=5)
    assert study.short.p.value == pytest.approx(1.67, abs=0.005)
    low, high = study.short.p.interval
    assert low < 1.67 < high and study.verdict == "capable"


def test_below_twenty_points_there_are_no_limits_and_no_cp_and_it_is_said():
    study = series_study(FLOW_RATES, (40.0, 60.0))
    assert (study.charts, study.short, study.overall, study.verdict) == (None, None, None, "not proven")
    assert study.notes[0].values == {"n": 10, "least": FEWEST_POINTS}
    of_groups = series_study(steady(95), (49.9, 50.1), size=5)
    assert of_groups.charts is None and of_groups.short is None
    assert of_groups.overall is not None, "95 values say something of the whole scatter"


def test_a_process_is_capable_or_not_only_if_the_whole_interval_says_so():
    wide, middling, narrow = (series_study(steady(), (50 - t, 50 + t)).verdict for t in (0.08, 0.04, 0.02))
    assert (wide, middling, narrow) == ("capable", "not proven", "not capable")
    assert series_study(steady()).verdict == ""


def test_a_point_beyond_the_limits_is_named_and_takes_the_verdict():
    values = steady()
    values[60] += 0.06
    labels = [f"part {n}" for n in range(1, 101)]
    study = series_study(values, (49.8, 50.2), labels=labels)
    note = next(one for one in study.notes if one.code == "study.rule_broken" and one.values["rule"] == 1)
    assert "part 61" in note.values["names"] and "part 61" in str(note)
    assert study.verdict == "not proven" and "study.not_steady" in codes(study)
    assert any("part 60 … part 61" in str(note) for note in study.notes), "the moving range jumps there"


def test_a_drift_shows_in_ppk_and_not_in_cpk():
    study = series_study(steady() + np.linspace(-0.05, 0.05, 100), (49.88, 50.12))
    assert study.overall.pk.value < 0.5 * study.short.pk.value
    assert study.verdict == "not proven"


def test_the_uncertainty_has_its_share_in_the_scatter_and_in_the_interval():
    rows = (Contribution(Cause.POINT_NOISE, 0.003), Contribution(Cause.CAMERA, 0.004))
    stated = stated_uncertainty([0.005] * 100, [rows] * 100)
    assert (stated.own, stated.whole, stated.common) == pytest.approx((0.003, 0.005, 0.004))
    bare, study = series_study(steady(), (49.96, 50.04)), series_study(steady(), (49.96, 50.04), stated=stated)
    low, high = study.share_of_u
    assert (low, high) == pytest.approx(((0.003 / study.s) ** 2, (0.005 / study.s) ** 2))
    assert study.short.pk.interval[0] < bare.short.pk.interval[0]
    assert "study.series_without_u" in codes(bare) and "study.series_without_u" not in codes(study)
    unknown = stated_uncertainty([0.005] * 3, [])
    assert (unknown.own, unknown.common) == (0.0, 0.005), "what is not known to scatter may be common"


def test_what_makes_no_whole_subgroup_is_told():
    study = series_study(steady(103), size=5)
    assert study.points == 20 and study.charts.location.points.shape == (20,)
    assert next(one for one in study.notes if one.code == "study.series_values_over").values == {"n": 3}
    assert study.label_of(1) == "6 … 10" and study.label_of_spread(1) == "6 … 10"


def test_values_that_are_all_the_same_have_no_limits():
    study = series_study([50.0] * 30, (49.0, 51.0))
    assert study.charts is None and study.overall is None and codes(study)[0] == "study.series_no_spread"


def test_values_that_are_not_normal_are_told():
    values = 50 + 0.01 * np.exp(np.random.default_rng(1).standard_normal(60))
    assert "study.not_normal" in codes(series_study(values, (49.0, 51.0)))


def test_doubted_parts_prove_nothing():
    study = series_study(steady(), (49.9, 50.1), doubted=(DoubtedResult("7", (Doubt.named("moved"),)),))
    assert study.verdict == "not proven" and "study.doubted" in codes(study)


@pytest.mark.parametrize(
    ("values", "limits", "size"),
    [
        ([1.0], (0.0, 2.0), 1),
        ([1.0, math.nan], (0.0, 2.0), 1),
        ([1.0, 2.0], (2.0, 0.0), 1),
        ([1.0, 2.0], (0.0, 2.0), 26),
    ],
)
def test_a_series_of_which_no_study_can_be_made_is_refused(values, limits, size):
    with pytest.raises(WrongValue):
        series_study(values, limits, size=size, stated=StatedUncertainty(0.0, 0.1))
