"""What is on the screen while the window is being made: the program's sign and name."""

from __future__ import annotations

import time

from PySide6.QtCore import QEventLoop, Qt
from PySide6.QtGui import QGuiApplication, QIcon, QPainter, QPaintEvent, QPalette
from PySide6.QtWidgets import QWidget

_WIDTH, _HEIGHT, _SIGN = 360, 200, 72
"""Px: its size, and that of the sign in it."""
_LISTEN_MS = 10
"""The screen is listened to for so long at a time."""
_PATIENCE_S = 0.5
"""A screen that has not asked for the picture by then is not waited for any longer."""


class Splash(QWidget):
    """Splash screen, shown and drawn as soon as it is made, in the colours of the application; ends with `finish`.

    Qt's own splash screen waits for a second for an X server that has no window manager.
    """

    def __init__(self, sign: QIcon, name: str) -> None:
        super().__init__(None, Qt.WindowType.SplashScreen | Qt.WindowType.FramelessWindowHint)
        self._sign, self._name, self._is_drawn = sign, name, False
        self.setFixedSize(_WIDTH, _HEIGHT)
        if (screen := QGuiApplication.primaryScreen()) is not None:
            self.move(screen.availableGeometry().center() - self.rect().center())
        self.show()
        asked = time.monotonic()
        while not self._is_drawn and time.monotonic() - asked < _PATIENCE_S:  # what comes next keeps this thread busy
            QGuiApplication.processEvents(QEventLoop.ProcessEventsFlag.AllEvents, _LISTEN_MS)

    def finish(self) -> None:
        """Close the splash screen, as the window is shown."""
        self.close()
        self.deleteLater()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.drawPixmap((_WIDTH - _SIGN) // 2, 36, self._sign.pixmap(_SIGN, _SIGN))
        font = self.font()
        font.setPointSizeF(1.6 * font.pointSizeF())
        painter.setFont(font)
        painter.drawText(0, 124, _WIDTH, 44, Qt.AlignmentFlag.AlignCenter, self._name)
        painter.setPen(self.palette().color(QPalette.ColorRole.Mid))
        painter.drawRect(0, 0, _WIDTH - 1, _HEIGHT - 1)
        painter.end()
        self._is_drawn = True
