"""The status bar: what was told last; progress, remaining time and Cancel."""

from __future__ import annotations

from PySide6.QtCore import QSize, Qt, QTimer, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QProgressBar, QPushButton, QSizePolicy, QStatusBar, QWidget

from core.remaining import in_words
from workbench.language import named, tr
from workbench.views.layouts import Elided, enable

LONG_S = (59.0, 59 * 60.0)
"""Seconds left whose words are as long as any: what stands beside them does not move when they change."""
LABEL_PX = 270
"""Pixels of what is being done."""
ROOM_PX = 2
"""Beside the words, for what Qt rounds."""


def time_left(seconds: float | None) -> str:
    """Write in words how much time a job still needs; "" while that is not known."""
    return "" if seconds is None else tr("about {time} left", time=in_words(seconds))


class StatusBar(QStatusBar):
    """Status bar that cuts a message beside a running job with an ellipsis and puts it whole into the tip."""

    def __init__(self) -> None:
        super().__init__()
        self._said, self._time = Elided(), QTimer(self)
        self._said.setContentsMargins(4, 0, 0, 0)
        self._time.setSingleShot(True)
        self._time.timeout.connect(self.clearMessage)
        self.addWidget(self._said, 1)

    def showMessage(self, text: str, timeout: int | None = 0) -> None:
        self._said.setText(text)
        if timeout:
            self._time.start(timeout)
        else:
            self._time.stop()

    def clearMessage(self) -> None:
        self._said.setText("")

    def currentMessage(self) -> str:
        return str(self._said.text())


class _Doing(Elided):
    """What is being done, in a place that stays as its words change; a small window has less room for it."""

    def sizeHint(self) -> QSize:
        return QSize(LABEL_PX, super().sizeHint().height())

    def minimumSizeHint(self) -> QSize:
        return QSize(LABEL_PX // 4, super().minimumSizeHint().height())


class TaskBar(QWidget):
    """Bar with one running job; hidden while there is none."""

    cancel_pressed = Signal()
    tick = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._label, self._left = _Doing(), QLabel()
        self._left.setObjectName("muted")
        self._bar = QProgressBar()
        self._label.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self._bar.setFixedWidth(180)
        self._bar.setTextVisible(False)
        self.setSizePolicy(QSizePolicy.Policy.Maximum, QSizePolicy.Policy.Preferred)
        self.cancel = QPushButton(tr("Cancel"))
        self.cancel.setObjectName("low")
        self.cancel.clicked.connect(self.cancel_pressed)
        row = QHBoxLayout(self)
        row.setContentsMargins(6, 1, 6, 1)
        for widget in (self._label, self._bar, self._left, self.cancel):
            row.addWidget(widget)
        self._clock = QTimer(self)
        self._clock.setInterval(500)
        self._clock.timeout.connect(self.tick)
        self.hide()

    def begin(self, label: str) -> None:
        """Show the bar for the job called `label`, which has started."""
        self._label.setText(label)
        self._bar.setRange(0, 0)
        self._left.setText("")
        words = (*(time_left(seconds) for seconds in LONG_S), tr("stopping …"))
        self._left.setMinimumWidth(max(map(self._left.fontMetrics().horizontalAdvance, words)) + ROOM_PX)
        enable(self.cancel, "", tr("Stop this job"))
        self._clock.start()
        self.show()

    def progress(self, label: str, stage: str, share: float | None, left: str) -> None:
        """Show the job's stage, its share done (None: not known), and the time left in words."""
        self._label.setText(named(label, stage) if stage else label)
        if share is None:
            self._bar.setRange(0, 0)
        else:
            self._bar.setRange(0, 1000)
            self._bar.setUpdatesEnabled(False)  # else Qt draws it at once, and a 3D view's whole window with it
            self._bar.setValue(round(share * 1000))
            self._bar.setUpdatesEnabled(True)
        self._left.setText(left)

    def cancelling(self) -> None:
        """Show that the job is being cancelled."""
        enable(self.cancel, tr("Stopping …"), "")
        self._left.setText(tr("stopping …"))

    def end(self) -> None:
        """Hide the bar, as the job has ended."""
        self._clock.stop()
        self.hide()
