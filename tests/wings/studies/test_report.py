"""A report with a study of each kind."""

import pytest

from core.report.pdf import build_report
from core.translations import PSEUDO
from tests.report.test_report_inspection import words
from tests.report.test_report_pseudo import spoken, test_every_text_of_a_report_comes_from_the_catalogues
from tests.wings.studies.samples import studied_content

__all__ = ["spoken", "test_every_text_of_a_report_comes_from_the_catalogues"]


@pytest.fixture(scope="module")
def content():
    return studied_content(language=PSEUDO)


@pytest.fixture(scope="module")
def data():
    return build_report(studied_content())


def test_studies_are_printed_with_figures_and_notes(data):
    text = words(data)
    assert "Type-1 study Verdict Cg (95 %) Cgk Bias (95 %) s (n − 1) Repeats" in text
    assert "source of variation σ, mm share of σ², % of the total, % of T, %" in text
    assert "Gauge R&R Verdict %GRR of T (95 %) %GRR of the total (95 %) Categories (ndc)" in text
    assert "is pooled with the error" in text
    assert "Repeats: thickness Verdict Repeats Mean s (n − 1) Nominal Bias conforming 12 50.00" in text
    assert "contribution to U of the mean u, mm share of u², %" in text
    assert "quantity positions largest error, mm at limit, mm verdict" in text
    assert "probing error, form 10 +0.0290 p9 0.05 conforming" in text
    assert "probing error, size 4 +0.0100 p0 0.012 conforming" in text
    assert "4 of the 10 positions the guideline asks for" in text


def test_the_same_studies_give_the_same_bytes(data):
    assert build_report(studied_content()) == data
