"""Why U is as large as it is, and what helps."""

import math

import pytest

from core.inspect.causes import Cause
from core.inspect.characteristic import Characteristic
from core.inspect.results import Contribution
from core.messages import NO_BREAK_SPACE, plain
from core.translations import language
from tests.workbench.pages import inspect_cases as cases
from workbench.language import choose
from workbench.pages.inspect.features.plan import THICKNESS
from workbench.pages.inspect.largest import HELPS, why_so_large
from workbench.pages.inspect.page import InspectPage
from workbench.views.layouts import FewLines

COLUMN_PX = 345
"""Of the side at 1280 pixels."""
LONGEST = {Cause.LIGHT_FROM_BELOW_ASSUMED, Cause.SCALE_TEMPERATURE_ASSUMED}
"""Causes whose names alone take two lines: their tip tells the rest."""


def characteristic(*budget: Contribution) -> Characteristic:
    u = math.sqrt(sum(row.u_mm**2 for row in budget))
    return Characteristic("thickness", "thickness", 50.0, u, budget=budget, doubts=())


def test_the_largest_row_is_named_with_its_share_and_what_helps() -> None:
    said = why_so_large(characteristic(Contribution(Cause.CAMERA, 0.003), Contribution(Cause.SCALE_ASSUMED, 0.004)))
    assert said == (
        "Largest part of U, 64 % of U²: scale of the targets (assumed). "
        "State how the plate was made, on the Laser planes page."
    )


@pytest.mark.parametrize("budget", [(), (Contribution(Cause.CAMERA, 0.0),), (Contribution(Cause.CAMERA, math.inf),)])
def test_where_it_is_not_known_nothing_is_said(budget) -> None:
    assert why_so_large(characteristic(*budget)) == ""


def test_a_cause_of_a_plan_has_no_help_but_its_name() -> None:
    assert why_so_large(characteristic(Contribution(plain("my own reason"), 0.1))).endswith(": my own reason.")


def test_what_is_assumed_can_be_stated() -> None:
    assumed = {one for one in Cause if one.name.endswith("_ASSUMED")}
    of_boards = {Cause.KNOWN_FLATNESS_ASSUMED, Cause.KNOWN_SIZE_ASSUMED}  # stated in rig.toml, as boards are
    of_joints = {Cause.JOINT_TEMPERATURE_ASSUMED, Cause.JOINT_DEPTH_BIAS_ASSUMED}  # no page shows a joint
    assert assumed - HELPS.keys() == {Cause.SCALE_EXPANSION_ASSUMED, Cause.SPRAY_ASSUMED, *of_boards, *of_joints}


def test_it_stands_below_the_list_without_scrolling_until_the_thickness_is_out_of_date(
    hand_bench, measuring, quick, tmp_path, qtbot, show_page
) -> None:
    presenter = cases.entered(hand_bench, tmp_path / "project", cases.project(nominal_mm=50.0, tolerance_mm=0.2), qtbot)
    page: InspectPage = show_page(presenter)
    presenter.features.choose(THICKNESS)
    page.refresh()
    said = "Largest part of U, 100 % of U²: camera calibration. More views that fill the picture"
    assert page.features.state.text().startswith(said)
    assert page.result.largest.text().replace(NO_BREAK_SPACE, " ").startswith(said)
    presenter.faces.set_number("tolerance_mm", 0.3)
    page.refresh()
    assert "Largest" not in page.features.state.text()


def test_it_is_told_whole_in_every_language_beside_a_column_of_the_smallest_window(qtbot, qapp) -> None:
    label = FewLines(3, steady=True)
    qtbot.addWidget(label)
    label.resize(COLUMN_PX, 60)
    try:
        for name in ("en", "de", "zh_CN"):
            choose(language(name), qapp)
            for cause in HELPS.keys() - LONGEST:
                label.setText(why_so_large(characteristic(Contribution(cause, 1.0), Contribution(plain("x"), 0.5))))
                assert label.toolTip() == "", label.text()
    finally:
        choose(language("en"), qapp)
