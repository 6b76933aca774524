"""Python's cyclic garbage is collected in the GUI thread, between two events, and nowhere else.

Python collects in whichever thread happens to allocate, at whatever moment. A window or a picture's item that is found
in a cycle by the thread that reads a lane would be destroyed there, or in the midst of a paint, while Qt still uses
it: now and then the program would crash. So automatic collection is off while a collector is at work; its timer does
what Python would have done, by Python's own thresholds.
"""

from __future__ import annotations

import gc

from PySide6.QtCore import QObject, QTimer

EVERY_MS = 500


class GarbageCollector(QObject):
    """Collects while it lives; `stop` gives the task back to Python."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._was_enabled = gc.isenabled()
        gc.disable()
        self._timer = QTimer(self)
        self._timer.setInterval(EVERY_MS)
        self._timer.timeout.connect(self.collect_due)
        self._timer.start()

    def spare_what_is_there(self) -> None:
        """What the program has made so far stays for good: later collections need not go through it, and are short."""
        gc.freeze()

    def collect_due(self) -> int:
        """Collect the oldest generation that is due, which takes the younger ones with it; how many objects went.

        Due is what has reached Python's threshold. The oldest one is gone through after as many collections of the
        middle one as Python would wait for.
        """
        for generation in (2, 1, 0):
            if gc.get_count()[generation] > gc.get_threshold()[generation]:
                return gc.collect(generation)
        return 0

    def stop(self) -> None:
        """Collect nothing any more; Python does again, if it did before."""
        self._timer.stop()
        if self._was_enabled:
            gc.enable()
