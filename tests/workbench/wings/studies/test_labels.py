"""The tests of labels on a report with a study of each kind."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

from core.report.content import ReportContent
from tests.wings.studies.samples import reported
from tests.workbench import test_labels
from tests.workbench.test_labels import (
    facts,
    printed,
    sheets,
    test_terminal_window_and_csv_call_a_fact_the_same,
    test_the_pdf_calls_what_an_auditor_reads_the_same,
    test_the_workbook_calls_each_fact_as_terminal_and_window,
    test_twenty_cells_of_tables_drawn_at_random_show_one_number_of_digits,
    test_twenty_numbers_drawn_at_random_have_one_wording_each,
    words,
)

__all__ = [
    "facts",
    "printed",
    "sheets",
    "test_terminal_window_and_csv_call_a_fact_the_same",
    "test_the_pdf_calls_what_an_auditor_reads_the_same",
    "test_the_workbook_calls_each_fact_as_terminal_and_window",
    "test_twenty_cells_of_tables_drawn_at_random_show_one_number_of_digits",
    "test_twenty_numbers_drawn_at_random_have_one_wording_each",
    "words",
]


@pytest.fixture(scope="module", params=["en", "de"])
def content(request: Any) -> Iterator[ReportContent]:
    """As that of the house, in a language that terminal and window have as well."""
    with test_labels.block_in(request.param) as known:
        yield replace(known, studies=reported())
