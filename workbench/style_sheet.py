"""The style sheet of the whole program, set once: its colours are those of the palette, so it is one for both themes.

Setting an application's style sheet takes half a second with all pages made. A new palette takes a few milliseconds,
but Qt keeps the colours of the rules each widget has used: `polish_again` has the widgets look them up anew.
"""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

import shiboken6
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QApplication, QWidget

AT_ONCE = 150
"""So many hidden widgets are polished in one go."""

SOON_MS = 1
"""After this what else waits has its turn; what is to be done after 0 ms Qt does before anything else."""

_CHECK = Path(str(files("resources"))) / "icons" / "check.svg"
_CHECKED = "#1f6feb"
"""Behind the white tick: dark enough for it and light enough on the ground of either theme."""

SHEET = """
QToolTip { color: palette(window-text); background: palette(base); border: 1px solid palette(mid); padding: 4px; }
QFrame#card { background: palette(base); border: 1px solid palette(mid); border-radius: 6px; }
QLabel#title { font-size: 17px; font-weight: 600; }
QLabel#heading { font-weight: 600; }
QLabel#muted, QLabel#help { color: palette(placeholder-text); }
QLabel#help { font-size: 11px; }
QPushButton { padding: 5px 12px; border: 1px solid palette(mid); border-radius: 4px; background: palette(base); }
QPushButton:hover { border-color: palette(highlight); }
QPushButton:pressed { background: palette(window); }
QPushButton:focus { border: 1px solid palette(highlight); }
QPushButton:disabled { color: palette(placeholder-text); background: palette(window); }
QPushButton[primary="true"] { background: palette(highlight); color: palette(highlighted-text);
    border-color: palette(highlight); font-weight: 600; }
QPushButton[primary="true"]:disabled { background: palette(window); color: palette(placeholder-text);
    border-color: palette(mid); }
QPushButton:checked { border-color: palette(highlight); color: palette(highlight); }
QLineEdit, QPlainTextEdit { padding: 3px 5px; border: 1px solid palette(mid);
    border-radius: 4px; background: palette(base); selection-background-color: palette(highlight); }
QLineEdit:focus, QPlainTextEdit:focus { border-color: palette(highlight); }
QCheckBox { spacing: 6px; }
QCheckBox::indicator, QTableView::indicator, QTreeView::indicator { width: 14px; height: 14px;
    border: 1px solid palette(placeholder-text); border-radius: 3px; background: palette(base); }
QCheckBox::indicator:hover, QCheckBox::indicator:focus { border-color: palette(highlight); }
QCheckBox::indicator:checked, QTableView::indicator:checked, QTreeView::indicator:checked {
    background: CHECKED; border-color: CHECKED; image: url("CHECK_ICON"); }
QTableView::indicator:selected, QTreeView::indicator:selected { border-color: palette(highlighted-text); }
QCheckBox::indicator:disabled { background: palette(window); border-color: palette(mid); }
QCheckBox::indicator:checked:disabled { background: palette(placeholder-text); }
QAbstractSpinBox, QComboBox { min-height: 20px; }
QHeaderView::section { background: palette(window); color: palette(placeholder-text); border: none;
    border-bottom: 1px solid palette(mid); padding: 4px 7px; }
QTableView, QTreeView { border: 1px solid palette(mid); }
QTreeView#roomy::item { padding: 4px 0; }
DataTable QTableView::item { padding: 0 7px; }
QProgressBar { border: 1px solid palette(mid); border-radius: 3px; text-align: center; height: 14px; }
QProgressBar::chunk { background: palette(highlight); border-radius: 2px; }
QSplitter::handle { background: palette(mid); }
QSplitter::handle:horizontal { width: 1px; }
QSplitter::handle:vertical { height: 1px; }
QScrollArea { border: none; background: transparent; }
StepRail { background: palette(base); border: none; border-right: 1px solid palette(mid); }
StepRail QToolButton { border: 1px solid transparent; border-radius: 5px; padding: 6px 8px; text-align: left; }
StepRail QToolButton:hover { background: palette(window); }
StepRail QToolButton:focus { border-color: palette(mid); }
StepRail QToolButton:checked { background: palette(window); color: palette(highlight); font-weight: 600; }
QTabWidget::pane { border: 1px solid palette(mid); border-radius: 4px; }
""".replace("CHECKED", _CHECKED).replace("CHECK_ICON", _CHECK.as_posix())


def polish_again(app: QApplication) -> None:
    """Have all widgets take their colours from the palette of now: those seen at once, the others little by little."""
    hidden = []
    for widget in app.allWidgets():
        if widget.isVisible():
            _polish(widget)
        else:
            hidden.append(widget)
    _later(app).begin(hidden)


def is_polishing(app: QApplication) -> bool:
    """Whether widgets out of sight still have the colours of before."""
    return _later(app).isActive()


class _Later(QTimer):
    """Polishes what is out of sight, some at a time; a new palette begins anew."""

    def __init__(self, app: QApplication) -> None:
        super().__init__(app)
        self._left: list[QWidget] = []
        self.setInterval(SOON_MS)
        self.timeout.connect(self._some)

    def begin(self, widgets: list[QWidget]) -> None:
        self._left = widgets
        self.start()

    def _some(self) -> None:
        now, self._left = self._left[:AT_ONCE], self._left[AT_ONCE:]
        for widget in now:
            if shiboken6.isValid(widget):
                _polish(widget)
        if not self._left:
            self.stop()


def _later(app: QApplication) -> _Later:
    """The one of this program; made when first asked for."""
    found = next((child for child in app.children() if isinstance(child, _Later)), None)
    return found or _Later(app)


def _polish(widget: QWidget) -> None:
    style = widget.style()
    style.unpolish(widget)
    style.polish(widget)
    widget.update()
