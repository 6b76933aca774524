"""Fields of the live controls: a device from a list or typed in, and settings that may be left as they are."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QComboBox, QDoubleSpinBox, QHBoxLayout, QLineEdit, QToolButton, QWidget

from core.acquire.source import Region, SourceInfo
from workbench.theme import icon
from workbench.views import ask


class DeviceField(QWidget):
    """A device of the list, or any other typed in; for a replay a folder."""

    chosen = Signal(str)
    look = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._kind = ""
        self.box, self.button = QComboBox(), QToolButton()
        self.box.setEditable(True)
        self.box.setInsertPolicy(QComboBox.InsertPolicy.NoInsert)
        self.box.setMinimumContentsLength(8)
        self.box.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.setFocusProxy(self.box)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(4)
        row.addWidget(self.box, 1)
        row.addWidget(self.button)
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

    def show_devices(self, kind: str, chosen: str, devices: Sequence[SourceInfo], looking: bool) -> None:
        """Show the devices there are, and the one that is chosen."""
        self._kind = kind
        self.box.blockSignals(True)
        self.box.clear()
        names = [device.name for device in devices]
        for place, device in enumerate(devices):
            alike = device.detail and names.count(device.name) > 1
            self.box.addItem(f"{device.name} – {device.detail}" if alike else device.name, device.choice.id)
            self.box.setItemData(place, device.detail, Qt.ItemDataRole.ToolTipRole)
        place = self.box.findData(chosen)
        if place >= 0:
            self.box.setCurrentIndex(place)
        else:
            self.box.setCurrentIndex(-1)
            self.box.setEditText(chosen)
        edit = self.box.lineEdit()
        assert edit is not None
        edit.setPlaceholderText(
            {
                "simulated": self.tr("the sample's rig"),
                "opencv": self.tr("0, the first camera"),
                "basler": self.tr("the first camera"),
                "genicam": self.tr("the first camera"),
                "aravis": self.tr("the first camera"),
                "replay": self.tr("choose a folder"),
            }.get(kind, "")
        )
        edit.setCursorPosition(0)
        self.box.blockSignals(False)
        browse = kind == "replay"
        self.button.setIcon(icon("mdi6.folder-open-outline" if browse else "mdi6.magnify"))
        self.button.setEnabled(not looking)
        self.button.setToolTip(
            self.tr("Choose the folder to replay")
            if browse
            else self.tr("Looking …")
            if looking
            else self.tr("Look for cameras of this kind")
        )
        self.button.setAccessibleName(self.button.toolTip())

    def _typed(self) -> None:
        text = self.box.currentText().strip()
        if self.box.currentIndex() < 0 or text != self.box.itemText(self.box.currentIndex()):
            self.chosen.emit(text)

    def _pressed(self) -> None:
        if self._kind != "replay":
            self.look.emit()
            return
        start = Path(self.box.currentText()) if self.box.currentText() else Path.home()
        folder = ask.choose_folder(self, self.tr("Folder to replay"), start)
        if folder is not None:
            self.chosen.emit(str(folder))


class NumberField(QDoubleSpinBox):
    """A number with its unit; its lowest step is "as it is", which is None."""

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
        """Keep to what the camera can do; None: to what any camera can."""
        low, high = limits or self._usual
        self.blockSignals(True)
        self._nothing = low - 10 ** -self.decimals()
        self.setRange(self._nothing, high)
        self.blockSignals(False)

    def show_value(self, value: float | None) -> None:
        """Show a number, or that there is none."""
        self.blockSignals(True)
        self.setValue(self._nothing if value is None else value)
        self.blockSignals(False)


class ChoiceField(QComboBox):
    """One of several words; the first entry is "as it is", which is None."""

    edited = Signal(object)

    def __init__(self, none_text: str) -> None:
        super().__init__()
        self._none_text = none_text
        self.addItem(none_text, None)
        self.activated.connect(lambda _: self.edited.emit(self.currentData()))

    def show_choices(self, choices: Sequence[str], chosen: str | None) -> None:
        """Offer these; one that is chosen already is offered, too."""
        wanted = [None, *choices, *([chosen] if chosen and chosen not in choices else [])]
        if wanted != [self.itemData(place) for place in range(self.count())]:
            self.clear()
            for word in wanted:
                self.addItem(word or self._none_text, word)
        self.setCurrentIndex(max(self.findData(chosen), 0))


class RegionField(QLineEdit):
    """A part of the sensor as four whole numbers; empty is "as it is"."""

    edited = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self._shown = ""
        self.editingFinished.connect(self._finished)

    def show_region(self, region: Region | None, sensor: tuple[int, int] | None) -> None:
        """Show a region, or that there is none; `sensor` is (width, height), as far as it is known."""
        shown = "" if region is None else f"{region.left} {region.top} {region.width} {region.height}"
        whole = self.tr("as it is")
        self.setPlaceholderText(whole if sensor is None else f"{whole} (0 0 {sensor[0]} {sensor[1]})")
        if shown != self._shown:
            self._shown = shown
            self.setText(shown)

    def _finished(self) -> None:
        if self.text() != self._shown:
            self.edited.emit(self.text())
