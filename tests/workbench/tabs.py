"""Tabs by what the user reads on them."""

from __future__ import annotations

from typing import Any

from PySide6.QtWidgets import QTabWidget

from workbench.language import tr


def tab_titles(tabs: QTabWidget) -> list[str]:
    """What stands on them, in their order."""
    return [tabs.tabText(place) for place in range(tabs.count())]


def tab_titled(tabs: QTabWidget, title: str) -> Any:
    """The widget of the tab with this title, given in English; None where there is none."""
    titles = tab_titles(tabs)
    return tabs.widget(titles.index(tr(title))) if tr(title) in titles else None
