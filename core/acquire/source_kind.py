"""What registers a kind of live source: one descriptor, which the window, the settings and the sessions read."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from core.acquire.source import FrameSource, SourceInfo
from core.messages import Message

CAMERA_SETTINGS = ("exposure_ms", "gain_db", "rate_hz")
"""What any camera may be told."""
GENICAM_SETTINGS = (*CAMERA_SETTINGS, "trigger", "pixel_format", "region")
"""What a GenICam camera may be told."""

DEVICE = Message("source.device", "Device")
FIRST_CAMERA = Message("source.first_camera", "the first camera")


@dataclass(frozen=True, eq=False, slots=True)
class SourceKind:
    """Kind of live source.

    Parameters
    ----------
    name
        Its name in settings and in `SourceChoice.kind`.
    title, help
        What a list shows, and one line on what it is.
    device, device_help, usual
        What its `id` is called, what it may be, and which one is meant where there is none.
    make
        Makes a source of an id and the project's rig (:class:`core.files.recording.rig.Rig`), or None.
    list
        The sources that can be found without asking.
    settings
        Names of :class:`core.acquire.source.SourceSettings` that sources of this kind may have; which of them one
        really has it says when it is open.
    is_folder
        Whether the `id` is a folder.
    is_missing
        Whether its driver is not installed.
    install
        What to install then.
    """

    name: str
    title: Message
    help: Message
    device: Message
    device_help: Message
    usual: Message
    make: Callable[[str, Any], FrameSource]
    list: Callable[[], tuple[SourceInfo, ...]] = tuple
    settings: tuple[str, ...] = CAMERA_SETTINGS
    is_folder: bool = False
    is_missing: Callable[[], bool] = bool
    install: Message | None = None

    @property
    def missing(self) -> Message | None:
        """Reason why this kind cannot be used on this computer, and what to install; None if it can."""
        return self.install if self.is_missing() else None
