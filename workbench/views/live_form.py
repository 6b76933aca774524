"""Which live source, and what it is told."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QCoreApplication, Qt
from PySide6.QtWidgets import QComboBox, QFormLayout, QLabel, QVBoxLayout, QWidget

from workbench.views.live_fields import ChoiceField, DeviceField, NumberField, RegionField


class SourceForm(QWidget):
    """Kind and device, and the settings the source has; `live` is the page's LivePresenter."""

    def __init__(self, live: Any, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.live = live
        self.kind, self.device = QComboBox(), DeviceField()
        as_it_is = self.tr("as it is")
        self.exposure = NumberField(as_it_is, " ms", 0.01, 60000.0, 2)
        self.gain = NumberField(as_it_is, " dB", -40.0, 80.0, 1)
        self.rate = NumberField(as_it_is, " /s", 0.1, 1000.0, 1)
        self.trigger, self.pixel_format, self.region = ChoiceField(as_it_is), ChoiceField(as_it_is), RegionField()
        self.files = QComboBox()
        self.missing, self.complaint = QLabel(), QLabel()
        self._device_label = QLabel()
        self._lay_out()
        self._dress()
        self._fill()
        self._connect()

    def refresh(self) -> None:
        """Show what the presenter says now."""
        live, settings = self.live, self.live.settings
        running = live.running
        self.kind.setCurrentIndex(max(self.kind.findData(settings.kind), 0))
        title, tip = _device_words(settings.kind)
        self._device_label.setText(title)
        self.device.show_devices(settings.kind, settings.choice.id, settings.devices, settings.looking)
        self.device.setToolTip(tip)
        for widget in (self.kind, self.device, self.files):
            widget.setEnabled(not running)
        can, names, values = settings.capabilities, settings.names, settings.values
        for name, number in self._numbers().items():
            number.limit(getattr(can, name))
            number.show_value(getattr(values, name))
        self.trigger.show_choices(can.triggers, values.trigger)
        self.pixel_format.show_choices(can.pixel_formats, values.pixel_format)
        self.region.show_region(values.region, can.sensor)
        for name, field in self._fields().items():
            # what can be chosen is known once the source has been open
            unknown = isinstance(field, ChoiceField) and field.count() < 2
            self._form.setRowVisible(field, name in names and not unknown)
        self._form.setRowVisible(self.files, live.step == "scan")
        self.files.setCurrentIndex(max(self.files.findData(settings.ending), 0))
        for label, sentence in ((self.missing, settings.missing), (self.complaint, settings.complaint)):
            label.setText(sentence)
            label.setVisible(bool(sentence))

    def _numbers(self) -> dict[str, NumberField]:
        return {"exposure_ms": self.exposure, "gain_db": self.gain, "rate_hz": self.rate}

    def _fields(self) -> dict[str, QWidget]:
        others = {"trigger": self.trigger, "pixel_format": self.pixel_format, "region": self.region}
        return {**self._numbers(), **others}

    def _lay_out(self) -> None:
        self._form = QFormLayout()
        self._form.setContentsMargins(0, 0, 0, 0)
        self._form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
        for label, field in (
            (QLabel(self.tr("Source")), self.kind),
            (self._device_label, self.device),
            (QLabel(self.tr("Exposure")), self.exposure),
            (QLabel(self.tr("Gain")), self.gain),
            (QLabel(self.tr("Rate")), self.rate),
            (QLabel(self.tr("Trigger")), self.trigger),
            (QLabel(self.tr("Format")), self.pixel_format),
            (QLabel(self.tr("Region")), self.region),
            (QLabel(self.tr("Files")), self.files),
        ):
            label.setBuddy(field)
            self._form.addRow(label, field)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(6)
        column.addLayout(self._form)
        for label in (self.missing, self.complaint):
            label.setObjectName("muted")
            label.setWordWrap(True)
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
            column.addWidget(label)

    def _dress(self) -> None:
        for field, name, tip in (
            (self.kind, self.tr("Kind of source"), self.tr("What delivers the pictures")),
            (self.device, self.tr("Device"), ""),
            (self.exposure, self.tr("Exposure time"), self.tr("Shorter keeps moving things sharp; longer is brighter")),
            (self.gain, self.tr("Gain"), self.tr("Brighter pictures, but more noise")),
            (self.rate, self.tr("Frame rate"), self.tr("How many pictures a second")),
            (self.trigger, self.tr("Trigger"), self.tr("What makes the camera take a picture; Off: it runs freely")),
            (self.pixel_format, self.tr("Pixel format"), self.tr("Grey levels as the camera sends them")),
            (
                self.region,
                self.tr("Region of the sensor"),
                self.tr("First column, first row, width and height in pixels. A calibration holds for its own region."),
            ),
            (
                self.files,
                self.tr("Files of the frames"),
                self.tr("PNG takes half the room on the disk, PGM a tenth of the time: for fast cameras"),
            ),
        ):
            field.setAccessibleName(name)
            field.setToolTip(tip)

    def _fill(self) -> None:
        for kind, title, tip in _kinds():
            self.kind.addItem(title, kind)
            self.kind.setItemData(self.kind.count() - 1, tip, Qt.ItemDataRole.ToolTipRole)
        self.files.addItem(self.tr("PNG, smaller"), ".png")
        self.files.addItem(self.tr("PGM, faster"), ".pgm")

    def _connect(self) -> None:
        settings = self.live.settings
        self.kind.activated.connect(lambda _: self._choose_kind())
        self.device.chosen.connect(settings.set_id)
        self.device.look.connect(settings.look_for_devices)
        for name, number in self._numbers().items():
            number.edited.connect(lambda value, name=name: settings.set_value(name, value))
        for name, choice in (("trigger", self.trigger), ("pixel_format", self.pixel_format)):
            choice.edited.connect(lambda value, name=name: settings.set_value(name, value))
        self.region.edited.connect(settings.set_region)
        self.files.activated.connect(lambda _: settings.set_ending(self.files.currentData()))

    def _choose_kind(self) -> None:
        self.live.settings.set_kind(self.kind.currentData())
        self.live.settings.look_for_devices()


def _kinds() -> tuple[tuple[str, str, str], ...]:
    """Each kind of source, its title and what it is."""
    return (
        (
            "simulated",
            _tr("Simulated rig"),
            _tr("A camera and lasers that exist only in this program, moved by hand in real time"),
        ),
        ("opencv", _tr("Camera or video"), _tr("A camera of this computer, a network camera, or a video file")),
        (
            "replay",
            _tr("Folder of pictures"),
            _tr("Recorded pictures, one after the other, as if a camera took them now"),
        ),
        ("basler", _tr("Basler camera"), _tr("An industrial camera of Basler; needs pypylon")),
        ("genicam", _tr("GenICam camera"), _tr("An industrial camera of any maker, by its GenTL producer (.cti)")),
        ("aravis", _tr("GigE or USB3 camera"), _tr("An industrial camera of any maker, by Aravis")),
    )


def _device_words(kind: str) -> tuple[str, str]:
    """What the device field of this kind is called, and its tooltip."""
    return {
        "simulated": (_tr("Scene"), _tr("What lies before the simulated rig; or the path of a scenario (TOML)")),
        "opencv": (_tr("Device"), _tr("Number of the camera (0, 1, …) or its address (rtsp://…, http://…)")),
        "replay": (_tr("Folder"), _tr("The folder of pictures to replay")),
        "basler": (_tr("Device"), _tr("Serial number of the camera; empty: the first one found")),
        "genicam": (_tr("Device"), _tr("The producer's name of the camera; empty: the first one found")),
        "aravis": (_tr("Device"), _tr("Name or network address of the camera; empty: the first one found")),
    }[kind]


def _tr(text: str) -> str:
    return QCoreApplication.translate("LivePanel", text)
