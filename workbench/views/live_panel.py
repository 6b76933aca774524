"""Controls of a live source, for the side of a page; and what it asks and reports, for above the picture."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QCoreApplication, QEvent, Qt, QTimer
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QFormLayout,
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSizePolicy,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from workbench.theme import icon
from workbench.views import ask
from workbench.views.live_fields import DeviceField, NumberField


class LivePanel(QWidget):
    """Which source, its settings, start, pause, take, auto; and how many pictures there are.

    `live` is the page's LivePresenter.
    """

    def __init__(self, live: Any, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.live = live
        self.kind, self.device = QComboBox(), DeviceField()
        self.exposure = NumberField(self.tr("as it is"), " ms", 0.01, 60000.0, 2)
        self.gain = NumberField(self.tr("as it is"), " dB", -40.0, 80.0, 1)
        self.rate = NumberField(self.tr("as it is"), " /s", 0.1, 1000.0, 1)
        self.start, self.pause, self.take = QPushButton(), QPushButton(), QPushButton()
        self.auto = QCheckBox(self.tr("Take pictures automatically"))
        self.add = QCheckBox(self.tr("Add to the pictures that are there"))
        self.state, self.counts = QLabel(), QLabel()
        self._dress()
        self._lay_out()
        self._connect()
        self._fill_kinds()
        self.refresh()

    def refresh(self) -> None:
        """Show what the presenter says now."""
        live, settings = self.live, self.live.settings
        running, going = live.running, live.live
        self.kind.blockSignals(True)
        self.kind.setCurrentIndex(max(self.kind.findData(settings.kind), 0))
        self.kind.blockSignals(False)
        self.kind.setEnabled(not running)
        self.device.setEnabled(not running)
        self._device_label.setText(_device_words(settings.kind)[0])
        self.device.show_devices(settings.kind, settings.choice.id, settings.devices, settings.looking)
        self.device.setToolTip(_device_words(settings.kind)[1])
        for name, field in self._numbers().items():
            self._form.setRowVisible(field, settings.can(name))
            field.show_value(getattr(settings.values, name))
        self.start.setText(self.tr("Stop") if running else self.tr("Start live"))
        self.start.setIcon(
            icon("mdi6.stop" if running else "mdi6.play", colour="on_accent" if self.start.property("primary") else "")
        )
        cannot = "" if running else live.cannot_start()
        self.start.setEnabled(not live.stopping and not cannot)
        self.start.setToolTip(
            self.tr("Finish; what is recorded is kept (Ctrl+L)")
            if running
            else cannot or self.tr("Open the source and show its pictures (Ctrl+L)")
        )
        self.pause.setText(self.tr("Resume") if live.paused else self.tr("Pause"))
        self.pause.setIcon(icon("mdi6.record" if live.paused else "mdi6.pause"))
        self.take.setIcon(icon("mdi6.camera-iris"))
        why_not = "" if going else self.tr("Start the live source first.")
        for button, does in (
            (self.pause, self.tr("Record nothing for a while")),
            (self.take, self.tr("Take this picture now, whatever is thought of it (Ctrl+Space)")),
        ):
            button.setEnabled(going)
            button.setToolTip(why_not or does)
        self.auto.blockSignals(True)
        self.auto.setChecked(live.auto)
        self.auto.blockSignals(False)
        self.add.setVisible(live.can_add)
        self.add.setChecked(live.adding)
        self.show_counts()

    def set_primary(self, primary: bool) -> None:
        """Whether Start is the page's one primary button now."""
        if self.start.property("primary") != primary:
            self.start.setProperty("primary", primary)
            self.start.style().unpolish(self.start)
            self.start.style().polish(self.start)
            self.refresh()

    def show_counts(self) -> None:
        """Show the state and the numbers of pictures."""
        self.state.setText(self.live.state_text())
        self.counts.setText(self.live.counts_text())
        self.state.setVisible(self.live.running)
        self.counts.setVisible(self.live.running)

    def showEvent(self, event: Any) -> None:
        super().showEvent(event)
        self.refresh()
        QTimer.singleShot(0, self.live.get_ready)

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and hasattr(self, "_form"):
            self.refresh()

    def _dress(self) -> None:
        self.kind.setToolTip(self.tr("What delivers the pictures"))
        self.kind.setAccessibleName(self.tr("Kind of source"))
        self.device.setAccessibleName(self.tr("Device"))
        for field, name, tip in (
            (self.exposure, self.tr("Exposure time"), self.tr("Shorter keeps moving things sharp; longer is brighter")),
            (self.gain, self.tr("Gain"), self.tr("Brighter pictures, but more noise")),
            (self.rate, self.tr("Frame rate"), self.tr("How many pictures a second")),
        ):
            field.setAccessibleName(name)
            field.setToolTip(tip)
        self.take.setText(self.tr("Take picture"))
        self.auto.setToolTip(self.tr("Takes a picture when it is still, sharp, and unlike those taken before"))
        self.add.setToolTip(self.tr("Keep the pictures in use and add the new ones; else the new ones replace them"))
        self.auto.setVisible(self.live.step != "scan")
        self.take.setVisible(self.live.step != "scan")
        self.state.setObjectName("heading")
        self.counts.setObjectName("muted")
        for label in (self.state, self.counts):
            label.setWordWrap(True)

    def _lay_out(self) -> None:
        self._form = QFormLayout()
        self._form.setContentsMargins(0, 0, 0, 0)
        self._form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
        self._device_label = QLabel()
        for label, field in (
            (QLabel(self.tr("Source")), self.kind),
            (self._device_label, self.device),
            (QLabel(self.tr("Exposure")), self.exposure),
            (QLabel(self.tr("Gain")), self.gain),
            (QLabel(self.tr("Rate")), self.rate),
        ):
            label.setBuddy(field)
            self._form.addRow(label, field)
        buttons = QGridLayout()
        buttons.setContentsMargins(0, 0, 0, 0)
        buttons.addWidget(self.start, 0, 0)
        buttons.addWidget(self.pause, 0, 1)
        buttons.addWidget(self.take, 1, 0, 1, 2)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(6)
        column.addLayout(self._form)
        column.addLayout(buttons)
        column.addWidget(self.auto)
        column.addWidget(self.add)
        column.addWidget(self.state)
        column.addWidget(self.counts)

    def _connect(self) -> None:
        live, settings = self.live, self.live.settings
        self.kind.activated.connect(lambda _: self._choose_kind())
        self.device.chosen.connect(settings.set_id)
        self.device.look.connect(settings.look_for_devices)
        for name, field in self._numbers().items():
            field.edited.connect(lambda value, name=name: settings.set_value(name, value))
        self.start.clicked.connect(lambda: live.toggle())
        self.pause.clicked.connect(lambda: live.pause(not live.paused))
        self.take.clicked.connect(lambda: live.capture())
        self.auto.toggled.connect(live.set_auto)
        self.add.clicked.connect(lambda on: live.set_adding(on))
        live.changed.connect(self.refresh)
        live.view.connect(lambda _: self.show_counts())
        live.other_running.connect(self._ask_to_stop_other)
        settings.devices_changed.connect(self.refresh)

    def _fill_kinds(self) -> None:
        for kind, title, tip in (
            (
                "simulated",
                self.tr("Simulated rig"),
                self.tr("A camera and lasers that exist only in this program, moved by hand in real time"),
            ),
            (
                "opencv",
                self.tr("Camera or video"),
                self.tr("A camera of this computer, a network camera, or a video file"),
            ),
            ("basler", self.tr("Basler camera"), self.tr("An industrial camera of Basler; needs pypylon")),
            (
                "replay",
                self.tr("Folder of pictures"),
                self.tr("Recorded pictures, one after the other, as if a camera took them now"),
            ),
        ):
            self.kind.addItem(title, kind)
            self.kind.setItemData(self.kind.count() - 1, tip, Qt.ItemDataRole.ToolTipRole)

    def _choose_kind(self) -> None:
        self.live.settings.set_kind(self.kind.currentData())
        self.live.settings.look_for_devices()

    def _numbers(self) -> dict[str, NumberField]:
        return {"exposure_ms": self.exposure, "gain_db": self.gain, "rate_hz": self.rate}

    def _ask_to_stop_other(self, question: str) -> None:
        answers = [self.tr("Stop it and start here"), self.tr("Leave it running")]
        if ask.ask(self, self.tr("Live source"), question, answers) == 0:
            self.live.start(stop_other=True)


