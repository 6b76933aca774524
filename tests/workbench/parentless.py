"""Widgets that nobody holds but Python: they go when garbage is collected, be it while Qt goes through its widgets."""

from __future__ import annotations

import gc
from collections.abc import Sequence

import shiboken6
from PySide6.QtWidgets import QApplication, QMenu, QWidget

from workbench.main_window import MainWindow


def parentless(app: QApplication, before: Sequence[QWidget] = ()) -> list[str]:
    """Class and words of each widget without a parent but the program's windows; `before` are not counted."""
    collects = gc.isenabled()
    gc.disable()  # Python wraps each of them, and a collection now would delete some of Qt's list
    try:
        there = [one for one in app.topLevelWidgets() if shiboken6.isValid(one) and shiboken6.ownedByPython(one)]
    finally:
        if collects:
            gc.enable()
    known = set(map(id, before))
    return sorted(
        f"{type(one).__name__} {words_of(one)!r}"
        for one in there
        if one.parent() is None and not isinstance(one, MainWindow) and id(one) not in known
    )


def words_of(widget: QWidget) -> str:
    """What tells one from another of its class."""
    if isinstance(widget, QMenu):
        return widget.title()
    text = getattr(widget, "text", None)
    return str(text()) if callable(text) else widget.objectName() or widget.windowTitle()
