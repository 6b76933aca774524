"""Pages of a document below each other, as wide as there is room or as the eye wants them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QRect, QSize, Qt, QTimer, Signal
from PySide6.QtGui import (
    QColor,
    QHideEvent,
    QImage,
    QKeyEvent,
    QPainter,
    QPaintEvent,
    QPixmap,
    QResizeEvent,
    QShowEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QLabel, QScrollArea, QStackedLayout, QToolButton, QVBoxLayout, QWidget

from workbench.language import tr
from workbench.theme import icon, shades
from workbench.views.common import dress, inner_edge
from workbench.views.empty_state import EmptyState
from workbench.views.layouts import STRETCH, in_column, in_row, set_text

DIM = 0.45
"""Opacity of a page that is no longer what it should say."""


class PageSheet(QWidget):
    """Page of a document. Drawn quickly until `sharpen` has scaled it well."""

    def __init__(self, page: NDArray[np.uint8], number: int) -> None:
        super().__init__()
        self._page = np.ascontiguousarray(page)
        height, width, _ = self._page.shape
        self._image = QImage(self._page.data, width, height, 3 * width, QImage.Format.Format_RGB888)
        self._sharp: QPixmap | None = None
        self._dim = False
        self.setAccessibleName(tr("Page {number}", number=number))

    @property
    def is_sharp(self) -> bool:
        """Whether the page is drawn with smooth scaling at its present size."""
        return self._sharp is not None and self._sharp.size() == self._wanted()

    def sharpen(self) -> None:
        """Draw the page with smooth scaling, which takes some ten milliseconds."""
        wanted, ratio = self._wanted(), self.devicePixelRatioF()
        mode = Qt.TransformationMode.SmoothTransformation
        self._sharp = QPixmap.fromImage(self._image.scaled(wanted, Qt.AspectRatioMode.IgnoreAspectRatio, mode))
        self._sharp.setDevicePixelRatio(ratio)
        self.update()

    def set_width(self, width: int) -> None:
        """Set the width of the page in px; the height follows in proportion."""
        size = QSize(width, round(width * self._image.height() / self._image.width()))
        if size != self.size():
            self.setFixedSize(size)

    def set_dim(self, dim: bool) -> None:
        """Dim the page, as it is out of date, or show it normally."""
        if dim != self._dim:
            self._dim = dim
            self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setClipRect(event.rect())
        if self._dim:
            painter.setOpacity(DIM)
        if self._sharp is not None and self.is_sharp:
            painter.drawPixmap(0, 0, self._sharp)
        else:
            painter.drawImage(self.rect(), self._image)
        painter.setOpacity(1.0)
        painter.setPen(QColor(shades().line))
        painter.drawRect(inner_edge(self))
        painter.end()

    def _wanted(self) -> QSize:
        return self.size() * self.devicePixelRatioF()


WIDEST_PX, NARROWEST_PX = 1000, 300
"""A page that fits is never wider or narrower than this."""

ZOOM_STEP, LEAST_ZOOM, MOST_ZOOM = 1.2, 0.5, 3.0
"""Factor of one step of the zoom, and its bounds; 1 is a page that fits the width of the view."""
SHARPEN_AFTER_MS = 80
"""While the size changes pages are drawn quickly; they get sharp when it has stood still for so long."""

GAP_PX = 14
"""Pixels between pages and around them."""


class PageScroll(QWidget):
    """View of pages; Ctrl with the wheel, the keys + − 0 and the buttons make them larger or smaller."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.sheets: list[PageSheet] = []
        self._zoom = 1.0
        self._empty = EmptyState()
        self._scroll = _Scroll()
        self._scroll.setAccessibleName(tr("Pages of the report"))
        self._inside = QWidget()
        self._column = QVBoxLayout(self._inside)
        self._column.setSpacing(GAP_PX)
        self._column.setAlignment(Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignTop)
        self._scroll.setWidget(self._inside)
        self._note = QLabel(self._scroll)
        self._note.hide()
        self._place = QLabel()
        self._place.setObjectName("muted")
        self.smaller, self.fit, self.larger = QToolButton(), QToolButton(), QToolButton()
        self._tools = self._strip()
        shown = QWidget()
        in_column((self._scroll, 1), self._tools, on=shown, spacing=0)
        self._stack = QStackedLayout(self)
        self._stack.addWidget(self._empty)
        self._stack.addWidget(shown)
        self._sharpen = QTimer(self)
        self._sharpen.setSingleShot(True)
        self._sharpen.timeout.connect(self._sharpen_one)
        self._scroll.resized.connect(self._fit)
        self._scroll.zoomed.connect(self.zoom)
        self._scroll.verticalScrollBar().valueChanged.connect(lambda _: self._moved())
        self._dress()

    def set_pages(self, pages: Sequence[NDArray[np.uint8]]) -> None:
        """Show pages (h, w, 3) RGB one below the other; the scroll position is kept."""
        place = self._scroll.verticalScrollBar().value()
        for sheet in self.sheets:
            self._column.removeWidget(sheet)
            sheet.hide()
            sheet.deleteLater()
        self.sheets = [PageSheet(page, number) for number, page in enumerate(pages, start=1)]
        for sheet in self.sheets:
            self._column.addWidget(sheet, 0, Qt.AlignmentFlag.AlignHCenter)
            sheet.show()
        self._stack.setCurrentIndex(1 if self.sheets else 0)
        self._fit()
        self._scroll.verticalScrollBar().setValue(place)
        self._sharpen.start(0)

    def set_message(self, text: str, button: str = "", on_button: Callable[[], None] | None = None) -> None:
        """Set the sentence, and the button if any, that are shown while there are no pages."""
        self._empty.set_text(text, button, on_button)

    def set_note(self, text: str) -> None:
        """Dim the pages and show over them why they are out of date; "" shows them normally."""
        if text != self._note.text() or bool(text) == self._note.isHidden():
            set_text(self._note, text)
            self._place_note()
            for sheet in self.sheets:
                sheet.set_dim(bool(text))

    @property
    def note(self) -> str:
        """Note over the pages on why they are out of date; "" if they are not."""
        return self._note.text()

    @property
    def message(self) -> str:
        """Sentence shown because there are no pages; "" if there are some."""
        return "" if self.sheets else self._empty.message

    def count(self) -> int:
        """Return how many pages are shown."""
        return len(self.sheets)

    def zoom(self, factor: float) -> None:
        """Enlarge the pages by `factor`, with the same place in the middle; 0 fits them to the width."""
        bar = self._scroll.verticalScrollBar()
        middle = (bar.value() + bar.pageStep() / 2) / max(self._inside.height(), 1)
        self._zoom = min(max(self._zoom * factor, LEAST_ZOOM), MOST_ZOOM) if factor else 1.0
        self._fit()
        bar.setValue(round(middle * self._inside.height() - bar.pageStep() / 2))

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._dress()

    def event(self, event: QEvent) -> bool:
        if event.type() == QEvent.Type.DevicePixelRatioChange:
            self._sharpen.start(SHARPEN_AFTER_MS)
        return super().event(event)

    def hideEvent(self, event: QHideEvent) -> None:
        self._sharpen.stop()
        super().hideEvent(event)

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self._sharpen.start(0)

    def _fit(self) -> None:
        """Give every page its width; it gets sharp when the width stays."""
        room = self._scroll.viewport().width() - 2 * GAP_PX
        width = round(max(NARROWEST_PX, min(room, WIDEST_PX)) * self._zoom)
        for sheet in self.sheets:
            sheet.set_width(width)
        self._column.activate()  # now, not with the next event: what is in sight and the bars rest on it
        self._inside.resize(self._column.minimumSize().expandedTo(self._scroll.viewport().size()))
        self._place_note()
        self._moved(SHARPEN_AFTER_MS)

    def _moved(self, after_ms: int = 0) -> None:
        """Something else is in sight."""
        if self.isVisible() and any(not sheet.is_sharp for sheet in self._in_sight()):
            self._sharpen.start(after_ms)
        self._say_place()

    def _in_sight(self) -> list[PageSheet]:
        bar = self._scroll.verticalScrollBar()
        seen = QRect(0, bar.value(), self._inside.width(), self._scroll.viewport().height())
        return [sheet for sheet in self.sheets if seen.intersects(sheet.geometry())]

    def _sharpen_one(self) -> None:
        """One page at a time, so that nothing waits for all of them."""
        blurred = [sheet for sheet in self._in_sight() if not sheet.is_sharp]
        if blurred:
            blurred[0].sharpen()
        if len(blurred) > 1:
            self._sharpen.start(0)
        self._say_place()

    def _say_place(self) -> None:
        seen = self._in_sight()
        number = self.sheets.index(seen[len(seen) // 2 if len(seen) > 2 else 0]) + 1 if seen else 1
        self._place.setText(tr("Page {number} of {total}", number=number, total=max(len(self.sheets), 1)))

    def _place_note(self) -> None:
        self._note.adjustSize()
        self._note.move((self._scroll.viewport().width() - self._note.width()) // 2, 12)
        self._note.raise_()

    def _strip(self) -> QWidget:
        strip = QWidget()
        row = in_row(self._place, STRETCH, on=strip, margins=(6, 3, 2, 1), spacing=2)
        for button, factor, symbol, tip in (
            (self.smaller, 1 / ZOOM_STEP, "mdi6.magnify-minus-outline", tr("Smaller (−)")),
            (self.fit, 0.0, "mdi6.fit-to-page-outline", tr("As wide as there is room (0)")),
            (self.larger, ZOOM_STEP, "mdi6.magnify-plus-outline", tr("Larger (+)")),
        ):
            button.setIcon(icon(symbol))
            button.setAutoRaise(True)
            button.setToolTip(tip)
            button.setAccessibleName(tip)
            button.clicked.connect(lambda _=False, by=factor: self.zoom(by))
            row.addWidget(button)
        return strip

    def _dress(self) -> None:
        s = shades()
        dress(
            self._note,
            f"background: {s.panel}; color: {s.text}; border: 1px solid {s.accent}; border-radius: 4px;"
            " padding: 5px 12px;",
        )


class _Scroll(QScrollArea):
    """Tells its size, and when the keys or the wheel ask for another."""

    resized = Signal()
    zoomed = Signal(float)

    def __init__(self) -> None:
        super().__init__()
        self.setWidgetResizable(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOn)  # else the width goes to and fro

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.resized.emit()

    def wheelEvent(self, event: QWheelEvent) -> None:
        if event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            self.zoomed.emit(ZOOM_STEP if event.angleDelta().y() > 0 else 1 / ZOOM_STEP)
            event.accept()
        else:
            super().wheelEvent(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        key, bar = Qt.Key(event.key()), self.verticalScrollBar()
        if key in (Qt.Key.Key_Plus, Qt.Key.Key_Equal):
            self.zoomed.emit(ZOOM_STEP)
        elif key == Qt.Key.Key_Minus:
            self.zoomed.emit(1 / ZOOM_STEP)
        elif key == Qt.Key.Key_0:
            self.zoomed.emit(0.0)
        elif key in (Qt.Key.Key_Home, Qt.Key.Key_End):
            bar.setValue(bar.minimum() if key == Qt.Key.Key_Home else bar.maximum())
        elif key in (Qt.Key.Key_Space, Qt.Key.Key_PageDown, Qt.Key.Key_PageUp):
            bar.setValue(bar.value() + bar.pageStep() * (-1 if key == Qt.Key.Key_PageUp else 1))
        else:
            super().keyPressEvent(event)
