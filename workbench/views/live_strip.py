"""What a live recording asks of the technician and reports, for above the picture."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QEvent, Qt
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QPushButton, QSizePolicy, QToolButton, QVBoxLayout, QWidget

from workbench.theme import icon


class LiveStrip(QWidget):
    """What the recording asks, with the button that answers; whether the source is gone, too fast, or badly exposed.

    Hidden while there is nothing to say.
    """

    def __init__(self, live: Any, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.live = live
        self._gone = _Card("mdi6.power-plug-off-outline")
        self._lost = _Card("mdi6.speedometer")
        self._advice = _Card("mdi6.brightness-6", button=True)
        self._ask = _Card("mdi6.hand-pointing-right", button=True)
        self.gone, self.lost, self.advice, self.question = (card.label for card in self._cards())
        self.take_advice, self.answer = self._advice.button, self._ask.button
        self.answer.setProperty("primary", True)
        self.answer.setToolTip(self.tr("Press when it is done"))
        self.answer.clicked.connect(lambda: live.answer())
        self.take_advice.setText(self.tr("Set it"))
        self.take_advice.setToolTip(self.tr("Tell the camera so"))
        self.take_advice.clicked.connect(lambda: live.take_advice())
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 4)
        column.setSpacing(4)
        for card in self._cards():
            column.addWidget(card)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Maximum)
        live.changed.connect(self.refresh)
        live.view.connect(lambda _: self._show_lost())
        self._dress()
        self.refresh()

    def refresh(self) -> None:
        """Show what is asked and what is wrong now."""
        sentence, button = self.live.question
        self.answer.setText(button)
        self._ask.say(sentence)
        advice = self.live.advice
        self.take_advice.setVisible(advice.settings is not None)
        self._advice.say(advice.sentence)
        unplugged = self.tr(
            "The source is unplugged. What is recorded is kept; plug it in again and the recording goes on."
        )
        self._gone.say(unplugged if self.live.gone else "")
        self._show_lost()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and hasattr(self, "_gone"):
            self._dress()

    def _dress(self) -> None:
        for card in self._cards():
            card.dress()

    def _cards(self) -> tuple[_Card, ...]:
        return self._gone, self._lost, self._advice, self._ask

    def _show_lost(self) -> None:
        """Frames that are lost while it runs: told while the rate can still be lowered."""
        self._lost.say(self.live.lost_text() if self.live.running else "")
        self.setVisible(not all(card.isHidden() for card in self._cards()))


class _Card(QFrame):
    """A sign, a sentence and perhaps a button; hidden while there is no sentence."""

    def __init__(self, symbol: str, *, button: bool = False) -> None:
        super().__init__()
        self.setObjectName("card")
        self._symbol, self._sign = symbol, QToolButton()
        self.label, self.button = QLabel(), QPushButton()
        self._sign.setAutoRaise(True)
        self._sign.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.label.setWordWrap(True)
        row = QHBoxLayout(self)
        row.setContentsMargins(8, 6, 8, 6)
        row.addWidget(self._sign)
        row.addWidget(self.label, 1)
        if button:
            row.addWidget(self.button)
        self.hide()

    def say(self, sentence: str) -> None:
        if sentence != self.label.text():
            self.label.setText(sentence)
        self.setVisible(bool(sentence))

    def dress(self) -> None:
        self._sign.setIcon(icon(self._symbol, colour="warn"))
