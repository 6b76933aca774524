"""Decisions against the published examples of JCGM 106 and the rules of ISO 14253-1."""

import math

import numpy as np
import pytest
from scipy.special import ndtr

from core.findings.proof import Doubt
from core.inspect.causes import Cause
from core.inspect.characteristic import Characteristic
from core.inspect.conformity import Limits, Zones, decide
from core.inspect.results import Contribution, Face, GaugeResult
from core.inspect.uncertainty.coverage import coverage_factor, effective_dof
from core.model import LightPlane


@pytest.mark.parametrize(
    ("deviation", "U", "verdict"),
    [
        (0.0, 0.1, "conforming"),
        (-0.1, 0.1, "conforming"),
        (0.11, 0.1, "not proven"),
        (-0.29, 0.1, "not proven"),
        (0.31, 0.1, "not conforming"),
        (-0.21, 0.0, "not conforming"),
        (0.0, 0.3, "not proven"),
    ],
)
def test_decision_rule(deviation, U, verdict):
    assert decide(deviation, Limits(0, -0.2, 0.2), U, ()) == verdict


@pytest.mark.parametrize(
    ("value", "U", "doubts"), [(math.nan, 0.1, ()), (50.0, math.nan, ()), (50.0, 0.1, (Doubt.named("moved"),))]
)
def test_what_is_not_known_or_doubted_proves_nothing_whatever_the_numbers(value, U, doubts):
    assert decide(value, Limits(50, -0.2, 0.2), U, doubts) == "not proven"
    assert decide(value, None, U, doubts) == ""


@pytest.mark.parametrize("tolerance", [0.0, -1.0])
def test_a_thickness_has_no_tolerance_that_is_not_above_zero(tolerance):
    face = Face(LightPlane.from_normal([0, 0, 1.0], 600.0), np.arange(0), np.empty(0), 0.01, 0.01)
    with pytest.raises(ValueError, match="no decision"):
        GaugeResult(50.0, 0.01, 2.0, face, face, 0.0, (), 50.0, tolerance, doubts=())


@pytest.mark.parametrize(("r", "risk"), [(1.0, 0.023), (0.83, 0.05), (0.0, 0.5)])
def test_at_the_edge_of_the_conformance_zone_the_risk_is_that_of_ilac_g8(r, risk):
    zones = Zones(-math.inf, 0.2, 0.1, r)  # U = 0.1 of k = 2
    edge = zones.conformance[1]
    assert decide(edge, Limits(0, -math.inf, 0.2), 0.1, (), r=r) == "conforming"
    assert ndtr((edge - 0.2) / 0.05) == pytest.approx(risk, abs=0.002)  # u = U/2; JCGM 106:2012, clause 7


def test_the_zones_join_without_gap_and_decide_as_the_verdict_does():
    zones = Zones(-0.2, 0.3, 0.05, 0.8)
    assert zones.guard_band == pytest.approx(0.04)
    assert zones.conformance == pytest.approx((-0.16, 0.26))
    assert zones.nonconformance == pytest.approx((-0.24, 0.34))
    assert np.ravel(zones.uncertainty) == pytest.approx([-0.24, -0.16, 0.26, 0.34])
    for value, verdict in [(0.26, "conforming"), (0.27, "not proven"), (0.35, "not conforming"), (-0.17, "not proven")]:
        assert decide(value, Limits(0, -0.2, 0.3), 0.05, (), r=0.8) == verdict


def test_one_limit_has_one_zone_of_uncertainty():
    assert np.ravel(Zones(-math.inf, 0.1, 0.02).uncertainty) == pytest.approx([0.08, 0.12])
    assert np.ravel(Zones(0.1, math.inf, 0.02).uncertainty) == pytest.approx([0.08, 0.12])


def test_an_uncertainty_wider_than_the_tolerance_proves_no_conformity_at_all():
    zones = Zones(-0.1, 0.1, 0.15)
    assert zones.conformance is None
    assert zones.uncertainty == (pytest.approx((-0.25, 0.25)),)
    assert [decide(value, Limits(0, -0.1, 0.1), 0.15, ()) for value in (0.0, 0.2, 0.3)] == [
        "not proven",
        "not proven",
        "not conforming",
    ]


@pytest.mark.parametrize(
    ("lower", "upper", "U", "r"), [(0.1, -0.1, 0.0, 1), (0, 1, -1, 1), (0, 1, math.nan, 1), (0, 1, 1, -1)]
)
def test_no_zones_of_nonsense(lower, upper, U, r):
    with pytest.raises(ValueError, match="no decision"):
        Zones(lower, upper, U, r)


@pytest.mark.parametrize(
    ("dof", "k95", "k9545", "k99"),
    [(1, 12.71, 13.97, 63.66), (10, 2.23, 2.28, 3.17), (50, 2.01, 2.05, 2.68), (math.inf, 1.960, 2.000, 2.576)],
)
def test_the_coverage_factor_is_that_of_table_G_2(dof, k95, k9545, k99):
    found = [coverage_factor(dof, p) for p in (0.95, 0.9545, 0.99)]
    assert found == pytest.approx([k95, k9545, k99], abs=0.0051)


def test_a_rounding_error_does_not_cost_a_degree_of_freedom():
    assert (
        coverage_factor(effective_dof([Contribution(Cause.CAMERA, 0.002, dof=8)]))
        == coverage_factor(8)
        < coverage_factor(7)
    )


def test_freedom_of_known_contributions_is_infinite_and_of_one_its_own():
    assert effective_dof([Contribution(Cause.CAMERA, 0.1), Contribution(Cause.CAMERA, 0.2)]) == math.inf
    assert effective_dof([Contribution(Cause.CAMERA, 0.1, dof=7)]) == pytest.approx(7)
    assert effective_dof([]) == math.inf
    with pytest.raises(ValueError, match="no coverage factor"):
        coverage_factor(0.5)


@pytest.mark.parametrize(
    ("value", "limits", "room"),
    [
        (50.1, Limits(50.0, -0.2, 0.2), 0.4),
        (50.25, Limits(50.0, -0.2, 0.2), -0.35),
        (0.03, Limits(0.0, -math.inf, 0.05), 0.0),
        (50.0, Limits(50.0, -math.inf, math.inf), math.inf),
        (50.0, None, math.inf),
        (math.nan, Limits(50.0, -0.2, 0.2), -math.inf),
    ],
)
def test_the_room_that_is_left_to_a_limit_tells_which_result_is_the_worst(value, limits, room):
    assert Characteristic("one", "thickness", value, 0.01, limits=limits, doubts=()).room == pytest.approx(room)
