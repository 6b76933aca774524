"""The scan compared with another surface: from the choice of a file to colours, rows and back."""

from pathlib import Path
from typing import cast

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QCheckBox

from core.wings.geometry.comparison.shown import Changed, ShownComparison
from tests.workbench.hand_lane import HandLane
from tests.workbench.pages import inspect_cases as cases
from workbench.pages.inspect.page import InspectPage
from workbench.views import ask
from workbench.views.scene.contents import Marks
from workbench.wings.geometry.buttons import ComparisonFacts, comparison_buttons
from workbench.wings.geometry.jobs import FORGET_COMPARISON, SHOW_COMPARISON
from workbench.work import jobs

LEFT = Qt.MouseButton.LeftButton
OTHER_FILE = Path("/somewhere/before.ply")
LAYER = "layer comparison"


def compared() -> ShownComparison:
    """Every fourth point is lower by 0.1 mm, significantly; the first one was not compared."""
    deviation = np.where(np.arange(cases.POINTS) % 4, 0.01, -0.1).astype(np.float32)
    deviation[0] = np.nan
    return ShownComparison(
        other="before.ply",
        alignment="as measured",
        core_points=1300,
        lower=Changed(0.25, -0.1, -0.12),
        higher=Changed(0.0, np.nan, np.nan),
        lod95_mm=0.06,
        diameter_mm=12.0,
        registration_mm=0.002,
        deviation=deviation,
        significant=deviation < -0.05,
        mesh_deviation=np.array([-0.1, 0.01, 0.01, -0.1], np.float32),
        mesh_significant=np.array([True, False, False, True]),
        range_mm=0.12,
        other_points=np.zeros((5, 3), np.float32),
    )


@pytest.fixture
def page(hand_bench, tmp_path, qtbot, monkeypatch):
    monkeypatch.setenv("TRISECT_NO_OPENGL", "none")
    monkeypatch.setattr(ask, "choose_file_to_open", lambda *_: OTHER_FILE)
    measuring = cast(HandLane, hand_bench.measuring)
    measuring.answers[SHOW_COMPARISON] = lambda *_: compared()
    cast(HandLane, hand_bench.quick).answers |= {
        jobs.INSPECTION_VIEW: lambda folder, project: cases.view(cases.gauge()),
        FORGET_COMPARISON: lambda *_: None,
    }
    made = InspectPage(cases.entered(hand_bench, tmp_path / "project", cases.project(), qtbot))
    qtbot.addWidget(made)
    made.resize(1280, 800)
    made.show()
    made.layer_folds["comparison"].expand(animate=False)
    made.refreshing.at_once()
    yield made
    made.close()


def press(page, qtbot, button):
    assert button.isEnabled(), button.toolTip()
    if isinstance(button, QCheckBox):
        button.click()  # its text is shorter than it is wide
    else:
        qtbot.mouseClick(button, LEFT)
    settle(page, qtbot)


def settle(page, qtbot):
    qtbot.wait(120)
    page.refreshing.at_once()


def panel(page):
    return page.layers["comparison"].widget


def values(page):
    return page.surface.scene._scene.cloud._values


def test_a_file_that_is_chosen_colours_the_scan_by_its_deviation(page, qtbot):
    press(page, qtbot, panel(page).file)
    assert page.surface.colour == LAYER
    order = page.presenter.scan.view.number
    shown = compared()
    expected = np.where(shown.significant, shown.deviation, np.nan)[order]
    assert np.array_equal(values(page), expected, equal_nan=True), "what may be chance is grey"
    assert "not significant" in page.surface.line.text()
    assert panel(page).rows.text_of("Compared with") == "before.ply"
    assert "25.0 %" in panel(page).rows.text_of("Less material")
    assert panel(page).rows.text_of("More material") == "nowhere significant"


def test_the_mask_can_be_taken_off(page, qtbot):
    press(page, qtbot, panel(page).file)
    press(page, qtbot, panel(page).significant)
    assert "not significant" not in page.surface.line.text()
    assert np.array_equal(values(page), compared().deviation[page.presenter.scan.view.number], equal_nan=True)


def test_the_other_surface_is_seen_beside_it_when_asked_for(page, qtbot):
    press(page, qtbot, panel(page).file)
    assert (Marks, LAYER) not in page.surface.scene._scene.items
    press(page, qtbot, panel(page).beside)
    assert len(page.surface.scene._scene.items[Marks, LAYER].points) == 5
    press(page, qtbot, panel(page).beside)
    assert (Marks, LAYER) not in page.surface.scene._scene.items


def test_another_alignment_compares_anew(page, qtbot):
    press(page, qtbot, panel(page).file)
    asked = []
    page.presenter.bench.measuring.answers[SHOW_COMPARISON] = lambda *given: asked.append(given) or compared()
    page.presenter.layers[LAYER].layer.set_value("align", "best fit")
    settle(page, qtbot)
    assert [(other, align) for _, other, align, _ in asked] == [(OTHER_FILE, "best fit")]


def test_taken_away_it_is_gone_from_view_and_results(page, qtbot):
    press(page, qtbot, panel(page).file)
    press(page, qtbot, panel(page).away)
    assert page.surface.colour == "height"
    assert panel(page).rows.isHidden()
    assert FORGET_COMPARISON in page.presenter.bench.quick.ran


def test_another_scan_forgets_it(page, qtbot):
    press(page, qtbot, panel(page).file)
    page.presenter.scan.forget()
    settle(page, qtbot)
    assert page.presenter.layers[LAYER].layer.shown is None


@pytest.mark.parametrize("no_surface", ["", "Scan the part first."])
@pytest.mark.parametrize("cannot_write", ["", "read-only"])
@pytest.mark.parametrize("running", [False, True])
@pytest.mark.parametrize("shown", [False, True])
def test_every_grey_button_says_why(no_surface, cannot_write, running, shown):
    can = comparison_buttons(ComparisonFacts(no_surface, cannot_write, running, shown))
    assert bool(can.compare) == bool(no_surface or cannot_write or running)
    assert bool(can.take_away) == bool(not shown or cannot_write or running)
    assert bool(can.look) == bool(not shown or running)
