"""Where the sections of a page's side panel stand: what arrives must not push what the hand is on."""

from __future__ import annotations

from collections.abc import Mapping

from PySide6.QtCore import QPoint
from pytestqt.qtbot import QtBot
from superqt import QCollapsible

from workbench.pages.step_page import StepPage

RESULT = "Result"
STILL = 8
"""Looks, 10 ms from one to the next, in which nothing has moved."""


def places(page: StepPage, qtbot: QtBot) -> dict[str, int]:
    """How far below the page's top each section begins that is shown, with the card's buttons and what is unfolded."""
    page.refreshing.at_once()
    found: list[dict[str, int]] = []

    def rest() -> bool:
        """Layouts answer one another in later turns of the event loop: whether they have come to an end."""
        found.append(_places(page))
        return len(found) > STILL and all(one == found[-1] for one in found[-STILL:])

    qtbot.waitUntil(rest)
    return found[-1]


def _places(page: StepPage) -> dict[str, int]:
    found = {}
    for fold in page.findChildren(QCollapsible):
        if fold.isVisible():
            title = fold.text().partition(" (")[0]
            found[title] = fold.mapTo(page, QPoint()).y()
            if fold.isExpanded() and title != RESULT:
                found[f"{title}, end"] = fold.mapTo(page, QPoint(0, fold.height())).y()
    button = next(button for button in page.card.buttons.values() if button.isVisible())
    return found | {"buttons": button.mapTo(page, QPoint()).y()}


def moved(before: Mapping[str, int], after: Mapping[str, int]) -> dict[str, tuple[int, int | None]]:
    """What stood somewhere and stands elsewhere now, or nowhere; the result itself may go and come."""
    return {name: (y, after.get(name)) for name, y in before.items() if name != RESULT and after.get(name) != y}
