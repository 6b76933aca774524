"""The style sheet is set once; a theme is a palette that every widget takes its colours from, seen or not."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from typing import Any

import pytest
import shiboken6
from PySide6.QtCore import QPoint, QRect, QSize
from PySide6.QtGui import QColor, QIcon, QPainter, QPixmap
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractScrollArea,
    QApplication,
    QCheckBox,
    QComboBox,
    QDoubleSpinBox,
    QFrame,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPlainTextEdit,
    QPushButton,
    QStyle,
    QStyleOptionSlider,
    QStyleOptionTab,
    QToolButton,
    QTreeWidget,
    QTreeWidgetItem,
    QWidget,
)

from workbench.theme import CHECKED, DARK, LIGHT, Shades, _ThemedIcon, icon
from workbench.views.common import IconLabel
from workbench.views.layouts import Tabs, UpAndDown
from workbench.views.scene.overlay import OverlayColours, axis_colour


def card_in(parent: QWidget) -> QFrame:
    card = QFrame(parent)
    card.setObjectName("card")
    layout = parent.layout()
    assert layout is not None
    layout.addWidget(card)
    return card


def colours(card: QFrame) -> tuple[str, str]:
    """Ground and edge as they are painted."""
    image = card.grab().toImage()
    return image.pixelColor(image.rect().center()).name(), image.pixelColor(0, image.height() // 2).name()


@pytest.mark.parametrize(("name", "shades"), [("dark", DARK), ("light", LIGHT)])
def test_a_theme_dresses_what_is_seen_at_once_and_what_is_hidden_soon(
    qtbot: Any, qapp: QApplication, theme: Callable[[str], None], name: str, shades: Shades
) -> None:
    theme("light" if name == "dark" else "dark")
    window = QWidget()
    qtbot.addWidget(window)
    QHBoxLayout(window)
    seen, hidden = card_in(window), card_in(window)
    hidden.hide()
    window.resize(200, 80)
    window.show()
    colours(hidden)
    sheet = qapp.styleSheet()
    theme(name)
    assert colours(seen) == (shades.panel, shades.line)
    qtbot.waitUntil(lambda: colours(hidden) == (shades.panel, shades.line))
    assert qapp.styleSheet() == sheet


@pytest.mark.parametrize(("name", "shades"), [("dark", DARK), ("light", LIGHT)])
@pytest.mark.parametrize("kind", [QPushButton, QCheckBox])
def test_what_has_the_focus_does_not_look_chosen(
    qtbot: Any, theme: Callable[[str], None], kind: type[QAbstractButton], name: str, shades: Shades
) -> None:
    theme(name)
    window = QWidget()
    qtbot.addWidget(window)
    row = QHBoxLayout(window)
    plain, focused, chosen = (kind() for _ in range(3))
    for button in (plain, focused, chosen):
        button.setCheckable(True)
        row.addWidget(button)
    chosen.setChecked(True)
    window.show()
    window.activateWindow()
    focused.setFocus()
    qtbot.waitUntil(focused.hasFocus)
    accents = [accent_share(button, shades) for button in (plain, focused, chosen)]
    assert accents[:2] == [0.0, 0.0] and accents[2] > 0.0  # the accent is for what is chosen
    assert focused.grab().toImage() != plain.grab().toImage()


@pytest.mark.parametrize("order", [("dark", "light"), ("light", "dark")])
def test_no_field_has_a_frame_that_is_hardly_seen(qtbot: Any, theme: Callable[[str], None], order: list[str]) -> None:
    window = QWidget()
    qtbot.addWidget(window)
    card = QFrame(window)
    card.setObjectName("card")
    QHBoxLayout(window).addWidget(card)
    row, fields = QHBoxLayout(card), (QLineEdit(), QDoubleSpinBox(), QComboBox())
    for field in fields:
        row.addWidget(field)
    for name in order:
        theme(name)
        window.show()
        image, ground = window.grab().toImage(), QColor((DARK if name == "dark" else LIGHT).panel).lightness()
        frames = [image.pixelColor(f.mapTo(window, QPoint(0, f.height() // 2))) for f in fields]
        seen = [abs(frame.lightness() - ground) for frame in frames]
        assert min(seen[1:]) >= seen[0] - 1  # a text's frame has the colour of lines; a rounding more or less
        assert seen[0] >= 20


@pytest.mark.parametrize(("name", "shades"), [("dark", DARK), ("light", LIGHT)])
def test_the_handle_of_a_scroll_bar_is_seen_on_its_trough_alike_in_lists_texts_and_panels(
    qtbot: Any, theme: Callable[[str], None], name: str, shades: Shades
) -> None:
    theme("light" if name == "dark" else "dark")
    window, rows = QWidget(), "row\n" * 60
    qtbot.addWidget(window)
    tree = QTreeWidget()
    tree.addTopLevelItems([QTreeWidgetItem([row]) for row in rows.split()])
    areas: tuple[QAbstractScrollArea, ...] = (QPlainTextEdit(rows), tree, UpAndDown(QLabel(rows), steady=True))
    row = QHBoxLayout(window)
    for area in areas:
        row.addWidget(area)
    window.resize(600, 200)
    window.show()
    theme(name)
    for area in areas:
        bar, option = area.verticalScrollBar(), QStyleOptionSlider()
        bar.initStyleOption(option)
        image, style = bar.grab().toImage(), bar.style()
        handle, trough = (
            image.pixelColor(style.subControlRect(QStyle.ComplexControl.CC_ScrollBar, option, part, bar).center())
            for part in (QStyle.SubControl.SC_ScrollBarSlider, QStyle.SubControl.SC_ScrollBarAddPage)
        )
        assert trough.name() == shades.window
        assert contrast(handle, trough) >= 3, "what WCAG 2.2 asks of parts of controls"
        assert style.pixelMetric(QStyle.PixelMetric.PM_ScrollBarExtent, option, bar) == bar.width()


def contrast(one: QColor, other: QColor) -> float:
    """Of two opaque colours, after WCAG."""

    def luminance(colour: QColor) -> float:
        parts = (colour.redF(), colour.greenF(), colour.blueF())
        red, green, blue = (part / 12.92 if part <= 0.03928 else ((part + 0.055) / 1.055) ** 2.4 for part in parts)
        return 0.2126 * red + 0.7152 * green + 0.0722 * blue

    low, high = sorted(map(luminance, (one, other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("dark", [False, True])
def test_axes_that_point_away_are_seen_too(dark: bool) -> None:
    ground = QColor((DARK if dark else LIGHT).window)
    colours = OverlayColours(ground, QColor("#808080"), QColor("#808080"))
    for away in (False, True):
        assert min(contrast(axis_colour(number, colours, away=away), ground) for number in range(3)) >= 3


def test_titles_of_tabs_are_whole_down_to_the_feet_of_their_letters(qtbot: Any, theme: Callable[[str], None]) -> None:
    theme("light")
    tabs = Tabs()
    qtbot.addWidget(tabs)
    for title in ("Surface", "Repeats (g)"):
        tabs.add(QWidget(), title)
    tabs.show()
    bar, room = tabs.tabBar(), list[int]()
    for place in range(bar.count()):
        option = QStyleOptionTab()
        bar.initStyleOption(option, place)
        room.append(bar.style().subElementRect(QStyle.SubElement.SE_TabBarTabText, option, bar).height())
    assert min(room) >= bar.fontMetrics().height()
    assert not bar.drawBase(), "a line across the tabs, which a bar on its own has"


def accent_share(widget: QWidget, shades: Shades) -> float:
    """Share of its pixels in the colours of what is chosen."""
    image = widget.grab().toImage()
    names = [image.pixelColor(x, y).name() for x in range(image.width()) for y in range(image.height())]
    return sum(name in (shades.accent, CHECKED) for name in names) / len(names)


def test_a_widget_that_is_gone_before_its_turn_is_passed_over(qtbot: Any, theme: Callable[[str], None]) -> None:
    theme("light")
    window = QWidget()
    children = [QWidget(window) for _ in range(400)]
    theme("dark")
    shiboken6.delete(window)
    qtbot.wait(50)
    assert not any(shiboken6.isValid(child) for child in children)


COLLECTED_ANY_TIME = """
import gc
from PySide6.QtWidgets import QApplication, QComboBox, QWidget
from workbench.theme import apply_theme, polish_again
app = QApplication([])
apply_theme(app, "light")
gc.set_threshold(5)
for name in 5 * ("dark", "light"):
    gc.disable()
    boxes = [QComboBox() for _ in range(50)]
    for box in boxes:
        box.view()
    for _ in range(100):
        widget = QWidget()
        widget.me = widget
    del widget
    gc.enable()
    polish_again(app)
