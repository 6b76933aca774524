"""Each fact by which nothing is proven, set by hand in turn, arrives in the verdict of whoever shows a result."""

import json
from dataclasses import replace
from types import SimpleNamespace

import pytest

from core.files.results.gauge_file import read_thickness, write_gauge
from core.findings.of_proof import REASONS
from core.findings.proof import Doubt
from core.inspect.characteristic import Characteristic
from core.inspect.conformity import Limits
from tests.pipeline.project.test_one_verdict import CONTENT
from tests.report.report_samples import block_content
from workbench.pages.inspect.panels import ResultPanel
from workbench.step_state import State

NAME = "step height"


@pytest.fixture(scope="module")
def content():
    """A thickness and the height of a step, both well within their limits."""
    step = Characteristic(NAME, "height", 10.0, 0.005, limits=Limits(10.0, -0.05, 0.05), doubts=())
    return replace(block_content(), inspected=(step,))


def doubted(content, fact):
    """The same by a fact, which both results have from their scan."""
    doubts = (Doubt.named(fact),)
    rows = tuple(replace(one, doubts=doubts) for one in content.inspected)
    return replace(content, gauge=replace(content.gauge, doubts=doubts), inspected=rows)


@pytest.mark.parametrize("reader", CONTENT)
def test_without_any_doubt_all_of_it_conforms(reader, content, tmp_path):
    rows, verdict = CONTENT[reader](content, tmp_path)
    assert rows == {"thickness": "conforming", NAME: "conforming"} and verdict in ("conforming", "")


@pytest.mark.parametrize("fact", REASONS)
@pytest.mark.parametrize("reader", CONTENT)
def test_each_fact_takes_away_the_proof_in_report_tables_and_files_for_others(reader, fact, content, tmp_path):
    rows, verdict = CONTENT[reader](doubted(content, fact), tmp_path)
    assert rows == {"thickness": "not proven", NAME: "not proven"} and verdict in ("not proven", "")


@pytest.mark.parametrize("fact", REASONS)
def test_each_fact_takes_away_the_proof_in_the_file_and_for_who_reads_it(fact, content, tmp_path):
    path = tmp_path / "gauge.json"
    write_gauge(path, content.gauge, "")
    assert read_thickness(path).verdict == "conforming"
    write_gauge(path, doubted(content, fact).gauge, "")
    file = json.loads(path.read_text(encoding="utf-8"))
    assert (file["verdict"], file["complete"], file["doubts"]) == ("not proven", False, [fact])
    assert read_thickness(path).verdict == "not proven"
    assert [doubt.fact for doubt in read_thickness(path).doubts] == [fact]


@pytest.mark.parametrize("fact", ["", *REASONS])
def test_each_fact_takes_away_the_proof_in_the_window(fact, content, qtbot):
    gauge = doubted(content, fact).gauge if fact else content.gauge
    presenter = SimpleNamespace(scan=SimpleNamespace(gauge=gauge, serial=1), state=SimpleNamespace(state=State.DONE))
    panel = ResultPanel(presenter)
    qtbot.addWidget(panel)
    panel.refresh()
    assert panel.verdict.text == ("Not proven" if fact else "Conforming")
