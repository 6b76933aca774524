"""Which live source is used and how it is set; remembered by the program, not by the project."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

from PySide6.QtCore import QObject, Signal

from core.acquire.kept_settings import KeptSettings
from core.acquire.settings import Region
from core.acquire.source import Capabilities, SourceChoice, SourceInfo, SourceSettings, Step
from core.errors import InputError
from core.files.recording.recorder import Ending
from core.messages import Message
from core.pipeline.live.sources import SOURCES
from workbench.bench import Bench
from workbench.language import sentence, text_of, tr
from workbench.settings import AppSettings
from workbench.work import jobs

FIRST = next(iter(SOURCES))
"""The kind that is always there: the simulated rig."""
OWN = "opencv"
"""What a rig of one's own has as long as nothing else was chosen: any camera the system knows."""


def choose_simulated(settings: AppSettings) -> None:
    """Set the simulated rig as the live source, for the next project."""
    settings.keep_text("live/kind", FIRST)


def choose_own(settings: AppSettings) -> None:
    """Set a camera as the live source, for the next project: the camera chosen last, if there was one."""
    if settings.text("live/kind", FIRST) == FIRST:
        settings.keep_text("live/kind", settings.text("live/own kind", OWN))


class LiveSettings(QObject):
    """Source chosen in the whole window, and the settings of each source for each step."""

    changed = Signal()
    devices_changed = Signal()

    _step: Step

    def __init__(self, bench: Bench, step: Step, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._bench, self._step = bench, "planes" if step == "check" else step  # both show the plane target
        self._known: dict[SourceChoice, Capabilities] = {}
        self._listed: tuple[str, tuple[SourceInfo, ...]] = "", ()
        self.looking = False
        self.missing = ""
        """Why sources of this kind cannot be used on this computer, and what to install; "" as far as is known."""

        self.complaint = ""
        """What is wrong with what was entered last; it is not used."""

    @property
    def kind(self) -> str:
        """Kind of the live source, one of SOURCES."""
        kind = self._bench.settings.text("live/kind", FIRST)
        return kind if kind in SOURCES else FIRST

    @property
    def devices(self) -> tuple[SourceInfo, ...]:
        """Devices of this kind of source that the last search found."""
        kind, found = self._listed
        return found if kind == self.kind else ()

    @property
    def choice(self) -> SourceChoice:
        """Kind and device of the live source that is chosen."""
        return SourceChoice(self.kind, self._bench.settings.text(f"live/{self.kind}/id", ""))

    @property
    def values(self) -> SourceSettings:
        """Settings of the chosen source; None for each that is left as the source has it."""
        return self._kept().settings(self.choice, self._step).only(self.names)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the settings that the source has; exact once it has been open."""
        known = self._known.get(self.choice)
        return SOURCES[self.kind].settings if known is None else known.names

    @property
    def capabilities(self) -> Capabilities:
        """Limits and choices of the source's settings, as far as they are known."""
        return self._known.get(self.choice, Capabilities())

    @property
    def ending(self) -> Ending:
        """File ending of the frames of a scan, ".png" or ".pgm"."""
        return ".pgm" if self._bench.settings.text("live/ending", "") == ".pgm" else ".png"

    def set_kind(self, kind: str) -> None:
        """Choose the kind of source; the device and settings used last with it are restored."""
        if kind != self.kind:
            self._bench.settings.keep_text("live/kind", kind)
            if kind != FIRST:
                self._bench.settings.keep_text("live/own kind", kind)
            self.looking, self.missing, self.complaint = False, "", ""
            self.devices_changed.emit()
            self.changed.emit()

    def set_id(self, identifier: str) -> None:
        """Choose the device by its number, name, address, serial number or folder."""
        if identifier != self.choice.id:
            self._bench.settings.keep_text(f"live/{self.kind}/id", identifier)
            self.changed.emit()

    def set_value(self, name: str, value: Any) -> None:
        """Set one field of SourceSettings; None leaves it to the source. A complaint says if it is impossible."""
        try:
            self._keep(replace(self.values, **{name: value}))
        except InputError as error:
            self._complain(text_of(error))

    def set_region(self, text: str) -> None:
        """Set the part of the sensor from text with four whole numbers; "" leaves it to the source."""
        numbers = [int(number) for number in re.findall(r"\d+", text)]
        if text.strip() and len(numbers) != 4:
            self._complain(tr("A region is four whole numbers: first column, first row, width and height."))
            return
        try:
            self._keep(replace(self.values, region=Region(*numbers) if numbers else None))
        except InputError as error:
            self._complain(text_of(error))

    def take(self, settings: SourceSettings) -> None:
        """Change those settings that are not None in `settings`."""
        self._keep(self.values.updated(settings))

    def set_ending(self, ending: Ending) -> None:
        """Choose the file ending of the frames of a scan."""
        if ending != self.ending:
            self._bench.settings.keep_text("live/ending", ending)
            self.changed.emit()

    def opened(self, choice: SourceChoice, capabilities: Capabilities) -> None:
        """Store what the source `choice` can do, as it has been opened."""
        self._known[choice] = capabilities

    def look_for_devices(self) -> None:
        """Search the devices of this kind in the background; `devices_changed` tells when it is done."""
        kind, self.looking = self.kind, True

        def found(devices: Any, missing: Message | None = None) -> None:
            if kind == self.kind:
                self._listed, self.looking = (kind, tuple(devices)), False
                self.missing = "" if missing is None else sentence(text_of(missing))
                self.devices_changed.emit()

        def listed(devices: Any) -> None:
            if devices or kind == FIRST:
                found(devices)
                return
            self._look(jobs.MISSING_DRIVER, kind, lambda missing: found((), missing), lambda: found(()))

        self._look(jobs.LIST_SOURCES, kind, listed, lambda: found(()))
        self.devices_changed.emit()

    def _look(self, job: jobs.Job, kind: str, done: Any, failed: Any) -> None:
        self._bench.run_quick(
            self,
            job,
            kind,
            label=tr("Looking for cameras"),
            on_done=done,
            on_failed=lambda _: failed(),
            on_cancelled=failed,
            offers={},
            replace_waiting=True,
        )

    def _kept(self) -> KeptSettings:
        return KeptSettings.from_text(self._bench.settings.text("live/kept", ""))

    def _keep(self, settings: SourceSettings) -> None:
        was, self.complaint = self.complaint, ""
        if settings != self.values:
            kept = self._kept().with_settings(self.choice, self._step, settings)
            self._bench.settings.keep_text("live/kept", kept.to_text())
        elif not was:
            return
        self.changed.emit()

    def _complain(self, sentence: str) -> None:
        self.complaint = sentence
        self.changed.emit()
