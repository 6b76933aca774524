"""Gauge R&R against three published studies, and its intervals against their promise."""

import math

import numpy as np
import pytest
from scipy import stats

from core.wings.studies.kinds.grr import ACCEPTABLE, CONDITIONAL, NOT_ACCEPTABLE, grr_study
from tests.wings.studies.grr_tables import AIAG, ISO_A4, THERMAL


def table(rows):
    return {row.source: row for row in rows}


def test_the_manuals_study_gives_the_analysis_of_variance_printed_for_it():
    rows = table(grr_study(AIAG).anova)
    assert rows["parts"].ss == pytest.approx(88.3619, abs=5e-5)
    assert rows["operators"].ss == pytest.approx(3.1673, abs=5e-5)
    assert rows["interaction"].ss == pytest.approx(0.3590, abs=5e-5)
    assert rows["error"].ss == pytest.approx(2.7589, abs=5e-5)
    assert rows["total"].ss == pytest.approx(94.6471, abs=5e-5)
    assert [rows[name].dof for name in ("parts", "operators", "interaction", "error", "total")] == [9, 2, 18, 60, 89]
    assert rows["interaction"].f == pytest.approx(0.434, abs=5e-4)
    assert rows["interaction"].p == pytest.approx(0.974, abs=5e-4)


def test_the_manuals_study_has_its_interaction_pooled_and_the_printed_components():
    study = grr_study(AIAG, tolerance=8.0)
    assert study.pooled
    of = study.component
    assert of("repeatability").variance == pytest.approx(0.03997, abs=5e-6)
    assert of("operators").variance == pytest.approx(0.05146, abs=5e-6)
    assert of("interaction").variance == 0
    assert of("gauge R&R").variance == pytest.approx(0.09143, abs=5e-6)
    assert of("parts").variance == pytest.approx(1.08645, abs=5e-6)
    assert [round(100 * of(name).contribution, 2) for name in ("gauge R&R", "repeatability", "operators", "parts")] == [
        7.76, 3.39, 4.37, 92.24,
    ]  # fmt: skip
    assert [round(100 * of(name).of_total, 2) for name in ("gauge R&R", "repeatability", "operators", "parts")] == [
        27.86, 18.42, 20.90, 96.04,
    ]  # fmt: skip
    assert [round(100 * of(name).of_tolerance, 2) for name in ("gauge R&R", "repeatability", "operators")] == [
        22.68, 14.99, 17.01,
    ]  # fmt: skip
    assert study.categories == 4
    assert study.verdict == CONDITIONAL
    assert any("4 distinct categories" in str(note) for note in study.notes)


def test_a_significant_interaction_stays_in_the_model_as_in_the_thermal_study():
    study = grr_study(THERMAL)
    rows = table(study.anova)
    assert [rows[name].ss for name in ("parts", "operators", "interaction", "error", "total")] == pytest.approx(
        [3935.96, 39.27, 48.51, 30.67, 4054.40], abs=5e-3
    )
    assert [rows[name].f for name in ("parts", "operators", "interaction")] == pytest.approx(
        [162.27, 7.28, 5.27], abs=5e-3
    )
    assert not study.pooled
    expected = {
        "parts": 48.2926,
        "operators": 0.5646,
        "interaction": 0.7280,
        "repeatability": 0.5111,
        "gauge R&R": 1.8037,
    }
    for source, variance in expected.items():
        assert study.component(source).variance == pytest.approx(variance, abs=1e-4)


def test_the_study_of_iso_22514_7_gives_its_tables_a_5_and_a_6():
    study = grr_study(ISO_A4)
    rows, pooled = table(study.anova), table(study.pooled_anova)
    assert (rows["operators"].ss, rows["interaction"].ss, rows["error"].ss) == pytest.approx(
        (0.519, 0.686, 1.917), abs=5e-4
    )
    assert rows["parts"].ss == pytest.approx(526.9, abs=0.1)
    assert rows["interaction"].f == pytest.approx(1.193, abs=5e-4)
    assert (pooled["error"].ms, pooled["error"].dof) == (pytest.approx(0.0334, abs=5e-5), 78)
    assert (pooled["operators"].f, pooled["parts"].f) == (pytest.approx(7.776, abs=5e-4), pytest.approx(1754, abs=1))
    assert study.component("operators").sigma == pytest.approx(0.08683, abs=2e-5)
    assert study.component("repeatability").sigma == pytest.approx(0.1827, abs=5e-5)
    assert study.component("parts").variance == pytest.approx(6.501, abs=5e-4)


