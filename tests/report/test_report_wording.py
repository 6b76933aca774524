import math

import numpy as np
import pytest

from core.inspect.characteristic import Characteristic
from core.inspect.conformity import Limits
from core.inspect.results import Face, GaugeResult
from core.messages import decimals_of, plain
from core.model import LightPlane
from core.report.wording import (
    Words,
    decision_sentence,
    fixed,
    grouped,
    headed_name,
    limits_of_thickness,
    name_within,
    points_counted,
    shown_name,
    thickness_line,
    tolerance_words,
    uncertainty_sentence,
    value_line,
    verdict_sentence,
)
from core.translations import PSEUDO


def gauge(thickness, u, k=2.0, **more):
    face = Face(LightPlane([0, 0, 0.002]), np.zeros(0, np.int64), np.zeros(0), 0.0, 0.0)
    return GaugeResult(thickness, u, k, face, face, 0.0, (), **({"doubts": ()} | more))


@pytest.mark.parametrize(
    ("thickness", "u", "expected"),
    [
        (50.01234, 0.0119, "50.012 mm ± 0.024 mm (k = 2)"),
        (50.01234, 0.0498, "50.01 mm ± 0.10 mm (k = 2)"),  # 0.0996 has two digits as 0.10
        (49.9996, 0.005, "50.000 mm ± 0.010 mm (k = 2)"),
        (50.01234, 0.00061, "50.0123 mm ± 0.0012 mm (k = 2)"),
        (50.4, 6.2, "50 mm ± 12 mm (k = 2)"),
        (50.4, 620.0, "100 mm ± 1200 mm (k = 2)"),
        (50.4, float("inf"), "50.400 mm (uncertainty unknown)"),
    ],
)
def test_uncertainty_has_two_digits_and_the_value_as_many_decimals(thickness, u, expected):
    assert thickness_line(gauge(thickness, u)) == expected


def test_no_uncertainty_or_zero_falls_back_to_micrometres():
    assert [decimals_of(value) for value in (0.0, float("nan"), -1.0)] == [3, 3, 3]


def test_signs_are_true_minus_and_there_is_no_minus_zero():
    assert fixed(-0.0123, 3, signed=True) == "−0.012"
    assert fixed(0.0123, 3, signed=True) == "+0.012"
    assert fixed(-0.0001, 3, signed=True) == "0.000"
    assert fixed(float("nan"), 3) == "unknown"


def test_thousands_do_not_break():
    assert grouped(1234567) == "1\u00a0234\u00a0567"


def test_coverage_is_only_claimed_for_known_factors():
    assert "about 95 %" in uncertainty_sentence(2.0, 0.02)
    assert "about" not in uncertainty_sentence(2.37, 0.02)
    assert "k = 2.37" in uncertainty_sentence(2.37, 0.02)


@pytest.mark.parametrize(
    ("thickness", "expected"),
    [
        (50.05, "0.050 mm from the nominal value, enlarged by U = 0.020 mm, stays within"),
        (49.7, "0.300 mm from the nominal value, even lessened by U = 0.020 mm, is outside"),
        (50.19, "inside the interval of 0.190 mm ± 0.020 mm"),
    ],
)
def test_verdict_states_the_numbers_that_decide(thickness, expected):
    measured = gauge(thickness, 0.01, nominal_mm=50.0, tolerance_mm=0.2)
    assert expected in verdict_sentence(measured)
    assert "±0.2\u00a0mm" in verdict_sentence(measured)


def test_no_nominal_value_no_verdict():
    assert "without a verdict" in verdict_sentence(gauge(50, 0.01))


def test_what_the_thickness_is_follows_the_rule_of_the_fit():
    assert "distance of two parallel planes" in limits_of_thickness(gauge(50, 0.01))[0]
    ruled = gauge(50, 0.01, rule=plain("distance of two parallel lines in one light profile"))
    assert limits_of_thickness(ruled)[0].startswith("The thickness is the distance of two parallel lines in one light")


INF = math.inf


