"""How the window is laid out, remembered for each screen: one of another size or scale has a layout of its own."""

from __future__ import annotations

from collections.abc import Mapping

from PySide6.QtCore import QRect, QTimer
from PySide6.QtGui import QGuiApplication, QScreen
from PySide6.QtWidgets import QWidget

from workbench.pages.step_page import StepPage
from workbench.settings import AppSettings

LAST_SCREEN = "layout/screen"
"""Setting: the screen that the window was on last."""

TITLE_BAR = 40
"""Pixels of a title bar as long as it is not known how high it is: no usual one is higher."""
FRAMED_MS = 500
"""After so long a window that was shown has its frame."""


def name_of(screen: QScreen) -> str:
    """Make a name for a screen from what a layout depends on: its size in logical pixels and its scale."""
    size = screen.size()
    return f"{size.width()}x{size.height()} at {screen.devicePixelRatio():g}"


def keep_layout(window: QWidget, pages: Mapping[str, StepPage], settings: AppSettings) -> None:
    """Store the window's geometry, splitters and folded panels for the screen it is on."""
    screen = name_of(window.screen())
    settings.keep_text(LAST_SCREEN, screen)
    settings.keep_layout(f"{screen}/window", window.saveGeometry())
    _keep_pages(screen, pages, settings)


def _keep_pages(screen: str, pages: Mapping[str, StepPage], settings: AppSettings) -> None:
    for name, page in pages.items():
        settings.keep_layout(f"{screen}/{name}", page.splitter.saveState())
        for key, panel in page.kept_panels.items():
            settings.keep_text(f"layout/{screen}/{name}/{key}", "open" if panel.isExpanded() else "folded")


def restore_layout(window: QWidget, pages: Mapping[str, StepPage], settings: AppSettings) -> None:
    """Restore the window's layout on its last screen, or on the default screen if that one is gone."""
    screens = {name_of(screen): screen for screen in QGuiApplication.screens()}
    name = settings.text(LAST_SCREEN, "")
    if name not in screens:
        name = name_of(window.screen())
    if geometry := settings.layout(f"{name}/window"):
        window.restoreGeometry(geometry)
    put_on_screen(window, screens[name].availableGeometry())
    _restore_pages(name, pages, settings)


def put_on_screen(window: QWidget, room: QRect) -> None:
    """Move a window, and shrink it if needed, so that its whole frame is within the rectangle `room`.

    What the frame takes is not known until the window system has made it: until then a title bar of TITLE_BAR pixels is
    reckoned with.
    """
    if window.isMaximized() or window.isFullScreen():
        return
    own, frame = window.geometry(), window.frameGeometry()
    beside = (
        frame.left() - own.left(),
        frame.top() - own.top(),
        frame.right() - own.right(),
        frame.bottom() - own.bottom(),
    )
    left, top, right, bottom = beside if frame != own else (0, -TITLE_BAR, 0, 0)
    place = inside(own, room.adjusted(-left, -top, -right, -bottom))
    if place != own:
        window.setGeometry(place)


def _restore_pages(screen: str, pages: Mapping[str, StepPage], settings: AppSettings) -> None:
    for step, page in pages.items():
        if divided := settings.layout(f"{screen}/{step}"):
            page.splitter.restoreState(divided)
        for key, panel in page.kept_panels.items():
            match settings.text(f"layout/{screen}/{step}/{key}", ""):
                case "open":
                    panel.expand(animate=False)
                case "folded":
                    panel.collapse(animate=False)


class LayoutOfScreen:
    """Follower that lays the pages out as they were on the screen that the window is moved to."""

    def __init__(self, window: QWidget, pages: Mapping[str, StepPage], settings: AppSettings) -> None:
        self._window, self._pages, self._settings = window, pages, settings
        self._screen = ""
        self._framed = QTimer(window)
        self._framed.setSingleShot(True)
        self._framed.setInterval(FRAMED_MS)
        self._framed.timeout.connect(lambda: put_on_screen(window, window.screen().availableGeometry()))

    def rest(self) -> None:
        """Stop following the window from screen to screen, as it is hidden."""
        self._framed.stop()

    def follow(self) -> None:
        """Start following the window from screen to screen, as it is shown."""
        handle = self._window.windowHandle()
        if not self._screen and handle is not None:
            self._screen = name_of(self._window.screen())
            self._framed.start()
            handle.screenChanged.connect(self._moved)

    def _moved(self, screen: QScreen) -> None:
        before, self._screen = self._screen, name_of(screen)
        if self._screen != before:
            _keep_pages(before, self._pages, self._settings)
            _restore_pages(self._screen, self._pages, self._settings)


def inside(place: QRect, room: QRect) -> QRect:
    """Move the rectangle `place` to the nearest place within `room`, shrunk if needed, and return it."""
    width, height = min(place.width(), room.width()), min(place.height(), room.height())
    left = min(max(place.left(), room.left()), room.left() + room.width() - width)
    top = min(max(place.top(), room.top()), room.top() + room.height() - height)
    return QRect(left, top, width, height)
