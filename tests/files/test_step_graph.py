"""One graph of steps: order of work, what goes with what, what a page needs."""

import pytest

from core.files.step_graph import FILES, GRAPH, IN_PROJECT, PAGES, needed_by, resting_on
from core.pipeline.steps.workspace import CLEARED

OF_SURFACE = {"scan", "cloud", "mesh", "profiles", "profile_table", "profile"}
OF_CLOUD = {"gauge", "faces", "inspection", "inspected", "comparison", "compared", "comparison_table"}
OF_SCAN = {"joined", "joint"}
"""Views are joined of scans, never of profiles."""


def test_the_order_of_work_is_that_of_the_graph():
    assert PAGES == ("camera", "planes", "scan", "inspect", "report")
    names = [step.name for step in IN_PROJECT]
    assert names == ["camera", "planes", "check", "scan", "gauge", "inspection", "report"]


def test_every_result_is_made_by_one_step_and_run_json_tells_of_all():
    assert sorted(made for step in GRAPH for made in step.makes) == sorted(set(FILES) - {"run"})


@pytest.mark.parametrize(
    ("result", "gone"),
    [
        ("camera", {"planes", "poses", "calibrated", "check"} | OF_SURFACE | OF_CLOUD | OF_SCAN),
        ("planes", {"calibrated", "check"} | OF_SURFACE | OF_CLOUD | OF_SCAN),
        ("cloud", OF_CLOUD | OF_SCAN),
        ("profiles", OF_CLOUD),
        ("gauge", set()),
        ("report", set()),
    ],
)
def test_what_rests_on_another_result_goes_with_it_but_the_report_stays(result, gone):
    assert set(resting_on(result)) == gone


def test_what_rests_on_another_result_goes_before_it():
    for result in FILES:
        assert all(CLEARED.index(one) < CLEARED.index(result) for one in resting_on(result))


def test_a_page_needs_what_its_first_step_is_made_of_and_shows_what_is_there():
    assert {page: needed_by(page) for page in PAGES} == {
        "camera": (), "planes": ("camera",), "scan": ("camera", "planes"), "inspect": ("scan",), "report": ("scan",),
    }  # fmt: skip
    assert needed_by("report", shown=True) == ("scan", "inspect")
