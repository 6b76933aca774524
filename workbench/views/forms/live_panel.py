"""Controls of a live source for the side of a page, and what its recording asks and reports above the picture."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QKeySequence, QShortcut
from PySide6.QtWidgets import (
    QApplication,
    QCheckBox,
    QFrame,
    QGridLayout,
    QLabel,
    QPushButton,
    QSizePolicy,
    QToolButton,
    QWidget,
)

from workbench.language import text_of, tr
from workbench.refresh import Refresh
from workbench.theme import icon
from workbench.views import ask
from workbench.views.forms.live_form import SourceForm
from workbench.views.layouts import enable, in_column, in_row, rename

GO_ON, PAUSE = QKeySequence(Qt.Key.Key_PageDown), QKeySequence(Qt.Key.Key_PageUp)
"""The two keys of presenters and of most foot switches; they mean something only while a source is live."""
MARK = (QKeySequence(Qt.Key.Key_B), QKeySequence(Qt.Key.Key_Period))
"""A presenter's third key, which darkens a slide, sends one of these."""


class LivePanel(QWidget):
    """Panel of the live source: its settings, start, pause, take, auto, and the number of pictures.

    `live` is the page's LivePresenter; its keys mean something as long as `keys_on` is seen, by default the panel.
    """

    def __init__(self, live: Any, parent: QWidget | None = None, *, keys_on: QWidget | None = None) -> None:
        super().__init__(parent)
        self.live = live
        keys_on = keys_on or self
        self._refreshing = Refresh(self.refresh, self)
        self.form = SourceForm(live)
        self.start, self.pause, self.take, self.mark = QPushButton(), QPushButton(), QPushButton(), QPushButton()
        self.auto = QCheckBox(tr("Take pictures automatically"))
        self.add = QCheckBox(tr("Add to the pictures that are there"))
        self.sound = QCheckBox(tr("Sound"))
        self.state, self.counts = QLabel(), QLabel()
        self._go_on, self._pause_key = QShortcut(GO_ON, keys_on), QShortcut(PAUSE, keys_on)
        self._mark_keys = [QShortcut(key, keys_on) for key in MARK]
        self._lay_out()  # first: what is shown before it has a parent is a window of its own
        self._dress()
        self._connect()
        self.refresh()

    def _beep(self) -> None:
        QApplication.beep()

    def refresh(self) -> None:
        """Show the state of the live source, and which of its buttons are enabled."""
        live = self.live
        running = live.running
        self.form.refresh()
        rename(self.start, tr("Stop") if running else tr("Start live"))
        self.start.setIcon(
            icon("mdi6.stop" if running else "mdi6.play", colour="on_accent" if self.start.property("primary") else "")
        )
        can = live.buttons
        enable(
            self.start,
            can.start,
            tr("Finish; what is recorded is kept (Ctrl+L)")
            if running
            else tr("Open the source and show its pictures (Ctrl+L)"),
        )
        self.pause.setText(tr("Resume") if live.paused else tr("Pause"))
        self.pause.setIcon(icon("mdi6.record" if live.paused else "mdi6.pause"))
        for button, does in (
            (self.pause, tr("Record nothing for a while (Page Up)")),
            (self.take, tr("Take this picture now, whatever is thought of it (Ctrl+Space, Page Down)")),
            (self.mark, tr("Mark this frame, to find it again among the others (B)")),
        ):
            enable(button, can.steer, does)
        going = not can.steer
        for key in (self._go_on, self._pause_key):
            key.setEnabled(going)
        for key in self._mark_keys:
            key.setEnabled(going and live.step == "scan")
        self.sound.setChecked(live.sound)
        self.auto.blockSignals(True)
        self.auto.setChecked(live.auto)
        self.auto.blockSignals(False)
        self.add.setVisible(live.can_add)
        self.add.setChecked(live.adding)
        self.show_counts()

    def set_primary(self, primary: bool) -> None:
        """Set whether Start is shown as the page's primary button."""
        if self.start.property("primary") != primary:
            self.start.setProperty("primary", primary)
            self.start.style().unpolish(self.start)
            self.start.style().polish(self.start)
            self.refresh()

    def _on_view(self, _view: object) -> None:
        self.show_counts()

    def show_counts(self) -> None:
        """Show the recording's state, and how many pictures were recorded and lost."""
        self.state.setText(self.live.state_text())
        self.counts.setText(self.live.counts_text())
        self.state.setVisible(self.live.running)
        self.counts.setVisible(self.live.running)

    def showEvent(self, event: Any) -> None:
        super().showEvent(event)
        self._refreshing.soon()  # not now: Qt is in the middle of showing what would change
        QTimer.singleShot(0, self.live.get_ready)

    def _dress(self) -> None:
        self.take.setText(tr("Take picture"))
        self.take.setIcon(icon("mdi6.camera-iris"))
        self.mark.setText(tr("Mark"))
        self.mark.setIcon(icon("mdi6.flag-outline"))
        self.auto.setToolTip(tr("Takes a picture when it is still, sharp, and unlike those taken before"))
        self.add.setToolTip(tr("Keep the pictures in use and add the new ones; else the new ones replace them"))
        self.sound.setToolTip(tr("One sound says that a picture was taken, two that it was refused"))
        self.auto.setVisible(self.live.step != "scan")
        self.take.setVisible(self.live.step != "scan")
        self.mark.setVisible(self.live.step == "scan")
        self.state.setObjectName("heading")
        self.counts.setObjectName("muted")
        for label in (self.state, self.counts):
            label.setWordWrap(True)

    def _lay_out(self) -> None:
        buttons = QGridLayout()
        buttons.setContentsMargins(0, 0, 0, 0)
        buttons.addWidget(self.start, 0, 0)
        buttons.addWidget(self.pause, 0, 1)
        buttons.addLayout(in_row(self.take, self.mark), 1, 0, 1, 2)  # one of them is shown
        kept = in_row((self.add, 1), self.sound, spacing=8)
        in_column(self.form, buttons, self.auto, kept, self.state, self.counts, on=self, spacing=6)

    def _connect(self) -> None:
        live = self.live
        self.start.clicked.connect(lambda: live.toggle())
        self.pause.clicked.connect(lambda: live.pause(not live.paused))
        self.take.clicked.connect(lambda: live.capture())
        self.mark.clicked.connect(lambda: live.mark())
        for key in self._mark_keys:
            key.activated.connect(lambda: live.mark())
        self.auto.toggled.connect(live.set_auto)
        self.sound.clicked.connect(lambda on: live.set_sound(on))
        live.sounded.connect(self._beep)
        self._go_on.activated.connect(lambda: live.go_on())
        self._pause_key.activated.connect(lambda: live.pause(not live.paused))
        self.add.clicked.connect(lambda on: live.set_adding(on))
        live.changed.connect(self.refresh)
        live.view.connect(self._on_view)
        live.other_running.connect(self._ask_to_stop_other)
        live.settings.devices_changed.connect(self.refresh)

    def _ask_to_stop_other(self, question: str) -> None:
        ask_to_stop_other(self, self.live, question)


