"""How the window looks: light and dark palettes, a little style, and icons that follow them."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

import qtawesome
from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QIcon, QPalette
from PySide6.QtWidgets import QApplication


@dataclass(frozen=True, slots=True)
class Shades:
    """The colours of one theme, as #rrggbb."""

    window: str
    panel: str
    text: str
    muted: str
    line: str
    accent: str
    on_accent: str
    good: str
    warn: str
    bad: str


LIGHT = Shades(
    "#f3f4f6", "#ffffff", "#1d2530", "#5c6773", "#d3d8de", "#1f6feb", "#ffffff", "#1a7f37", "#9a6700", "#cf222e"
)
DARK = Shades(
    "#1b1f24", "#23282f", "#e3e8ee", "#98a3af", "#39414b", "#5aa2ff", "#0d1117", "#4ac26b", "#e0a52c", "#ff7b72"
)


def shades() -> Shades:
    """The colours of the theme in use."""
    return DARK if is_dark() else LIGHT


def is_dark() -> bool:
    """Whether the dark theme is in use."""
    return QApplication.palette().color(QPalette.ColorRole.Window).lightness() < 128


def apply_theme(app: QApplication, name: str) -> None:
    """Dress the application: "light", "dark", or as the system is set for "system"."""
    if app.property("dressed") != "fusion":  # under a style sheet the style no longer tells its name
        app.setStyle("Fusion")
        app.setProperty("dressed", "fusion")
    if name == "system":
        name = "dark" if app.styleHints().colorScheme() == Qt.ColorScheme.Dark else "light"
    chosen = DARK if name == "dark" else LIGHT
    app.setPalette(_palette(chosen))
    app.setStyleSheet(_style(chosen))
    qtawesome.reset_cache()


def icon(name: str, *, colour: str = "") -> QIcon:
    """An icon by its qtawesome name, in the text colour of the theme or in `colour` (a field of Shades)."""
    shade = shades()
    return QIcon(qtawesome.icon(name, color=getattr(shade, colour or "text"), color_disabled=shade.line))


def _palette(s: Shades) -> QPalette:
    role, palette = QPalette.ColorRole, QPalette()
    for which, colour in (
        (role.Window, s.window),
        (role.WindowText, s.text),
        (role.Base, s.panel),
        (role.AlternateBase, s.window),
        (role.ToolTipBase, s.panel),
        (role.ToolTipText, s.text),
        (role.Text, s.text),
        (role.PlaceholderText, s.muted),
        (role.Button, s.panel),
        (role.ButtonText, s.text),
        (role.BrightText, s.bad),
        (role.Highlight, s.accent),
        (role.HighlightedText, s.on_accent),
        (role.Link, s.accent),
        (role.Mid, s.line),
        (role.Midlight, s.line),
        (role.Accent, s.accent),
    ):
        palette.setColor(which, QColor(colour))
    for which in (role.WindowText, role.Text, role.ButtonText):
        palette.setColor(QPalette.ColorGroup.Disabled, which, QColor(s.muted))
    return palette


def _style(s: Shades) -> str:
    check = Path(str(files("resources"))) / "icons" / f"check-{'dark' if s is DARK else 'light'}.svg"
    return f"""
QToolTip {{ color: {s.text}; background: {s.panel}; border: 1px solid {s.line}; padding: 4px; }}
QFrame#card {{ background: {s.panel}; border: 1px solid {s.line}; border-radius: 6px; }}
QLabel#title {{ font-size: 17px; font-weight: 600; }}
QLabel#heading {{ font-weight: 600; }}
QLabel#muted, QLabel#help {{ color: {s.muted}; }}
QLabel#help {{ font-size: 11px; }}
QPushButton {{ padding: 5px 12px; border: 1px solid {s.line}; border-radius: 4px; background: {s.panel}; }}
QPushButton:hover {{ border-color: {s.accent}; }}
QPushButton:pressed {{ background: {s.window}; }}
QPushButton:focus {{ border: 1px solid {s.accent}; }}
QPushButton:disabled {{ color: {s.muted}; background: {s.window}; }}
QPushButton[primary="true"] {{ background: {s.accent}; color: {s.on_accent}; border-color: {s.accent};
    font-weight: 600; }}
QPushButton[primary="true"]:disabled {{ background: {s.window}; color: {s.muted}; border-color: {s.line}; }}
QPushButton:checked {{ border-color: {s.accent}; color: {s.accent}; }}
QLineEdit, QPlainTextEdit {{ padding: 3px 5px; border: 1px solid {s.line};
    border-radius: 4px; background: {s.panel}; selection-background-color: {s.accent}; }}
QLineEdit:focus, QPlainTextEdit:focus {{ border-color: {s.accent}; }}
QCheckBox {{ spacing: 6px; }}
QCheckBox::indicator, QTableView::indicator {{ width: 14px; height: 14px; border: 1px solid {s.muted};
    border-radius: 3px; background: {s.panel}; }}
QCheckBox::indicator:hover, QCheckBox::indicator:focus {{ border-color: {s.accent}; }}
QCheckBox::indicator:checked, QTableView::indicator:checked {{ background: {s.accent}; border-color: {s.accent};
    image: url("{check.as_posix()}"); }}
QTableView::indicator:selected {{ border-color: {s.on_accent}; }}
QCheckBox::indicator:disabled {{ background: {s.window}; border-color: {s.line}; }}
QCheckBox::indicator:checked:disabled {{ background: {s.muted}; }}
QAbstractSpinBox, QComboBox {{ min-height: 20px; }}
QHeaderView::section {{ background: {s.window}; color: {s.muted}; border: none; border-bottom: 1px solid {s.line};
    padding: 4px 7px; }}
QTableView {{ border: 1px solid {s.line}; }}
DataTable QTableView::item {{ padding: 0 7px; }}
QProgressBar {{ border: 1px solid {s.line}; border-radius: 3px; text-align: center; height: 14px; }}
QProgressBar::chunk {{ background: {s.accent}; border-radius: 2px; }}
QSplitter::handle {{ background: {s.line}; }}
QSplitter::handle:horizontal {{ width: 1px; }}
QSplitter::handle:vertical {{ height: 1px; }}
QScrollArea {{ border: none; background: transparent; }}
StepRail {{ background: {s.panel}; border: none; border-right: 1px solid {s.line}; }}
StepRail QToolButton {{ border: 1px solid transparent; border-radius: 5px; padding: 6px 8px; text-align: left; }}
StepRail QToolButton:hover {{ background: {s.window}; }}
StepRail QToolButton:focus {{ border-color: {s.line}; }}
StepRail QToolButton:checked {{ background: {s.window}; color: {s.accent}; font-weight: 600; }}
Banner {{ background: {s.panel}; border: 1px solid {s.line}; border-left: 4px solid {s.accent}; }}
Banner[level="warning"] {{ border-left-color: {s.warn}; }}
Banner[level="error"] {{ border-left-color: {s.bad}; }}
QTabWidget::pane {{ border: 1px solid {s.line}; border-radius: 4px; }}
"""
