"""Basler cameras through pypylon, an optional extra."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from core.acquire.basler_driver import choose, depth, devices, full_range, let_go, pylon_module, said, writable_node
from core.acquire.source import Frame, Lasers, SourceSettings, Step, Unplugged
from core.errors import InputError

QUEUE = 4
"""Frames kept for a reader that is a little late; the driver counts those it drops."""


class BaslerSource:
    """A Basler camera behind :class:`core.acquire.source.FrameSource`.

    The camera's own settings are kept where nothing else is said, its depth among them: Mono8 gives 8-bit pictures,
    Mono10, Mono12 and Mono16 16-bit ones over the full range. Any other pixel format is changed to Mono8.

    Parameters
    ----------
    serial
        Serial number; "" is the first camera found.
    setup
        Called with the open pylon camera before anything is read from it.
    clock
        Time in s that only runs forward.
    """

    def __init__(
        self,
        serial: str = "",
        *,
        setup: Callable[[Any], None] | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.name = f"Basler {serial}".strip()
        self._serial, self._setup, self._clock = serial, setup, clock
        self._wanted = SourceSettings()
        self._camera: Any = None
        self._bits = 8
        self._index = self._dropped = 0
        self._block: int | None = None
        self._origin = 0.0

    def open(self) -> None:
        """Find the camera, open it and let it run."""
        self.close()
        pylon = pylon_module()
        device = self._find(pylon)
        camera = None
        try:
            camera = pylon.InstantCamera(pylon.TlFactory.GetInstance().CreateDevice(device))
            camera.Open()
            if self._setup is not None:
                self._setup(camera)
            self._bits = depth(camera, self.name)
            self._apply(camera, self._wanted)
            camera.OutputQueueSize.SetValue(QUEUE)
            self._index, self._dropped, self._block = 0, 0, None
            self._origin = self._clock()
            camera.StartGrabbing(pylon.GrabStrategy_LatestImages)
        except pylon.GenericException as problem:
            let_go(pylon, camera)
            todo = "see that no other program uses it, then try again"
            raise InputError(f"the camera cannot be opened ({said(problem)})", where=self.name, todo=todo) from problem
        except BaseException:
            let_go(pylon, camera)
            raise
        self._camera = camera

    def configure(self, settings: SourceSettings) -> None:
        """Set exposure, gain and rate, now or when it is opened."""
        if self._camera is not None:
            self._apply(self._camera, settings)
        self._wanted = self._wanted.updated(settings)

    def prepare(self, step: Step) -> None:
        """A camera sees what is before it."""

    def lasers(self, lasers: Lasers) -> bool:
        """A person must switch them."""
        return False

    def read(self, timeout_s: float) -> Frame | None:
        """The next frame, None if there is none within the time; Unplugged when the camera is gone."""
        if self._camera is None:
            raise self._unplugged("it is not open")
        pylon = pylon_module()
        try:
            result = self._camera.RetrieveResult(round(1000 * timeout_s), pylon.TimeoutHandling_Return)
            if not result.IsValid():
                if self._camera.IsCameraDeviceRemoved():
                    raise self._gone("it was pulled out")
                if not self._camera.IsGrabbing():
                    raise self._gone("its driver has stopped")
                return None
            return self._frame(result)
        except pylon.GenericException as problem:
            raise self._gone(said(problem)) from problem

    def close(self) -> None:
        """Stop the camera and let go of it."""
        camera, self._camera = self._camera, None
        if camera is not None:
            let_go(pylon_module(), camera)

    def _frame(self, result: Any) -> Frame | None:
        """The picture of a grab result, or None if the connection lost a part of it."""
        try:
            lost = max(int(result.GetNumberOfSkippedImages()), self._gap(int(result.GetBlockID())))
            whole = bool(result.GrabSucceeded())
            self._dropped += lost + (not whole)
            index = self._index + lost
            self._index = index + 1
            if not whole:
                return None
            return Frame(full_range(result.GetArray(), self._bits), index, self._clock() - self._origin, self._dropped)
        finally:
            result.Release()

    def _gap(self, block: int) -> int:
        """How many of the camera's own numbers are missing before `block`; 0 where it does not count."""
        last, self._block = self._block, block
        return 0 if last is None else max(0, block - last - 1)

    def _find(self, pylon: Any) -> Any:
        for device in devices(pylon):
            if self._serial in ("", device.GetSerialNumber()):
                self.name = device.GetFriendlyName()
                return device
        todo = "plug it in, and see that it shows in the pylon Viewer"
        what = f"there is no camera with the serial number {self._serial}" if self._serial else "no camera is found"
        raise InputError(what, where="Basler", todo=todo)

    def _apply(self, camera: Any, settings: SourceSettings) -> None:
        if settings.exposure_ms is not None:
            choose(camera, "ExposureAuto", "Off")
            names = ("ExposureTime", "ExposureTimeAbs")
            self._set(camera, names, 1000 * settings.exposure_ms, "exposure time", 1000, "ms")
        if settings.gain_db is not None:
            choose(camera, "GainAuto", "Off")
            self._set(camera, ("Gain",), settings.gain_db, "gain", 1, "dB")
        if settings.rate_hz:
            enable = writable_node(camera, "AcquisitionFrameRateEnable")
            if enable is not None:
                enable.SetValue(True)
            names = ("AcquisitionFrameRate", "AcquisitionFrameRateAbs")
            self._set(camera, names, settings.rate_hz, "frame rate", 1, "Hz")

    def _set(self, camera: Any, names: tuple[str, ...], value: float, what: str, scale: float, unit: str) -> None:
        """Set the first of the nodes `names` that the camera has; messages give `value` / `scale` in `unit`."""
        nodes = (writable_node(camera, name) for name in names)
        node = next((one for one in nodes if one is not None), None)
        if node is None:
            raise InputError(f"the camera does not let its {what} be set", where=self.name, todo="leave it as it is")
        low, high = node.GetMin(), node.GetMax()
        if not low <= value <= high:
            raise InputError(
                f"the {what} of {value / scale:g} {unit} is not between {low / scale:g} and {high / scale:g} {unit}",
                where=self.name,
            )
        node.SetValue(value)

    def _gone(self, why: str) -> Unplugged:
        self.close()
        return self._unplugged(why)

    def _unplugged(self, why: str) -> Unplugged:
        return Unplugged(f"the camera sends no pictures any more ({why})", where=self.name, todo="plug it in again")