@pytest.mark.parametrize(
    ("limits", "english", "german"),
    [
        (Limits(50, -0.2, 0.2), "±0.2\u00a0mm", "±0,2\u00a0mm"),
        (Limits(50, -0.1, 0.3), "−0.1 to +0.3\u00a0mm", "−0,1 bis +0,3\u00a0mm"),
        (Limits(50, 0, 0.3), "0 to +0.3\u00a0mm", "0 bis +0,3\u00a0mm"),
        (Limits(50, -INF, 0.05), "at most +0.05\u00a0mm", "höchstens +0,05\u00a0mm"),
        (Limits(0, -INF, 0.05), "at most 0.05\u00a0mm", "höchstens 0,05\u00a0mm"),
        (Limits(0, -0.05, INF), "at least −0.05\u00a0mm", "mindestens −0,05\u00a0mm"),
        (Limits(0, -INF, INF), "", ""),
        (None, "", ""),
    ],
)
def test_permitted_deviations_are_said_as_they_are_asked(limits, english, german):
    one = Characteristic("a", "thickness", 50.0, 0.01, limits=limits, doubts=())
    assert (tolerance_words(one), tolerance_words(one, Words.of("de"))) == (english, german)


@pytest.mark.parametrize(
    ("name", "kind", "english", "chinese", "pseudo"),
    [
        ("block thickness", "thickness", "thickness", "厚度", "⟦⟦ţĥííçķñééšš⟧⟧"),
        ("block height 2", "height", "height 2", "高度 2", "⟦⟦ĥééííĝĥţ⟧ 2⟧"),
        ("block height of the rib", "height", *3 * ["height of the rib"]),
        ("thickness", "thickness", "thickness", "厚度", "⟦⟦ţĥííçķñééšš⟧⟧"),
    ],
)
def test_under_its_feature_a_result_is_called_by_its_kind_or_by_its_users_name(name, kind, english, chinese, pseudo):
    one = Characteristic(name, kind, 50.0, 0.01, doubts=())
    said = [name_within(one, "block", Words.of(language)) for language in ("en", "zh_CN", PSEUDO)]
    assert said == [english, chinese, pseudo]


def test_an_angle_is_said_in_degrees():
    limits = Limits(math.radians(90), math.radians(-0.2), math.radians(0.2))
    one = Characteristic("a", "angle", math.radians(89.95), math.radians(0.02), "angle", limits=limits, doubts=())
    assert value_line(one) == "89.950° ± 0.040° (k = 2)"
    assert tolerance_words(one) == "±0.2°"
    assert "deviation of 0.050° from the nominal value, enlarged by U = 0.040°" in decision_sentence(one)


def test_german_numbers_have_a_comma_and_thousands_do_not_break():
    words = Words.of("de")
    assert (words.fixed(-0.0123, 3, signed=True), words.general(0.25), words(points_counted(1204))) == (
        "−0,012", "0,25", "1\u00a0204 Punkte")  # fmt: skip


def test_very_small_values_are_said_with_a_power_of_ten():
    assert [Words().general(value) for value in (1.15e-5, 0.0002, 1e9, 20.4)] == [
        "1.15·10⁻⁵",
        "0.0002",
        "1·10⁹",
        "20.4",
    ]


@pytest.mark.parametrize(
    ("name", "kind", "german"),
    [
        ("thickness", "thickness", "Dicke"),
        ("top flatness", "flatness", "top Ebenheit"),
        ("stairs height 2", "height", "stairs Höhe 2"),
        ("the height of all", "height", "the height of all"),
        ("outheight", "height", "outheight"),
        ("profile 1 groove", "height", "profile 1 groove"),
    ],
)
def test_what_a_result_is_stands_in_the_reports_language_and_names_that_people_gave_stay(name, kind, german):
    assert shown_name(Characteristic(name, kind, 1.0, 0.1, doubts=()), Words.of("de")) == german


def test_a_name_that_begins_a_line_is_a_title_but_not_one_that_somebody_typed():
    assert headed_name(Characteristic("thickness", "thickness", 50.0, 0.1, doubts=())) == "Thickness"
    assert headed_name(Characteristic("top flatness", "flatness", 0.1, 0.1, doubts=())) == "top flatness"
