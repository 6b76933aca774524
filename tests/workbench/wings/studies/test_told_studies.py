"""Each kind of study is told in the same words in the terminal, the window, the PDF and the workbook."""

import io
import re

import pytest
from openpyxl import load_workbook
from pypdf import PdfReader

from core.cli import talk
from core.files.exchange.records import FACT_COLUMNS, finite
from core.files.exchange.xlsx import write_xlsx
from core.messages import Message, unparted
from core.report.facts.fact import Reader, for_reader, heading
from core.report.facts.table import tables_for_reader
from core.report.pdf import build_report
from core.report.template import SECTIONS
from core.report.wording import ENGLISH
from core.wings.studies.kinds.study import KINDS, kind_of
from core.wings.studies.printed import printed
from core.wings.studies.study_facts import study_facts, study_tables, study_title
from core.wings.studies.studying import study_rows
from tests.wings.studies.samples import studied_content, studies
from workbench.pages.words import show_facts, show_table
from workbench.views.lists.data_table import DataTable
from workbench.views.lists.value_rows import ValueRows

STUDIES = {kind_of(one): one for one in studies()}


@pytest.fixture(params=KINDS)
def study(request):
    return STUDIES[request.param]


@pytest.fixture
def verbose():
    before = talk.loudness()
    talk.choose(talk.Loudness.VERBOSE)
    yield
    talk.choose(before)


def said(facts):
    return [(fact.title(ENGLISH), fact.text(ENGLISH)) for fact in facts]


def lines(tables):
    return [line for table in tables for line in table.lines(ENGLISH)]


def test_the_terminal_tells_all_to_a_metrologist(study, verbose):
    rows = study_rows(study)
    assert rows == [("study", study_title(study)), *said(study_facts(study)), *lines(study_tables(study))]


def test_the_terminal_tells_others_what_an_auditor_needs(study):
    rows = study_rows(study)
    told = tables_for_reader(study_tables(study), Reader.AUDITOR)
    assert rows[1:] == [*said(for_reader(study_facts(study), Reader.AUDITOR)), *lines(told)]
    assert rows[1][0] == "verdict"


def test_the_window_has_in_sight_what_a_technician_needs_and_folds_the_rest(study, qtbot):
    rows, table = ValueRows(), DataTable()
    for widget in (rows, table):
        qtbot.addWidget(widget)
    facts, tables = study_facts(study), study_tables(study)
    show_facts(rows, facts, tables[1:])
    rows.show()
    in_sight = [name.text() for name, _, _ in rows._labels if name.isVisible()]
    assert in_sight == [fact.heading(ENGLISH) for fact in facts if fact.level is Reader.TECHNICIAN]
    assert 1 <= len(in_sight) <= 5 and in_sight[0] == "Verdict"
    rows.more.setChecked(True)
    shown = {(name.text().casefold(), text.text()) for name, text, _ in rows._labels if name.isVisible()}
    assert shown == {(name.casefold(), text) for name, text in (*said(facts), *lines(tables[1:]))}
    for first in tables[:1]:
        show_table(table, first)
        texts = first.for_reader(Reader.AUDITOR).texts(ENGLISH)
        assert table.rows() == tuple(tuple(map(unparted, row)) for row in texts)


def test_the_pdf_prints_what_an_auditor_needs(study):
    content = studied_content(studies=(printed(study),), hidden=frozenset(SECTIONS) - {"studies"})
    pages = [page.extract_text() for page in PdfReader(io.BytesIO(build_report(content))).pages]
    text = re.sub(r"\s+", " ", " ".join(pages))
    text_of_it = text[text.index(study_title(study)) :]
    for name, value in said(for_reader(study_facts(study), Reader.AUDITOR)):
        assert heading(name) in text_of_it and value.replace("\u00a0", " ") in text_of_it
    for table in tables_for_reader(study_tables(study), Reader.AUDITOR):
        for row in table.texts(ENGLISH):
            assert " ".join(" ".join(row).split()) in text_of_it
    for fact in study_facts(study):
        short = len(fact.title(ENGLISH)) < 3
        assert fact.level < Reader.METROLOGIST or short or fact.heading(ENGLISH) not in text_of_it


def test_the_workbook_has_every_fact_with_its_number_in_full(study, tmp_path):
    write_xlsx(tmp_path / "r.xlsx", studied_content(studies=(printed(study),)))
    head, *rows = load_workbook(tmp_path / "r.xlsx")["studies"].iter_rows(values_only=True)
    told = [*study_facts(study), *(fact for table in study_tables(study) for fact in table.facts(ENGLISH))]
    assert head == FACT_COLUMNS and {row[0] for row in rows} == {study_title(study)}
    assert [row[1] for row in rows] == [str(fact.label) for fact in told]
    for row, fact in zip(rows, told, strict=True):
        value = finite(fact.value) if isinstance(fact.value, float) else fact.value
        words = isinstance(value, (str, Message))
        assert row[2] == (str(value) if words else value if value is None else pytest.approx(value, rel=1e-14))
        assert row[7:] == (fact.unit or None, int(fact.level))


def test_a_workbook_of_no_study_has_no_sheet_of_them(tmp_path):
    write_xlsx(tmp_path / "r.xlsx", studied_content(studies=()))
    assert "studies" not in load_workbook(tmp_path / "r.xlsx").sheetnames
