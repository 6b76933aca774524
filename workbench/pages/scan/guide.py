"""The band above the picture while a scan is recorded, to be read from two metres."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QRect, QSize, Qt, Signal
from PySide6.QtGui import QFont, QFontMetrics, QResizeEvent
from PySide6.QtWidgets import QFrame, QLabel, QPushButton, QSizePolicy, QToolButton, QWidget

from core.messages import unparted
from workbench.language import tr
from workbench.pages.scan.presenter import ScanPresenter
from workbench.theme import icon
from workbench.views.colours import Level
from workbench.views.common import IconLabel, dress_edged, grade_words
from workbench.views.layouts import STRETCH, Elided, enable, in_column, in_row
from workbench.views.plots.meters import Steady

HEIGHT = 124
"""Pixels of the band."""
LARGEST, SMALLEST = 34, 15
"""Pixels of the letters of the sentence: the largest that let it stand there whole."""
LIGHTS: dict[Level, tuple[str, str]] = {
    "": ("mdi6.hand-pointing-right", "accent"),
    "good": ("mdi6.check-circle", "good"),
    "warn": ("mdi6.alert-rhombus", "warn"),
    "bad": ("mdi6.close-octagon", "bad"),
}
"""Sign and colour of the light; the shapes differ as well."""


class Large(QLabel):
    """Sentence in letters as large as there is room for."""

    def __init__(self) -> None:
        super().__init__()
        self.setWordWrap(True)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Ignored)

    def setText(self, text: str) -> None:
        text = unparted(text)
        if text != self.text():
            super().setText(text)
            self._fit()

    def sizeHint(self) -> QSize:
        return QSize(320, SMALLEST)

    def minimumSizeHint(self) -> QSize:
        return QSize(110, SMALLEST)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit()

    def _fit(self) -> None:
        font, room = QFont(self.font()), QRect(0, 0, self.width(), 10_000)
        font.setWeight(QFont.Weight.DemiBold)
        for px in range(LARGEST, SMALLEST - 1, -1):
            font.setPixelSize(px)
            taken = QFontMetrics(font).boundingRect(room, int(Qt.TextFlag.TextWordWrap), self.text())
            if taken.height() <= self.height() and taken.width() <= self.width():
                break
        self.setFont(font)


class GuideBand(QFrame):
    """Band with a light, a sentence, the coverage, the number of frames, and one large button."""

    exchange_wanted = Signal()
    """The picture and the points are to change places."""

    def __init__(self, presenter: ScanPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self._light, self.sentence, self.beside = IconLabel(60), Large(), Elided()
        self.covered, self.needed, self.counts = QLabel(), QLabel(), QLabel()
        self.go, self.exchange = QPushButton(), QToolButton()
        self.sentence.setAccessibleName(tr("Hint"))
        self.beside.setObjectName("muted")
        for label, px in ((self.covered, 40), (self.needed, 22), (self.counts, 22)):
            font = QFont(label.font())
            font.setPixelSize(px)
            label.setFont(font)
            label.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.covered.setToolTip(tr("Share of the picture between all laser light in which there are points"))
        self.go.setProperty("primary", True)
        self.go.setStyleSheet("font-size: 24px; padding: 0 18px;")
        self.go.setMinimumSize(130, HEIGHT - 36)
        self.go.clicked.connect(presenter.live.go_on)
        self.exchange.setIcon(icon("mdi6.swap-horizontal"))
        self.exchange.setIconSize(QSize(28, 28))
        self.exchange.setAutoRaise(True)
        self.exchange.setToolTip(tr("Let picture and points change places (X)"))
        self.exchange.setAccessibleName(self.exchange.toolTip())
        self.exchange.clicked.connect(self.exchange_wanted)
        words = in_column((self.sentence, 1), self.beside, spacing=2)
        numbers = in_column(STRETCH, self.covered, self.needed, self.counts, STRETCH, spacing=0)
        in_row(
            self._light, (words, 1), numbers, self.exchange, self.go,
            on=self, margins=(14, 8, 12, 8), spacing=14,
        )  # fmt: skip
        self.setFixedHeight(HEIGHT)
        self.hide()
        self._steady = Steady(self)
        self._steady.shown.connect(self._show)

    def refresh(self) -> None:
        """Show the present guidance and counts; a sentence stays for at least a second."""
        live, now = self._presenter.live, self._presenter.guidance
        self._steady.show((now.level, now.sentence), at_once=now.level == "")
        self.beside.setText(now.beside)
        self.beside.setVisible(bool(now.beside))
        self.covered.setText(now.covered)
        self.needed.setText(now.needed)
        self.counts.setText(tr("{count} frames", count=live.recorded) if now.covered else "")
        self.exchange.setVisible(bool(now.covered))
        self.go.setText(now.button)
        enable(self.go, live.buttons.start, tr("Space, Page Down, or a foot switch"))

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._show(self._steady.now)

    def _show(self, said: tuple[Level, str] | None) -> None:
        if said is None:
            return
        level, words = said
        self.sentence.setText(words)
        self._light.show_icon(*LIGHTS[level])
        self._light.setToolTip(grade_words()[level])
        dress_edged(self, LIGHTS[level][1])