def ask_to_stop_other(parent: QWidget, live: Any, question: str) -> None:
    """Ask whether to stop the recording of another page, and if so start that of `live`."""
    answers = [tr("Stop it and start here"), tr("Leave it running")]
    if ask.ask(parent, tr("Live source"), question, answers) == 0:
        live.start(stop_other=True)


class LiveStrip(QWidget):
    """Strip with the request of the recording and its button, and faults: source gone, too fast, badly exposed.

    Hidden while there is nothing to say. Where the page itself says what is asked, it does not (`asks`).
    """

    def __init__(self, live: Any, parent: QWidget | None = None, *, asks: bool = True) -> None:
        super().__init__(parent)
        self.live, self._asks = live, asks
        self._gone = _Card("mdi6.power-plug-off-outline")
        self._lost = _Card("mdi6.speedometer")
        self._advice = _ButtonCard("mdi6.brightness-6")
        self._ask = _ButtonCard("mdi6.hand-pointing-right")
        self.gone, self.lost, self.advice, self.question = (card.label for card in self._cards())
        self.take_advice, self.answer = self._advice.button, self._ask.button
        self.answer.setProperty("primary", True)
        self.answer.setToolTip(tr("Press when it is done"))
        self.answer.clicked.connect(lambda: live.answer())
        self.take_advice.setText(tr("Set it"))
        self.take_advice.setToolTip(tr("Tell the camera so"))
        self.take_advice.clicked.connect(lambda: live.take_advice())
        column = in_column(on=self, margins=(0, 0, 0, 4), spacing=4)
        for card in self._cards():
            column.addWidget(card)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Maximum)
        live.changed.connect(self.refresh)
        live.view.connect(self._on_view)
        self.refresh()

    def refresh(self) -> None:
        """Show what the recording asks the user to do, and faults of the source."""
        sentence, button = self.live.question
        self.answer.setText(button)
        self._ask.say(sentence if self._asks else "")
        advice = self.live.advice
        self.take_advice.setVisible(advice.settings is not None)
        self._advice.say("" if advice.sentence is None else text_of(advice.sentence))
        unplugged = tr("The source is unplugged. What is recorded is kept; plug it in again and the recording goes on.")
        self._gone.say(unplugged if self.live.gone else "")
        self._show_lost()

    def _cards(self) -> tuple[_Card, ...]:
        return self._gone, self._lost, self._advice, self._ask

    def _on_view(self, _view: object) -> None:
        self._show_lost()

    def _show_lost(self) -> None:
        """Frames that are lost while it runs: told while the rate can still be lowered."""
        self._lost.say(self.live.lost_text() if self.live.running else "")
        self.setVisible(not all(card.isHidden() for card in self._cards()))


class _Card(QFrame):
    """A sign and a sentence; hidden while there is none."""

    def __init__(self, symbol: str) -> None:
        super().__init__()
        self.setObjectName("card")
        self._sign = QToolButton()
        self._sign.setIcon(icon(symbol, colour="warn"))
        self.label = QLabel()
        self._sign.setAutoRaise(True)
        self._sign.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.label.setWordWrap(True)
        self._row = in_row(self._sign, (self.label, 1), on=self, margins=(8, 6, 8, 6))
        self.hide()

    def say(self, sentence: str) -> None:
        if sentence != self.label.text():
            self.label.setText(sentence)
        self.setVisible(bool(sentence))


class _ButtonCard(_Card):
    """A card with a button that answers."""

    def __init__(self, symbol: str) -> None:
        super().__init__(symbol)
        self.button = QPushButton()
        self._row.addWidget(self.button)
