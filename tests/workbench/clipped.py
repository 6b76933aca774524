"""Words of a window that are not seen whole: what is narrower or lower than its text, or beyond its window."""

from __future__ import annotations

from collections.abc import Iterator

from PySide6.QtCore import QCoreApplication, QEvent, QPoint, QRect, Qt
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractScrollArea,
    QComboBox,
    QHeaderView,
    QLabel,
    QPushButton,
    QStyle,
    QStyleOptionButton,
    QStyleOptionComboBox,
    QStyleOptionHeader,
    QTabBar,
    QToolButton,
    QWidget,
)
from superqt import QElidingLabel

SLACK = 1
"""Pixels that a text may be wider than its place: Qt rounds widths."""
NESTED = 20
"""Layouts within layouts, at most."""


def clipped(window: QWidget) -> dict[str, str]:
    """Every text that is seen in part only, and why; a text cut with an ellipsis is seen by its tip."""
    # A text told in this very turn of the event loop has its place when what Qt has posted to the layouts is done: a
    # layout tells the one around it, which Qt does not hear of within the same call.
    for _ in range(NESTED):
        QCoreApplication.sendPostedEvents(None, QEvent.Type.LayoutRequest.value)
    found = {}
    for widget in window.findChildren(QWidget):
        if widget.isVisible():
            for text, why in _cut(widget):
                found[text] = f"{type(widget).__name__} {why}"
    return found


def _cut(widget: QWidget) -> Iterator[tuple[str, str]]:
    match widget:
        case QLabel():
            yield from _label(widget)
        case QTabBar():
            yield from _tabs(widget)
        case QHeaderView():
            yield from _heads(widget)
        case QComboBox():
            yield from _choice(widget)
        case QPushButton() | QToolButton() if widget.text():
            yield from _button(widget)
    if _is_beyond(widget) and isinstance(widget, QLabel | QAbstractButton | QComboBox | QAbstractItemView):
        said = widget.text() if isinstance(widget, QLabel | QAbstractButton) else widget.accessibleName()
        yield said or type(widget).__name__, "is beyond the window"


def _label(label: QLabel) -> Iterator[tuple[str, str]]:
    if not label.text() or (isinstance(label, QElidingLabel) and label.toolTip() and not label.wordWrap()):
        return
    inside = label.contentsRect()
    if label.wordWrap():
        needed = label.heightForWidth(label.width())
        if needed > label.height() + SLACK:
            yield label.text(), f"needs {needed} px of height, has {label.height()}"
        needed = label.minimumSizeHint().width()
    else:
        needed = label.sizeHint().width()
    if needed > max(inside.width(), label.width()) + SLACK:
        yield label.text(), f"needs {needed} px, has {label.width()}"


def _button(button: QPushButton | QToolButton) -> Iterator[tuple[str, str]]:
    if isinstance(button, QToolButton):
        if button.toolButtonStyle() in (Qt.ToolButtonStyle.ToolButtonIconOnly,) and not button.icon().isNull():
            return
        needed, has = button.sizeHint().width(), button.width()
    else:
        option = QStyleOptionButton()
        option.initFrom(button)
        inside = button.style().subElementRect(QStyle.SubElement.SE_PushButtonContents, option, button)
        needed = button.fontMetrics().size(Qt.TextFlag.TextShowMnemonic, button.text()).width()
        needed += button.iconSize().width() + 4 if not button.icon().isNull() else 0
        has = inside.width()
    if needed > has + SLACK:
        yield button.text(), f"needs {needed} px, has {has}"


def _tabs(bar: QTabBar) -> Iterator[tuple[str, str]]:
    shown = [tab for tab in range(bar.count()) if bar.isTabVisible(tab)]
    for tab in shown:
        if bar.tabRect(tab).right() > bar.width() or bar.tabRect(tab).left() < 0:
            yield bar.tabText(tab), f"ends at {bar.tabRect(tab).right()} of {bar.width()} px"
        elif bar.fontMetrics().horizontalAdvance(bar.tabText(tab)) > bar.tabRect(tab).width() and not bar.tabToolTip(
            tab
        ):
            yield bar.tabText(tab), f"has {bar.tabRect(tab).width()} px"


def _heads(heads: QHeaderView) -> Iterator[tuple[str, str]]:
    model = heads.model()
    if heads.orientation() is not Qt.Orientation.Horizontal or model is None:
        return
    for section in range(heads.count()):
        text = str(model.headerData(section, Qt.Orientation.Horizontal) or "")
        if heads.isSectionHidden(section) or not text:
            continue
        tip = model.headerData(section, Qt.Orientation.Horizontal, Qt.ItemDataRole.ToolTipRole)
        elided = heads.textElideMode() is not Qt.TextElideMode.ElideNone  # else it is cut without a sign, at either end
        option = QStyleOptionHeader()
        option.initFrom(heads)
        option.rect = QRect(0, 0, heads.sectionSize(section), heads.height())
        has = heads.style().subElementRect(QStyle.SubElement.SE_HeaderLabel, option, heads).width()
        needed = heads.fontMetrics().horizontalAdvance(text)
        if needed > has + SLACK and not (tip and elided):
            yield text, f"needs {needed} px, has {has}"


def _choice(choice: QComboBox) -> Iterator[tuple[str, str]]:
    option = QStyleOptionComboBox()
    choice.initStyleOption(option)
    inside = choice.style().subControlRect(
        QStyle.ComplexControl.CC_ComboBox, option, QStyle.SubControl.SC_ComboBoxEditField, choice
    )
    needed = choice.fontMetrics().horizontalAdvance(choice.currentText())
    if needed > inside.width() + SLACK:
        yield choice.currentText(), f"needs {needed} px, has {inside.width()}"


def _is_beyond(widget: QWidget) -> bool:
    """Whether a part of it can never be seen: it ends outside of its window or of what scrolls up and down only."""
    bounds: QWidget = widget.window()
    parent = widget.parentWidget()
    while parent is not None and parent is not bounds:
        if isinstance(parent.parentWidget(), QAbstractScrollArea):
            bounds = parent
            break
        parent = parent.parentWidget()
    place = QRect(widget.mapTo(bounds, QPoint(0, 0)), widget.size())
    if bounds is widget.window():
        return not bounds.rect().adjusted(-SLACK, -SLACK, SLACK, SLACK).contains(place)
    scrolled = bounds.parentWidget()
    assert isinstance(scrolled, QAbstractScrollArea)
    return place.right() > bounds.width() + SLACK and scrolled.horizontalScrollBar().maximum() == 0
