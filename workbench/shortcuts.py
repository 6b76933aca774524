"""Every key the window knows, in one table: what the shortcut list under ? shows and what the actions are made from."""

from __future__ import annotations

from PySide6.QtCore import QT_TRANSLATE_NOOP

SHORTCUTS: tuple[tuple[str, str, str], ...] = (
    ("new", "Ctrl+N", str(QT_TRANSLATE_NOOP("Shortcuts", "New project"))),
    ("open", "Ctrl+O", str(QT_TRANSLATE_NOOP("Shortcuts", "Open project"))),
    ("save", "Ctrl+S", str(QT_TRANSLATE_NOOP("Shortcuts", "Save project"))),
    ("close", "Ctrl+W", str(QT_TRANSLATE_NOOP("Shortcuts", "Close project"))),
    ("quit", "Ctrl+Q", str(QT_TRANSLATE_NOOP("Shortcuts", "Quit"))),
    ("undo", "Ctrl+Z", str(QT_TRANSLATE_NOOP("Shortcuts", "Undo"))),
    ("redo", "Ctrl+Shift+Z", str(QT_TRANSLATE_NOOP("Shortcuts", "Redo"))),
    ("back", "Alt+Left", str(QT_TRANSLATE_NOOP("Shortcuts", "Back"))),
    ("next", "Alt+Right", str(QT_TRANSLATE_NOOP("Shortcuts", "Next"))),
    ("step", "Ctrl+1 … Ctrl+6", str(QT_TRANSLATE_NOOP("Shortcuts", "Go to a step"))),
    ("run", "Ctrl+R", str(QT_TRANSLATE_NOOP("Shortcuts", "Do this step: calibrate, measure, make the report"))),
    ("accept", "Ctrl+Return", str(QT_TRANSLATE_NOOP("Shortcuts", "Accept a calibration"))),
    ("live", "Ctrl+L", str(QT_TRANSLATE_NOOP("Shortcuts", "Start or stop the live source"))),
    ("capture", "Ctrl+Space", str(QT_TRANSLATE_NOOP("Shortcuts", "Take a picture from the live source"))),
    ("cancel", "Ctrl+.", str(QT_TRANSLATE_NOOP("Shortcuts", "Cancel the running job"))),
    ("messages", "Ctrl+M", str(QT_TRANSLATE_NOOP("Shortcuts", "Show or hide the messages"))),
    ("theme", "Ctrl+T", str(QT_TRANSLATE_NOOP("Shortcuts", "Light or dark theme"))),
    ("full", "F11", str(QT_TRANSLATE_NOOP("Shortcuts", "Full screen"))),
    ("help", "F1", str(QT_TRANSLATE_NOOP("Shortcuts", "This list (also ?)"))),
    ("fit", "F", str(QT_TRANSLATE_NOOP("Shortcuts", "Picture: show the whole picture"))),
    ("one", "1", str(QT_TRANSLATE_NOOP("Shortcuts", "Picture: one screen pixel a picture pixel"))),
    ("views", "1 … 7, R", str(QT_TRANSLATE_NOOP("Shortcuts", "3D view: standard views, fit"))),
    ("frames", "Left, Right", str(QT_TRANSLATE_NOOP("Shortcuts", "Scan: go through the frames"))),
    ("polygon", "Return, Esc", str(QT_TRANSLATE_NOOP("Shortcuts", "Drawing a region: close it, give it up"))),
)
"""Name, key and meaning."""

KEYS = {name: key for name, key, _ in SHORTCUTS}
