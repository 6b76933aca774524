"""What is told of each result is told in the same words by terminal, window, PDF and XLSX."""

from __future__ import annotations

import re
from datetime import date
from pathlib import Path

import pytest
from openpyxl import load_workbook
from PySide6.QtWidgets import QApplication

from core.checks.artefact_check import Artefact, ArtefactCheck
from core.cli import output
from core.files.exchange.xlsx import write_xlsx
from core.messages import Message
from core.report.content import ReportContent
from core.report.facts.fact import Reader, for_reader
from core.report.pdf import build_report
from core.report.wording import Words
from tests.check_cases import check
from tests.report.report_samples import block_content
from tests.report.test_report_pdf import words as pdf_words
from workbench.pages.words import show_facts
from workbench.views.lists.value_rows import ValueRows

WORDS = Words()
BLOCK = Artefact("GB 50-7", 50.0003, 0.0004, 2.0, "D-K-15070 2026-03")


@pytest.fixture(scope="module")
def content() -> ReportContent:
    """A block, measured with a rig that was checked by pictures and by a known artefact."""
    known = ArtefactCheck(BLOCK, 50.004, 0.009, date(2026, 3, 14))
    return block_content(check=check(), artefacts=(known,))


@pytest.fixture(scope="module")
def printed(content: ReportContent) -> str:
    return squeezed(pdf_words(build_report(content)))


def squeezed(text: str) -> str:
    """Without spaces: where a line is broken is of no account."""
    return re.sub(r"\s", "", text).lower()


@pytest.mark.parametrize("of", ["camera", "planes", "check", "artefact", "scan", "thickness"])
def test_each_reader_tells_the_facts_of_its_level_in_the_same_words(
    of: str, content: ReportContent, printed: str, tmp_path: Path, qapp: QApplication
) -> None:
    facts = content.facts[of]
    assert facts
    in_short, in_full = for_reader(facts, Reader.AUDITOR), facts
    assert output.fact_rows(facts) == [(fact.title(WORDS), fact.text(WORDS)) for fact in in_short]
    shown = ValueRows()
    show_facts(shown, facts)
    for fact in in_full:
        assert shown.text_of(fact.heading(WORDS)) == fact.text(WORDS)
    for fact in in_short:
        name = fact.label.values.get("name", fact.label) if isinstance(fact.label, Message) else fact.label
        for part in (WORDS.known(name), *fact.parts(WORDS)):
            assert squeezed(part) in printed, (fact.title(WORDS), part)
    write_xlsx(tmp_path / "r.xlsx", content)
    rows = list(load_workbook(tmp_path / "r.xlsx")["facts"].iter_rows(min_row=2, values_only=True))
    kept = [(name, unit, level) for of_, name, _, _, _, _, _, unit, level in rows if of_ == of]
    assert kept == [(str(fact.label), fact.unit or None, int(fact.level)) for fact in facts]