class LiveStrip(QWidget):
    """What the recording asks of the technician, with the button that answers; whether the source is gone or too fast.

    Hidden while there is nothing to say. For above the picture.
    """

    def __init__(self, live: Any, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.live = live
        self.question, self.answer = QLabel(), QPushButton()
        self.gone, self.lost = QLabel(), QLabel()
        self._signs = QToolButton(), QToolButton(), QToolButton()
        self._ask = _card(self._signs[0], self.question, self.answer)
        self._gone = _card(self._signs[1], self.gone, None)
        self._lost = _card(self._signs[2], self.lost, None)
        self.answer.setProperty("primary", True)
        self.answer.clicked.connect(lambda: live.answer())
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 4)
        column.setSpacing(4)
        column.addWidget(self._gone)
        column.addWidget(self._lost)
        column.addWidget(self._ask)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Maximum)
        live.changed.connect(self.refresh)
        live.view.connect(lambda _: self._show_lost())
        self.refresh()

    def refresh(self) -> None:
        """Show what is asked and what is wrong now."""
        symbols = ("mdi6.hand-pointing-right", "mdi6.power-plug-off-outline", "mdi6.speedometer")
        for sign, symbol in zip(self._signs, symbols, strict=True):
            sign.setIcon(icon(symbol, colour="warn"))
        sentence, button = self.live.question
        self.question.setText(sentence)
        self.answer.setText(button)
        self.answer.setToolTip(self.tr("Press when it is done"))
        self._ask.setVisible(bool(sentence))
        self.gone.setText(
            self.tr("The source is unplugged. What is recorded is kept; plug it in again and the recording goes on.")
        )
        self._gone.setVisible(self.live.gone)
        self._show_lost()

    def _show_lost(self) -> None:
        """Frames that are lost while it runs: told while the rate can still be lowered."""
        lost = self.live.lost_text() if self.live.running else ""
        if lost != self.lost.text():
            self.lost.setText(lost)
        self._lost.setVisible(bool(lost))
        self.setVisible(bool(lost) or bool(self.question.text()) or self.live.gone)

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and hasattr(self, "_gone"):
            self.refresh()


def _card(sign: QToolButton, label: QLabel, button: QPushButton | None) -> QFrame:
    card = QFrame()
    card.setObjectName("card")
    sign.setAutoRaise(True)
    sign.setFocusPolicy(Qt.FocusPolicy.NoFocus)
    label.setWordWrap(True)
    row = QHBoxLayout(card)
    row.setContentsMargins(8, 6, 8, 6)
    row.addWidget(sign)
    row.addWidget(label, 1)
    if button is not None:
        row.addWidget(button)
    return card


def _device_words(kind: str) -> tuple[str, str]:
    """What the device field of this kind is called, and its tooltip."""
    return {
        "simulated": (_tr("Scene"), _tr("What lies before the simulated rig; or the path of a scenario (TOML)")),
        "opencv": (_tr("Device"), _tr("Number of the camera (0, 1, …) or its address (rtsp://…, http://…)")),
        "basler": (_tr("Device"), _tr("Serial number of the camera; empty: the first one found")),
        "replay": (_tr("Folder"), _tr("The folder of pictures to replay")),
    }[kind]


def _tr(text: str) -> str:
    return QCoreApplication.translate("LivePanel", text)