"""
"""Widgets of their own, each referred to by itself alone, beside some that Qt has made for itself: Python learns of
these when the theme goes through all, and collects garbage after a few things are made."""


def test_widgets_that_are_garbage_may_be_there_while_the_theme_changes() -> None:
    ran = subprocess.run([sys.executable, "-c", COLLECTED_ANY_TIME], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr


def test_an_icon_has_the_colour_of_the_theme_and_is_drawn_once_a_size(qtbot: Any, theme: Callable[[str], None]) -> None:
    drawn = {}
    engine = _ThemedIcon("mdi6.square", "text")  # QIcon gives a copy of what it draws where a pixel is not one dot
    for name, shades in (("light", LIGHT), ("dark", DARK)):
        theme(name)
        pixmap = engine.pixmap(QSize(24, 24), QIcon.Mode.Normal, QIcon.State.Off)
        assert pixmap.toImage().pixelColor(12, 12) == QColor(shades.text)
        assert icon("mdi6.square", colour="bad").pixmap(QSize(9, 9)).toImage().pixelColor(4, 4) == QColor(shades.bad)
        drawn[name] = pixmap.cacheKey()
        assert engine.pixmap(QSize(24, 24), QIcon.Mode.Normal, QIcon.State.Off).cacheKey() == drawn[name]
    assert drawn["light"] != drawn["dark"]


def test_an_icon_on_what_is_chosen_has_the_colour_of_the_words_beside_it(
    qtbot: Any, theme: Callable[[str], None]
) -> None:
    for name, shades in (("light", LIGHT), ("dark", DARK)):
        theme(name)
        chosen = icon("mdi6.square", colour="good").pixmap(QSize(24, 24), QIcon.Mode.Selected)
        assert chosen.toImage().pixelColor(12, 12) == QColor(shades.on_accent)


def test_an_icon_that_is_set_once_follows_the_theme(qtbot: Any, theme: Callable[[str], None]) -> None:
    button, sign = QToolButton(), IconLabel(24)
    for widget in (button, sign):
        qtbot.addWidget(widget)
    button.setIcon(icon("mdi6.square"))
    sign.show_icon("mdi6.square", "good")
    for name, shades in (("light", LIGHT), ("dark", DARK), ("light", LIGHT)):
        theme(name)
        assert button.icon().pixmap(QSize(24, 24)).toImage().pixelColor(12, 12) == QColor(shades.text)
        assert sign.grab().toImage().pixelColor(12, 12) == QColor(shades.good)


def test_an_icon_without_room_is_not_drawn(qtbot: Any, theme: Callable[[str], None]) -> None:
    theme("light")
    assert icon("mdi6.square").pixmap(QSize(0, 0)).isNull()
    target = QPixmap(8, 8)
    painter = QPainter(target)
    icon("mdi6.square").paint(painter, QRect(0, 0, 0, 5))
    painter.end()
