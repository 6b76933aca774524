"""One number is called the same by terminal, window, PDF, XLSX and the window's CSV, in every language."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from datetime import date
from pathlib import Path
from typing import Any

import pytest
from openpyxl import load_workbook
from openpyxl.cell import Cell
from PySide6.QtWidgets import QApplication

import core.cli.language
import workbench.language
from core.checks.artefact_check import ArtefactCheck
from core.checks.control_chart import ControlChart
from core.cli import output
from core.files.exchange.xlsx import write_xlsx
from core.files.results.rig_history import PastCheck
from core.inspect.characteristic import thickness_characteristic
from core.messages import Message
from core.report.content import ReportContent
from core.report.facts.fact import Fact, Reader, for_reader
from core.report.facts.of_budget import INPUT, input_cells
from core.report.facts.of_checks import ALLOWED_FROM, ALLOWED_TO, check_facts, history_table
from core.report.facts.of_features import HEADS, PERMITTED, characteristic_cells
from core.report.facts.table import Uncertain
from core.report.pdf import build_report
from core.report.wording import Words, shown_unit, with_unit
from tests.check_cases import check
from tests.report.inspection_samples import characteristics, studies
from tests.report.report_samples import block_content
from tests.report.test_report_pdf import words as pdf_words
from tests.workbench.test_facts import BLOCK, squeezed
from workbench.pages.inspect.words import repeats_tsv
from workbench.pages.words import fact_row, show_table
from workbench.views.lists.data_table import DataTable

Sheets = Mapping[str, tuple[tuple[Any, ...], ...]]


@contextmanager
def block_in(language: str) -> Iterator[ReportContent]:
    """A block with all that may be told of it, in a language that terminal and window have as well."""
    with pytest.MonkeyPatch.context() as patched:
        words = Words.of(language)
        patched.setattr(core.cli.language, "_spoken", words.language)
        patched.setattr(workbench.language, "_chosen", words.language)
        known = ArtefactCheck(BLOCK, 50.004, 0.009, date(2026, 3, 14))
        yield block_content(language=language, check=check(), artefacts=(known,), studies=studies())


@pytest.fixture(scope="module", params=["en", "de"])
def content(request: pytest.FixtureRequest) -> Iterator[ReportContent]:
    with block_in(request.param) as known:
        yield known


@pytest.fixture(scope="module")
def words(content: ReportContent) -> Words:
    return Words.of(content.language)


@pytest.fixture(scope="module")
def facts(content: ReportContent) -> tuple[Fact, ...]:
    of_results = [fact for facts in content.facts.values() for fact in facts]
    return (*of_results, *(fact for study in content.studies for fact in study.facts))


@pytest.fixture(scope="module")
def sheets(content: ReportContent, tmp_path_factory: pytest.TempPathFactory) -> Sheets:
    return workbook(content, tmp_path_factory.mktemp("labels") / "r.xlsx")


@pytest.fixture(scope="module")
def printed(content: ReportContent) -> str:
    return squeezed(pdf_words(build_report(content)))


def workbook(content: ReportContent, path: Path) -> Sheets:
    write_xlsx(path, content)
    return {sheet.title: tuple(sheet.iter_rows(values_only=True)) for sheet in load_workbook(path)}


def test_terminal_window_and_csv_call_a_fact_the_same(facts: tuple[Fact, ...], words: Words) -> None:
    names = [words.known(fact.label) for fact in facts]
    assert len(names) > 70
    in_terminal = [output.fact_rows([fact], reader=Reader.METROLOGIST)[0][0] for fact in facts]
    in_window = [fact_row(fact)[0] for fact in facts]
    in_csv = [line.split("\t")[0] for line in repeats_tsv((), facts).splitlines()[2:]]
    for name, fact, *told in zip(names, facts, in_terminal, in_window, in_csv, strict=True):
        coverage, unit = " (95 %)" if fact.interval else "", f" [{fact.unit}]" if fact.unit else ""
        assert [one.casefold() for one in told] == [f"{name}{end}".casefold() for end in (coverage, coverage, unit)]


def test_twenty_numbers_drawn_at_random_have_one_wording_each(
    facts: tuple[Fact, ...], sheets: Sheets, printed: str, words: Words
) -> None:
    """As the tests of single readers, told by number: what each of the five calls it, without unit and coverage."""
    drawn = random.Random(37).sample([fact for fact in for_reader(facts, Reader.AUDITOR) if fact.label != ""], 20)
    in_workbook = {str(row[1]).casefold() for name in ("facts", "studies") for row in sheets[name][1:]}
    counts = []
    for fact in drawn:
        name = words.known(fact.label)
        own = fact.label.values.get("name", fact.label) if isinstance(fact.label, Message) else fact.label
        in_terminal = output.fact_rows([fact], reader=Reader.METROLOGIST)[0][0]
        in_csv = repeats_tsv((), [fact]).splitlines()[2].split("\t")[0].partition(" [")[0]
        said = {one.removesuffix(" (95 %)").casefold() for one in (in_terminal, fact_row(fact)[0], in_csv)}
        said |= {name.casefold()} if name.casefold() in in_workbook else {"another in the workbook"}
        said |= {name.casefold()} if squeezed(words.known(own)) in printed else {"another in the PDF"}
        counts.append((len(said), name))
    print(*(f"{number}  {name}" for number, name in counts), sep="\n")
    assert [number for number, _ in counts] == 20 * [1], counts


def shown_cell(cell: Cell, words: Words, *, signed: bool = False) -> str:
    """A number as a workbook shows it, in full where it was stated."""
    if cell.number_format == "General":
        return words.general(cell.value)
    return words.fixed(cell.value, len(cell.number_format.partition(".")[2]), signed=signed)


def test_twenty_cells_of_tables_drawn_at_random_show_one_number_of_digits(
    content: ReportContent, tmp_path: Path, printed: str, words: Words, qapp: QApplication
) -> None:
    """As its fact has them, whose decimals follow the uncertainty where there is one."""
    write_xlsx(tmp_path / "r.xlsx", content)
    sheet = load_workbook(tmp_path / "r.xlsx")["studies"]
    in_workbook = {(row[0].value, row[1].value): row[2] for row in sheet.iter_rows()}
    tables = [(table.for_reader(Reader.AUDITOR), study) for study in content.studies for table in study.tables]
    cells = [
        (table, study, place, column)
        for table, study in tables
        if table.level <= Reader.AUDITOR
        for place, row in enumerate(table.rows)
        for column, value in enumerate(row)
        if column and isinstance(value, (float, Uncertain))
    ]
    assert any(isinstance(table.rows[place][column], Uncertain) for table, _, place, column in cells)
    for table, study, place, column in random.Random(37).sample(cells, 20):
        fact = table.columns[column].fact(table.rows[place][column])
        number, said = replace(fact, unit="").text(words), f"{words.known(fact.label)} {fact.text(words)}"
        assert said in dict(output.fact_rows((), [table]))[table.lines(words)[place][0]]
        shown = DataTable()
        show_table(shown, table)
        assert shown.rows()[place][column] == number
        assert squeezed("".join(table.texts(words)[place])) in printed
        name = table.lines(words)[place][0]
        cell = in_workbook[study.title(words), f"{name}: {words.known(fact.label)}"]
        assert shown_cell(cell, words, signed=fact.signed) == number


def test_a_characteristic_has_the_digits_of_its_uncertainty_in_the_workbook(
    content: ReportContent, tmp_path: Path, words: Words
) -> None:
    inspected = characteristics()
    shown = block_content(language=content.language, gauge=None, inspected=inspected)
    write_xlsx(tmp_path / "r.xlsx", shown)
    head, *rows = load_workbook(tmp_path / "r.xlsx")["result"].iter_rows()
    place = [cell.value for cell in head].index(words.known("measured"))
    for one, row in zip(inspected, rows, strict=True):
        if isinstance(row[place].value, float):
            assert with_unit(shown_cell(row[place], words), shown_unit(one)[0]) == characteristic_cells(one, words)[2]


def test_a_rigs_history_shows_the_digits_of_its_card(words: Words) -> None:
    """A step that is off by 0.0513 ± 0.21 mm is off by 0.05 mm in both."""
    last, chart = replace(check(), error_mm=0.0513, unseen_mm=0.21), ControlChart(0.0, -0.1234, 0.1234, own=False, n=0)
    of_card = {words.known(fact.label): fact for fact in check_facts(last, chart)}
    table = history_table([(PastCheck.of(last, 21.5), chart)])
    in_table = {words.known(one.label): said for one, said in zip(table.columns, table.texts(words)[0], strict=True)}
    for name in map(words.known, (ALLOWED_FROM, ALLOWED_TO)):
        assert in_table[name] == of_card[name].parts(words)[0]
    step = next(fact for fact in of_card.values() if fact.U is not None)
    assert in_table[words.known("off by")] == step.parts(words)[0] == words.fixed(0.05, 2, signed=True)


def test_the_workbook_calls_each_fact_as_terminal_and_window(
    content: ReportContent, sheets: Sheets, words: Words
) -> None:
    told = [fact for facts in content.facts.values() for fact in facts]
    assert [row[1] for row in sheets["facts"][1:]] == [words.known(fact.label) for fact in told]
    in_studies = {row[1] for row in sheets["studies"][1:]}
    for study in content.studies:
        assert {words.known(fact.label) for fact in study.facts} <= in_studies
        for table in study.tables:
            for column in table.columns[1:]:
                assert any(name.endswith(f": {words.known(column.label)}") for name in in_studies), column.label


def test_the_pdf_calls_what_an_auditor_reads_the_same(facts: tuple[Fact, ...], printed: str, words: Words) -> None:
    for fact in for_reader(facts, Reader.AUDITOR):
        name = fact.label.values.get("name", fact.label) if isinstance(fact.label, Message) else fact.label
        assert squeezed(words.known(name)) in printed, fact.label


def test_the_workbooks_budget_has_the_words_of_the_pdf(
    content: ReportContent, sheets: Sheets, printed: str, words: Words
) -> None:
    assert content.gauge is not None
    one = thickness_characteristic(content.gauge)
    head, *rows = sheets["budget"]
    for label in (INPUT, *(fact.label for fact in input_cells(one)[0])):
        name = words.known(label)
        assert name in head and squeezed(name) in printed
    assert [row[head.index(words.known(INPUT))] for row in rows] == [words(row.words) for row in one.budget]
    assert {row[head.index(words.known("distribution"))] for row in rows} == {
        words.known(row.distribution) for row in one.budget
    }


def test_the_workbooks_results_have_the_words_of_terminal_and_pdf(
    content: ReportContent, tmp_path: Path, words: Words
) -> None:
    inspected = characteristics()
    shown = workbook(block_content(language=content.language, gauge=None, inspected=inspected), tmp_path / "r.xlsx")
    head, *rows = shown["result"]
    assert {words.known(name) for name in ("characteristic", *HEADS) if name != PERMITTED} <= set(head)
    assert rows[0][head.index(words.known("measured"))] == pytest.approx(inspected[0].value, rel=1e-15)
    assert rows[0][head.index(words.known("lower limit"))] == pytest.approx(49.8)
