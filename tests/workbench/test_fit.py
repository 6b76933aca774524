"""The window fits a small screen: no page is wider or higher than what is left beside rail, title and buttons."""

from __future__ import annotations

import pytest
from PySide6.QtWidgets import QApplication, QToolButton, QWidget

from core.translations import PSEUDO, language
from workbench.app import build_window
from workbench.bench import Bench
from workbench.language import choose
from workbench.steps import STEPS
from workbench.theme import apply_theme
from workbench.views.lists.step_rail import StepRail

SMALLEST = 1000, 680


def laid_out(widget: QWidget) -> None:
    """What a widget wants is known once its layout is done."""
    layout = widget.layout()
    assert layout is not None
    layout.activate()


@pytest.mark.parametrize("styled", [False, True])
@pytest.mark.parametrize("name", ["en", "de", "zh_CN", PSEUDO])
def test_every_page_has_room_in_the_smallest_window(
    bench: Bench, qapp: QApplication, qtbot, name: str, styled: bool
) -> None:
    sheet = qapp.styleSheet()
    choose(language(name), qapp)
    try:
        if styled:  # as where the language is changed; else widgets are measured before the style is on
            apply_theme(qapp, "light")
        window = build_window(qapp, bench, "light")
        qtbot.addWidget(window)
        window.resize(*SMALLEST)
        window.show()
        laid_out(window.rail)
        assert window.rail.minimumSizeHint().width() < 100
        room = window.width() - window.rail.minimumSizeHint().width()
        wide = {step.name: window.pages[step.name].minimumSizeHint().width() for step in STEPS}
        assert {step: width for step, width in wide.items() if width > room} == {}
        assert window.minimumSizeHint().height() <= SMALLEST[1]
        window.dismiss()
    finally:
        choose(language("en"), qapp)
        qapp.setStyleSheet(sheet)


def test_a_narrow_rail_shows_icons_and_its_tips_tell_the_titles(qtbot) -> None:
    rail = StepRail([("scan", "Scan", "mdi6.line-scan"), ("report", "Report", "mdi6.file")])
    qtbot.addWidget(rail)
    rail.set_states({"scan": ("done", "12 frames."), "report": ("todo", "")})
    laid_out(rail)
    wide = rail.minimumSizeHint().width()
    rail.set_narrow(True)
    laid_out(rail)
    assert rail.minimumSizeHint().width() < 0.5 * wide
    assert [button.toolTip() for button in rail.findChildren(QToolButton)] == ["Scan\n12 frames.", "Report"]
    rail.set_narrow(False)
    assert [button.toolTip() for button in rail.findChildren(QToolButton)] == ["12 frames.", ""]
    laid_out(rail)
    assert rail.minimumSizeHint().width() == wide
