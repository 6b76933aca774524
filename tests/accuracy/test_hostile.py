"""The hostile table: what it calls silent, and a few of its scans at a quarter of the size."""

import pytest

from core.simulate.scenario import Scenario
from tests.accuracy.hostile import figures_of, named, row_of, silent, summary, table
from tests.accuracy.hostile_cases import EFFECTS, HostileCase, base, calibration_of, hostile_cases

HELD = {"error": 0.02, "U": 0.05, "verdict": "conforming", "complete": True, "told": []}
SHORT = (
    ("second bounces between table and part's sides", "10%"),
    ("a shadow that passes", "80%"),
    ("fan lines that bow", "0.003"),
)


def test_silent_is_what_is_wrong_beyond_u_and_called_conforming_or_has_no_reason():
    wrong = {**HELD, "error": -0.08}
    assert not silent(HELD)
    assert silent(wrong)
    assert silent({**wrong, "verdict": "not conforming", "told": ["scan.moved"]}), "called proven all the same"
    doubted = {**wrong, "verdict": "not proven", "complete": False}
    assert silent(doubted)
    assert silent({**doubted, "told": ["scan.stability_assumed"]}), "said of every scan"
    assert not silent({**doubted, "told": ["scan.moved"]})
    assert not silent({"refused": "gauge.no_parallel_faces", "told": []})


def test_a_line_tells_the_worst_of_its_scans():
    cases = [HostileCase("warmth", "much", Scenario(seed=seed)) for seed in (1, 2)]
    results = {cases[0].name: HELD, cases[1].name: {**HELD, "error": 0.09, "told": ["scan.datum"]}}
    assert row_of(cases, results) == "| warmth | much | none | +20, +90 | 50–50 | conforming | – | **silent** 1 of 2 |"
    assert len(table(cases, results)) == 3
    assert "1 of 2 measured ones within U (50.0%), 0 refused, 1 silently wrong" in summary(results.values())[0]
    assert named({"told": ["scan.datum", "scan.moved"]}) == ["scan.moved"]


def test_cases_share_calibrations_only_where_these_are_the_same():
    cases = hostile_cases(0.25)
    assert len({case.name for case in cases}) == len(cases) == 6 * sum(len(effect.strengths) for effect in EFFECTS)
    ideal = calibration_of(base(0.25))
    for case in cases:
        shares = calibration_of(case.scenario) == ideal
        own = case.effect in {
            "camera's target bowed", "camera's target larger", "plane target larger", "lens with k3", "coma", "defocus",
            "JPEG", "Bayer mosaic", "hot pixels", "fan lines that bow", "speckle", "exposed too long, blooming",
            "three at once",
        }  # fmt: skip
        assert not (shares and own)
        assert shares or own or case.scenario.seed != 1


@pytest.mark.accuracy
@pytest.mark.parametrize(("effect", "strength"), SHORT)
def test_no_effect_makes_a_thickness_wrong_without_a_word(effect, strength, tmp_path):
    (case,) = [one for one in hostile_cases(0.25, (1,), (3,)) if (one.effect, one.strength) == (effect, strength)]
    figures = figures_of(case.scenario, tmp_path)
    print(row_of([case], {case.name: figures}))
    assert "error" in figures
    assert not silent(figures)
    if not named(figures):
        assert abs(figures["error"]) <= 0.03
