"""Which live source is used and how it is set; remembered by the program, not by the project."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QObject, Signal

from core.acquire.source import SourceChoice, SourceInfo, SourceSettings, Step
from core.errors import InputError
from workbench import jobs
from workbench.bench import Bench

KINDS = ("simulated", "opencv", "basler", "replay")
"""The kinds of sources, in the order of the list; the first is the one that is always there."""

SETTINGS: dict[str, tuple[str, ...]] = {
    "simulated": ("rate_hz",),
    "opencv": ("exposure_ms", "gain_db", "rate_hz"),
    "basler": ("exposure_ms", "gain_db", "rate_hz"),
    "replay": ("rate_hz",),
}
"""What a source of each kind can be told."""


class LiveSettings(QObject):
    """The source chosen in the whole window; exposure, gain and rate are each step's and each kind's own."""

    changed = Signal()
    devices_changed = Signal()

    def __init__(self, bench: Bench, step: Step, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._bench, self._step = bench, step
        self.devices: tuple[SourceInfo, ...] = ()
        self.looking = False

    @property
    def kind(self) -> str:
        """One of KINDS."""
        kind = self._bench.settings.text("live/kind", KINDS[0])
        return kind if kind in KINDS else KINDS[0]

    @property
    def choice(self) -> SourceChoice:
        """The source."""
        return SourceChoice(self.kind, self._bench.settings.text(f"live/{self.kind}/id", ""))

    @property
    def values(self) -> SourceSettings:
        """What the source is told; None leaves it as it is."""
        told: dict[str, Any] = {name: self._number(name) for name in SETTINGS[self.kind]}
        try:
            return SourceSettings(**told)
        except InputError:
            return SourceSettings()  # a settings file from elsewhere

    def can(self, name: str) -> bool:
        """Whether sources of this kind can be told exposure_ms, gain_db or rate_hz."""
        return name in SETTINGS[self.kind]

    def set_kind(self, kind: str) -> None:
        """Choose the kind of source; its last device and settings come back."""
        if kind != self.kind:
            self._bench.settings.keep_text("live/kind", kind)
            self.devices, self.looking = (), False
            self.devices_changed.emit()
            self.changed.emit()

    def set_id(self, identifier: str) -> None:
        """Choose the device: its number, address, serial number or folder."""
        if identifier != self.choice.id:
            self._bench.settings.keep_text(f"live/{self.kind}/id", identifier)
            self.changed.emit()

    def set_value(self, name: str, value: float | None) -> None:
        """Set exposure_ms, gain_db or rate_hz; None leaves it to the source."""
        if value != self._number(name):
            self._bench.settings.keep_text(self._key(name), "" if value is None else repr(value))
            self.changed.emit()

    def look_for_devices(self) -> None:
        """List the devices of this kind; `devices_changed` when it is done."""
        kind, self.looking = self.kind, True

        def found(devices: Any) -> None:
            if kind == self.kind:
                self.devices, self.looking = tuple(devices), False
                self.devices_changed.emit()

        def failed(_: Any) -> None:
            found(())

        self._bench.glance(
            jobs.LIST_SOURCES,
            kind,
            label=self.tr("Looking for cameras"),
            on_done=found,
            on_failed=failed,
            on_cancelled=lambda: failed(None),
            offers={},
            replace_waiting=True,
        )
        self.devices_changed.emit()

    def _number(self, name: str) -> float | None:
        try:
            return float(self._bench.settings.text(self._key(name), ""))
        except ValueError:
            return None

    def _key(self, name: str) -> str:
        return f"live/{self.kind}/{self._step}/{name}"
