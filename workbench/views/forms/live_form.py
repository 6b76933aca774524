"""Which live source, and what it is told: fields that may be left as they are, and the form of them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QDoubleSpinBox,
    QFormLayout,
    QLabel,
    QLineEdit,
    QToolButton,
    QWidget,
)

from core.acquire.source import Region, SourceInfo
from core.acquire.source_kind import SourceKind
from core.pipeline.live.sources import SOURCES
from workbench.language import text_of, tr
from workbench.theme import icon
from workbench.views import ask
from workbench.views.common import Choice, SpinBox
from workbench.views.layouts import enable, in_column, in_row, set_text


class DeviceField(QWidget):
    """Field of a device: of the list, or any other typed in; for a replay a folder."""

    chosen = Signal(str)
    look = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._is_folder = False
        self.box, self.button = Choice(), QToolButton()
        self.box.setEditable(True)
        self.box.setInsertPolicy(Choice.InsertPolicy.NoInsert)
        self.box.setMinimumContentsLength(8)
        self.box.setSizeAdjustPolicy(Choice.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.setFocusProxy(self.box)
        in_row((self.box, 1), self.button, on=self, spacing=4)
        self.box.activated.connect(lambda _: self.chosen.emit(str(self.box.currentData() or "")))
        edit = self.box.lineEdit()
        assert edit is not None
        edit.editingFinished.connect(self._typed)
        self.button.clicked.connect(self._pressed)

    def setAccessibleName(self, name: str) -> None:
        super().setAccessibleName(name)
        self.box.setAccessibleName(name)

    def setToolTip(self, tip: str) -> None:
        super().setToolTip(tip)
        self.box.setToolTip(tip)

    def show_devices(self, kind: SourceKind, chosen: str, devices: Sequence[SourceInfo], looking: bool) -> None:
        """Show the list of devices of a kind of source and the one chosen; `looking`: the search still runs."""
        self._is_folder = kind.is_folder
        self.box.blockSignals(True)
        self.box.clear()
        names = [text_of(device.name) for device in devices]
        for place, (name, device) in enumerate(zip(names, devices, strict=True)):
            detail = text_of(device.detail)
            self.box.addItem(f"{name} – {detail}" if detail and names.count(name) > 1 else name, device.choice.id)
            self.box.setItemData(place, detail, Qt.ItemDataRole.ToolTipRole)
        place = self.box.findData(chosen)
        if place >= 0:
            self.box.setCurrentIndex(place)
        else:
            self.box.setCurrentIndex(-1)
            self.box.setEditText(chosen)
        edit = self.box.lineEdit()
        assert edit is not None
        edit.setPlaceholderText(text_of(kind.usual))
        edit.setCursorPosition(0)
        self.box.blockSignals(False)
        browse = kind.is_folder
        self.button.setIcon(icon("mdi6.folder-open-outline" if browse else "mdi6.magnify"))
        tip = tr("Choose the folder to replay") if browse else tr("Look for cameras of this kind")
        enable(self.button, tr("Looking …") if looking else "", tip)
        self.button.setAccessibleName(self.button.toolTip())

    def _typed(self) -> None:
        text = self.box.currentText().strip()
        if self.box.currentIndex() < 0 or text != self.box.itemText(self.box.currentIndex()):
            self.chosen.emit(text)

    def _pressed(self) -> None:
        if not self._is_folder:
            self.look.emit()
            return
        start = Path(self.box.currentText()) if self.box.currentText() else Path.home()
        folder = ask.choose_folder(self, tr("Folder to replay"), start)
        if folder is not None:
            self.chosen.emit(str(folder))


class NumberField(SpinBox):
    """Field of a number with its unit; its lowest step is "as it is", which is None."""

    edited = Signal(object)

    def __init__(self, none_text: str, unit: str, low: float, high: float, decimals: int) -> None:
        super().__init__()
        self._usual = low, high
        self.setDecimals(decimals)
        self.limit(None)
        self.setSpecialValueText(none_text)
        self.setSuffix(unit)
        self.setKeyboardTracking(False)
        self.setStepType(QDoubleSpinBox.StepType.AdaptiveDecimalStepType)
        self.show_value(None)
        self.valueChanged.connect(lambda value: self.edited.emit(None if value <= self._nothing else value))

    def limit(self, limits: tuple[float, float] | None) -> None:
        """Limit the numbers to what the camera allows; None: to what any camera may allow."""
        low, high = limits or self._usual
        self.blockSignals(True)
        self._nothing = low - 10 ** -self.decimals()
        self.setRange(self._nothing, high)
        self.blockSignals(False)

    def show_value(self, value: float | None) -> None:
        """Show a number; None shows "as it is", which leaves the setting to the source."""
        self.blockSignals(True)
        self.setValue(self._nothing if value is None else value)
        self.blockSignals(False)


class ChoiceField(Choice):
    """Field of one of several words; the first entry is "as it is", which is None."""

    edited = Signal(object)

    def __init__(self, none_text: str) -> None:
        super().__init__()
        self._none_text = none_text
        self.addItem(none_text, None)
        self.activated.connect(lambda _: self.edited.emit(self.currentData()))

    def show_choices(self, choices: Sequence[str], chosen: str | None) -> None:
        """Show the words to choose from, and the chosen one; None is "as it is"."""
        wanted = [None, *choices, *([chosen] if chosen and chosen not in choices else [])]
        if wanted != [self.itemData(place) for place in range(self.count())]:
            self.clear()
            for word in wanted:
                self.addItem(word or self._none_text, word)
        self.setCurrentIndex(max(self.findData(chosen), 0))


class RegionField(QLineEdit):
    """Field of a part of the sensor as four whole numbers; empty is "as it is"."""

    edited = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self._shown = ""
        self.editingFinished.connect(self._finished)

    def show_region(self, region: Region | None, sensor: tuple[int, int] | None) -> None:
        """Show the part of the sensor that is read, or "as it is" for None; `sensor` is (width, height) in px."""
        shown = "" if region is None else f"{region.left} {region.top} {region.width} {region.height}"
        whole = tr("as it is")
        self.setPlaceholderText(whole if sensor is None else f"{whole} (0 0 {sensor[0]} {sensor[1]})")
        if shown != self._shown:
            self._shown = shown
            self.setText(shown)

    def _finished(self) -> None:
        if self.text() != self._shown:
            self.edited.emit(self.text())


class SourceForm(QWidget):
    """Form of kind and device, and the settings the source has; `live` is the page's LivePresenter."""

    def __init__(self, live: Any, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.live = live
        self.kind, self.device = Choice(), DeviceField()
        as_it_is = tr("as it is")
        self.exposure = NumberField(as_it_is, " ms", 0.01, 60000.0, 2)
        self.gain = NumberField(as_it_is, " dB", -40.0, 80.0, 1)
        self.rate = NumberField(as_it_is, " /s", 0.1, 1000.0, 1)
        self.trigger, self.pixel_format, self.region = ChoiceField(as_it_is), ChoiceField(as_it_is), RegionField()
        self.files = Choice()
        self.missing, self.complaint = QLabel(), QLabel()
        self._device_label = QLabel()
        self._lay_out()
        self._dress()
        self._fill()
        self._connect()

    def refresh(self) -> None:
        """Show kind, device and settings of the live source."""
        live, settings = self.live, self.live.settings
        running = live.running
        self.kind.setCurrentIndex(max(self.kind.findData(settings.kind), 0))
        kind = SOURCES[settings.kind]
        self._device_label.setText(text_of(kind.device))
        self.device.show_devices(kind, settings.choice.id, settings.devices, settings.looking)
        self.device.setToolTip(text_of(kind.device_help))
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
            set_text(label, sentence)

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
            (QLabel(tr("Source")), self.kind),
            (self._device_label, self.device),
            (QLabel(tr("Exposure")), self.exposure),
            (QLabel(tr("Gain")), self.gain),
            (QLabel(tr("Rate")), self.rate),
            (QLabel(tr("Trigger")), self.trigger),
            (QLabel(tr("Format")), self.pixel_format),
            (QLabel(tr("Region")), self.region),
            (QLabel(tr("Files")), self.files),
        ):
            label.setBuddy(field)
            self._form.addRow(label, field)
        column = in_column(self._form, on=self, spacing=6)
        for label in (self.missing, self.complaint):
            label.setObjectName("muted")
            label.setWordWrap(True)
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
            column.addWidget(label)

    def _dress(self) -> None:
        for field, name, tip in (
            (self.kind, tr("Kind of source"), tr("What delivers the pictures")),
            (self.device, tr("Device"), ""),
            (self.exposure, tr("Exposure time"), tr("Shorter keeps moving things sharp; longer is brighter")),
            (self.gain, tr("Gain"), tr("Brighter pictures, but more noise")),
            (self.rate, tr("Frame rate"), tr("How many pictures a second")),
            (self.trigger, tr("Trigger"), tr("What makes the camera take a picture; Off: it runs freely")),
            (self.pixel_format, tr("Pixel format"), tr("Grey levels as the camera sends them")),
            (
                self.region,
                tr("Region of the sensor"),
                tr("First column, first row, width and height in pixels. A calibration holds for its own region."),
            ),
            (
                self.files,
                tr("Files of the frames"),
                tr("PNG takes half the room on the disk, PGM a tenth of the time: for fast cameras"),
            ),
        ):
            field.setAccessibleName(name)
            field.setToolTip(tip)

    def _fill(self) -> None:
        for kind in SOURCES.values():
            self.kind.addItem(text_of(kind.title), kind.name)
            self.kind.setItemData(self.kind.count() - 1, text_of(kind.help), Qt.ItemDataRole.ToolTipRole)
        self.files.addItem(tr("PNG, smaller"), ".png")
        self.files.addItem(tr("PGM, faster"), ".pgm")

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