def test_the_interval_of_the_repeatability_is_the_exact_one_of_chi_squared():
    study = grr_study(THERMAL)
    error = table(study.anova)["error"]
    exact = [error.ms * error.dof / quantile for quantile in stats.chi2.ppf([0.975, 0.025], error.dof)]
    assert study.component("repeatability").variance_interval == pytest.approx(exact, rel=0.01)


def drawn(rng, p=10, o=3, r=3, part=1.0, operator=0.2, both=0.15, error=0.2):
    return (
        rng.normal(0, part, (p, 1, 1)) + rng.normal(0, operator, (1, o, 1)) + rng.normal(0, both, (p, o, 1))
        + rng.normal(0, error, (p, o, r))
    )  # fmt: skip


@pytest.mark.accuracy
def test_intervals_hold_the_truth_in_about_95_of_100_studies():
    rng = np.random.default_rng(3)
    grr = math.sqrt(0.2**2 + 0.15**2 + 0.2**2)
    share, ndc = grr / math.hypot(1.0, grr), math.sqrt(2) / grr
    held = []
    for _ in range(150):
        study = grr_study(drawn(rng), tolerance=6.0)
        low, high = study.component("gauge R&R").variance_interval
        held.append((
            low <= grr**2 <= high,
            study.grr_interval[0] <= share <= study.grr_interval[1],
            study.tolerance_interval[0] <= grr <= study.tolerance_interval[1],
            study.ndc_interval[0] <= ndc <= study.ndc_interval[1],
        ))  # fmt: skip
    assert np.mean(held, axis=0) == pytest.approx(0.96, abs=0.04)  # not below 92 %; careful, not bold


def test_the_same_study_has_the_same_intervals():
    assert grr_study(THERMAL).grr_interval == grr_study(THERMAL).grr_interval


def test_a_negative_component_becomes_nothing():
    rng = np.random.default_rng(0)
    values = rng.normal(0, 1, (5, 3, 2)) + 10 * np.arange(5)[:, None, None]
    values -= values.mean(axis=(0, 2), keepdims=True)  # operators agree better than chance
    study = grr_study(values)
    assert study.component("operators").variance == 0
    assert study.component("gauge R&R").variance >= study.component("repeatability").variance


def test_one_operator_alone_gives_repeatability_and_says_so():
    study = grr_study(THERMAL[:, :1])
    assert [row.source for row in study.anova] == ["parts", "error", "total"]
    assert study.component("reproducibility").variance == 0
    assert study.component("gauge R&R").variance == study.component("repeatability").variance
    assert any("One operator alone" in str(note) for note in study.notes)


@pytest.mark.parametrize(("error", "verdict"), [(0.01, ACCEPTABLE), (0.2, CONDITIONAL), (0.8, NOT_ACCEPTABLE)])
def test_the_verdict_follows_the_tolerance_if_there_is_one(error, verdict):
    values = drawn(np.random.default_rng(5), operator=0, both=0, error=error)
    assert grr_study(values, tolerance=6.0).verdict == verdict


def test_names_of_parts_and_operators_are_kept():
    study = grr_study(AIAG, operators=("A", "B", "C"))
    assert (study.parts[-1], study.operators) == ("10", ("A", "B", "C"))


@pytest.mark.parametrize(
    "values",
    [np.zeros((2, 2)), np.ones((1, 3, 3)), np.ones((3, 3, 1)), np.ones((3, 3, 3)), np.full((3, 3, 3), np.nan)],
)
def test_what_no_study_can_be_made_of_is_refused(values):
    with pytest.raises(ValueError, match="gauge R&R study needs"):
        grr_study(values)
