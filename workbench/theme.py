"""How the window looks: light and dark palettes, the style sheet, and icons that follow them.

The style sheet (resources/style.qss) takes its colours from the palette, so it is one for both themes. Setting it takes
half a second with all pages made. A new palette takes a few milliseconds, but Qt keeps the colours of the rules each
widget has used: `polish_again` has the widgets look them up anew.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from pathlib import Path

import qtawesome
import shiboken6
from PySide6.QtCore import QRect, QSize, Qt, QTimer
from PySide6.QtGui import QColor, QIcon, QIconEngine, QPainter, QPalette, QPixmap
from PySide6.QtWidgets import QApplication, QWidget


@dataclass(frozen=True, slots=True)
class Shades:
    """Colours of one theme, as #rrggbb."""

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


CHECKED = "#1f6feb"
"""Behind the white tick: dark enough for it and light enough on the ground of either theme."""

FIELDS = ("QAbstractSpinBox", "QComboBox")
"""What Fusion frames in a shade of the window's ground: in the dark theme nearly black, and no field could be seen."""

FRAME_DARKER = 1.4
"""By this Fusion's frames are darker than the ground."""

POLISHED_AT_ONCE = 150
"""Hidden widgets that take their new colours in one go: some 10 ms."""

SOON_MS = 1
"""After this what else waits has its turn; what is to be done after 0 ms Qt does before anything else."""


def shades() -> Shades:
    """Return the colours of the theme that is in use."""
    return DARK if is_dark() else LIGHT


def is_dark() -> bool:
    """Whether the dark theme is in use."""
    return QApplication.palette().color(QPalette.ColorRole.Window).lightness() < 128


def apply_theme(app: QApplication, name: str) -> None:
    """Apply a theme to the whole application: "light", "dark", or "system" for the system's choice."""
    apply_colours(app, name)
    apply_sheet(app)


def apply_colours(app: QApplication, name: str) -> None:
    """Set the style and the palette of a theme; icons are drawn in its colours from then on."""
    if app.property("dressed") != "fusion":  # under a style sheet the style no longer tells its name
        with _nothing_collected():
            app.setStyle("Fusion")
        app.setProperty("dressed", "fusion")
    if name == "system":
        name = "dark" if app.styleHints().colorScheme() == Qt.ColorScheme.Dark else "light"
    chosen = DARK if name == "dark" else LIGHT
    qtawesome.reset_cache()
    with _nothing_collected():
        app.setPalette(_palette(chosen))
        for field in FIELDS:  # after the palette of all, which forgets those of single classes
            app.setPalette(_palette_of_fields(chosen), field)  # type: ignore[arg-type]  # it takes a str, no bytes


def apply_sheet(app: QApplication) -> None:
    """Set the application's style sheet, or, if it is set, let its rules take the palette's colours."""
    if not app.styleSheet():
        folder = files("resources")
        check = Path(str(folder / "icons" / "check.svg")).as_posix()
        sheet = (folder / "style.qss").read_text(encoding="utf-8")
        with _nothing_collected():
            app.setStyleSheet(sheet.replace("CHECKED", CHECKED).replace("CHECK_ICON", check))
    else:
        polish_again(app)


def take_sheet_off(app: QApplication) -> None:
    """Remove the application's style sheet, until `apply_sheet` is called."""
    with _nothing_collected():
        app.setStyleSheet("")


@contextmanager
def _nothing_collected() -> Iterator[None]:
    """Qt goes through a list of all widgets, and Python code runs meanwhile: be it only to wrap each of them.

    A widget that is nobody's child is deleted by Python. Were that now, because garbage happens to be collected, the
    next widget of Qt's list would be none, and the program would crash.
    """
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()


@lru_cache(maxsize=512)
def icon(name: str, *, colour: str = "") -> QIcon:
    """Make an icon by its qtawesome name, in the theme's text colour or in the field `colour` of Shades.

    It is drawn in the colours of the theme in use whenever it is drawn: nobody need set it anew when that changes.
    """
    return QIcon(_ThemedIcon(name, colour or "text"))


class _ThemedIcon(QIconEngine):
    """Draws an icon once a size and theme: qtawesome's own are drawn by Python each time anything near is painted."""

    def __init__(self, name: str, colour: str) -> None:
        super().__init__()
        self._name, self._colour = name, colour
        self._drawn: dict[bool, QIcon] = {}
        self._pixmaps: dict[tuple[bool, int, int, QIcon.Mode, QIcon.State], QPixmap] = {}

    def pixmap(self, size: QSize, mode: QIcon.Mode, state: QIcon.State) -> QPixmap:
        if size.isEmpty():
            return QPixmap()  # a button without room; qtawesome would try to paint it
        dark = is_dark()
        key = dark, size.width(), size.height(), mode, state
        if key not in self._pixmaps:
            if dark not in self._drawn:
                s = shades()
                self._drawn[dark] = qtawesome.icon(
                    self._name,
                    color=getattr(s, self._colour),
                    color_disabled=s.line,
                    color_selected=s.on_accent,
                )
            self._pixmaps[key] = self._drawn[dark].pixmap(size, 1.0, mode, state)
        return self._pixmaps[key]

    def paint(self, painter: QPainter, rect: QRect, mode: QIcon.Mode, state: QIcon.State) -> None:
        painter.drawPixmap(rect, self.pixmap(rect.size() * painter.device().devicePixelRatioF(), mode, state))


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


def _palette_of_fields(s: Shades) -> QPalette:
    """That of all, but with a ground whose frames are seen on a dark one: as bright as those of other fields."""
    palette = _palette(s)
    if s is DARK:
        frame = QColor(s.line)
        ground = QColor.fromHsvF(frame.hsvHueF(), frame.hsvSaturationF(), min(1.0, frame.valueF() * FRAME_DARKER))
        palette.setColor(QPalette.ColorRole.Window, ground)
    return palette


def polish_again(app: QApplication) -> None:
    """Update the colours of all widgets from the palette: visible ones now, the others step by step."""
    hidden = []
    with _nothing_collected():
        widgets = app.allWidgets()
    for widget in widgets:
        if not shiboken6.isValid(widget):
            continue  # it went with what another one did when it was told of its new colours
        if widget.isVisible():
            _polish(widget)
        else:
            hidden.append(widget)
    _later(app).begin(hidden)


def is_polishing(app: QApplication) -> bool:
    """Whether some widgets that are not visible still have the colours of the theme before."""
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
        now, self._left = self._left[:POLISHED_AT_ONCE], self._left[POLISHED_AT_ONCE:]
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
