"""Basler cameras through pypylon, an optional extra."""

from __future__ import annotations

import importlib
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.acquire.source import Frame, Lasers, Picture, SourceSettings, Step, Unplugged
from core.errors import InputError

MODULE = "pypylon"
INSTALL = "Basler cameras need pypylon: install it with pip install 'trisect[basler]'."

QUEUE = 4
"""Frames kept for a reader that is a little late; the driver counts those it drops."""

_BITS = {"Mono8": 8, "Mono10": 10, "Mono12": 12, "Mono16": 16}


def list_cameras() -> list[tuple[str, str, str]]:
    """Serial number, name and kind of connection of each Basler camera that is plugged in.

    Raises
    ------
    InputError
        If pypylon is not installed, or its drivers cannot look.
    """
    pylon = _pylon()
    return [(one.GetSerialNumber(), one.GetFriendlyName(), one.GetDeviceClass()) for one in _devices(pylon)]


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
        pylon = _pylon()
        device = self._find(pylon)
        camera = None
        try:
            camera = pylon.InstantCamera(pylon.TlFactory.GetInstance().CreateDevice(device))
            camera.Open()
            if self._setup is not None:
                self._setup(camera)
            self._bits = _depth(camera, self.name)
            self._apply(camera, self._wanted)
            camera.OutputQueueSize.SetValue(QUEUE)
            self._index, self._dropped, self._block = 0, 0, None
            self._origin = self._clock()
            camera.StartGrabbing(pylon.GrabStrategy_LatestImages)
        except pylon.GenericException as problem:
            _let_go(pylon, camera)
            todo = "see that no other program uses it, then try again"
            raise InputError(f"the camera cannot be opened ({_said(problem)})", where=self.name, todo=todo) from problem
        except BaseException:
            _let_go(pylon, camera)
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
        pylon = _pylon()
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
            raise self._gone(_said(problem)) from problem

    def close(self) -> None:
        """Stop the camera and let go of it."""
        camera, self._camera = self._camera, None
        if camera is not None:
            _let_go(_pylon(), camera)

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
            return Frame(_full_range(result.GetArray(), self._bits), index, self._clock() - self._origin, self._dropped)
        finally:
            result.Release()

    def _gap(self, block: int) -> int:
        """How many of the camera's own numbers are missing before `block`; 0 where it does not count."""
        last, self._block = self._block, block
        return 0 if last is None else max(0, block - last - 1)

    def _find(self, pylon: Any) -> Any:
        devices = _devices(pylon)
        for device in devices:
            if self._serial in ("", device.GetSerialNumber()):
                self.name = device.GetFriendlyName()
                return device
        todo = "plug it in, and see that it shows in the pylon Viewer"
        what = f"there is no camera with the serial number {self._serial}" if self._serial else "no camera is found"
        raise InputError(what, where="Basler", todo=todo)

    def _apply(self, camera: Any, settings: SourceSettings) -> None:
        if settings.exposure_ms is not None:
            _choose(camera, "ExposureAuto", "Off")
            names = ("ExposureTime", "ExposureTimeAbs")
            self._set(camera, names, 1000 * settings.exposure_ms, "exposure time", 1000, "ms")
        if settings.gain_db is not None:
            _choose(camera, "GainAuto", "Off")
            self._set(camera, ("Gain",), settings.gain_db, "gain", 1, "dB")
        if settings.rate_hz:
            enable = _node(camera, "AcquisitionFrameRateEnable")
            if enable is not None:
                enable.SetValue(True)
            names = ("AcquisitionFrameRate", "AcquisitionFrameRateAbs")
            self._set(camera, names, settings.rate_hz, "frame rate", 1, "Hz")

    def _set(self, camera: Any, names: tuple[str, ...], value: float, what: str, scale: float, unit: str) -> None:
        """Set the first of the nodes `names` that the camera has; messages give `value` / `scale` in `unit`."""
        nodes = (_node(camera, name) for name in names)
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


def _pylon() -> Any:
    try:
        return importlib.import_module(f"{MODULE}.pylon")
    except ImportError as missing:
        raise InputError(INSTALL.removesuffix(".")) from missing


def _devices(pylon: Any) -> list[Any]:
    try:
        return list(pylon.TlFactory.GetInstance().EnumerateDevices())
    except pylon.GenericException as problem:
        raise InputError(f"the drivers cannot look for cameras ({_said(problem)})", where="Basler") from problem


def _node(camera: Any, name: str) -> Any:
    """A camera's node that can be written to, or None."""
    genicam = importlib.import_module(f"{MODULE}.genicam")
    try:
        node = camera.GetNodeMap().GetNode(name)
        return node if node is not None and genicam.IsWritable(node) else None
    except genicam.GenericException:
        return None


def _choose(camera: Any, name: str, value: str) -> None:
    """Set an enumeration, where the camera has it and this entry of it."""
    node = _node(camera, name)
    if node is not None and value in node.GetSymbolics():
        node.SetValue(value)


def _depth(camera: Any, name: str) -> int:
    """Bits of the camera's grey levels; its pixel format is made grey first."""
    node = camera.GetNodeMap().GetNode("PixelFormat")
    if node.GetValue() not in _BITS:
        _choose(camera, "PixelFormat", "Mono8")
    if node.GetValue() not in _BITS:
        raise InputError(f"the camera gives {node.GetValue()} and no grey levels", where=name, todo="set it to Mono8")
    return _BITS[node.GetValue()]


def _full_range(grey: NDArray[Any], bits: int) -> Picture:
    """Grey levels as they came with 8 or 16 bit; 10 and 12 bit spread over 16, white to white."""
    if bits in (8, 16):
        return np.array(grey)
    wide = grey.astype(np.uint16)
    spread: Picture = (wide << np.uint16(16 - bits)) | (wide >> np.uint16(2 * bits - 16))
    return spread


def _let_go(pylon: Any, camera: Any) -> None:
    if camera is None:
        return
    try:
        camera.StopGrabbing()
        camera.Close()
    except pylon.GenericException:
        camera.DetachDevice()  # it is gone already


def _said(problem: Exception) -> str:
    """The first sentence of what a driver says, without where in its source it was said."""
    return str(problem).split(" : ")[0].strip().removesuffix(".")
