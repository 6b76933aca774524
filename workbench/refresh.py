"""One refresh for many changes, in the next turn of the event loop.

A page that shows itself anew within the signal of one of its own widgets deletes, fills or disables that widget while
Qt is still in it, and the program crashes. So a change only asks for the refresh: it is done once Qt has returned to
its event loop, one time for all that changed meanwhile.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from PySide6.QtCore import QObject, QTimer


class Refresh(QObject):
    """Scheduler that calls `show` once in the next turn of the event loop, however often it is requested.

    It is a child of its page or list, and is gone with it: what it was asked for is then no longer done. Any signal
    can be connected to `soon`.
    """

    def __init__(self, show: Callable[[], object], parent: QObject) -> None:
        super().__init__(parent)
        self._show = show
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(0)
        self._timer.timeout.connect(self._due)

    def soon(self, *_: Any) -> None:
        """Request that `show` is called once in the next turn of the event loop."""
        self._timer.start()

    def at_once(self) -> None:
        """Call `show` now if it was requested; not to be called within a signal."""
        if self._timer.isActive():
            self._timer.stop()
            self._show()

    def _due(self) -> None:
        self._show()
