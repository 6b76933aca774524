"""A check by a known artefact: E_n, its verdict, and a certificate that lapses."""

from dataclasses import replace
from datetime import date

import pytest

from core.checks.artefact_check import CHECKED, Artefact, ArtefactCheck
from core.findings.of_proof import REASONS
from core.findings.proof import Doubt

BLOCK = Artefact("GB 50-7", 50.0003, 0.0004, 2.0, "D-K-15070", date(2028, 3, 1))
MEASURED = ArtefactCheck(BLOCK, 50.0203, 0.015, date(2026, 5, 4))


def test_the_normalised_error_is_the_error_over_both_expanded_uncertainties():
    assert MEASURED.e_n == pytest.approx(0.02 / (0.03**2 + 0.0004**2) ** 0.5)
    wider = replace(MEASURED, artefact=replace(BLOCK, U_mm=0.06, k=3.0))
    assert wider.e_n == pytest.approx(0.02 / (0.03**2 + 0.04**2) ** 0.5), "k of the certificate counts"


@pytest.mark.parametrize(
    ("error", "verdict"), [(0.029, "passed"), (-0.029, "passed"), (0.031, "failed"), (-0.031, "failed")]
)
def test_an_error_beyond_both_uncertainties_fails(error, verdict):
    check = replace(MEASURED, measured_mm=BLOCK.value_mm + error)
    assert check.verdict == verdict and check.sentence.code == f"artefact.{verdict}"


def test_the_probability_is_that_of_k_2_at_the_limit():
    assert replace(MEASURED, measured_mm=BLOCK.value_mm + 2 * MEASURED.u_error_mm).p == pytest.approx(0.0455, abs=1e-4)


@pytest.mark.parametrize(("fact", "verdict"), [("moved", "doubtful"), ("size_unconfirmed", "passed")])
def test_an_artefact_in_a_scan_that_proves_nothing_clears_up_nothing(fact, verdict):
    """But for the doubts that it is measured to clear up; and an error too large is one whatever moved."""
    check = replace(MEASURED, measured_mm=50.0003, doubts=(Doubt.named(fact),))
    assert check.verdict == verdict
    assert ("something moved during the scan" in str(check.sentence)) is (verdict == "doubtful")
    assert replace(check, measured_mm=51.0).verdict == "failed"


def test_every_fact_that_an_artefact_clears_up_is_a_known_one():
    assert set(REASONS) > CHECKED


def test_a_lapsed_certificate_is_no_passed_check():
    assert replace(MEASURED, day=date(2028, 3, 1)).verdict == "passed", "the last day"
    late = replace(MEASURED, day=date(2028, 3, 2))
    assert late.verdict == "doubtful" and late.sentence.code == "artefact.lapsed"
    assert replace(late, artefact=replace(BLOCK, due=None)).verdict == "passed", "nothing stated, no limit"
    assert replace(late, measured_mm=50.1).verdict == "failed", "what is wrong is told first"
