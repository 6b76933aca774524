"""Basler cameras through pypylon, an optional extra."""

from __future__ import annotations

import contextlib
import importlib
import importlib.util
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

from core.acquire.drivers.genicam import BUFFERS, DriverError, GenICamSource, Grabbed
from core.acquire.drivers.genicam_features import TRIGGER, Features
from core.acquire.source import SourceChoice, SourceInfo
from core.acquire.source_kind import DEVICE, FIRST_CAMERA, GENICAM_SETTINGS, SourceKind
from core.errors import InputError
from core.extras import install
from core.messages import Message

MODULE = "pypylon"
INSTALL = Message(
    "source.install_pypylon",
    "Basler cameras need pypylon: install it with {command}",
    command=install("basler"),
)

READY_MS = 200
"""How long in ms a trigger waits until the camera can take it; then it is sent all the same."""

TICKS = "GevTimestampTickFrequency"
"""Ticks per second of an older camera's clock; newer ones count nanoseconds."""


def list_cameras() -> list[tuple[str, str, str]]:
    """List serial number, name and kind of connection of each Basler camera that is plugged in; [] if there is none.

    Raises
    ------
    InputError
        If pypylon is not installed, or its drivers cannot look.
    """
    pylon = pylon_module()
    return [(one.GetSerialNumber(), one.GetFriendlyName(), one.GetDeviceClass()) for one in _devices(pylon)]


def connect(serial: str, setup: Callable[[Any], None] | None = None) -> PylonDriver:
    """Open the Basler camera with the serial number `serial`; "" opens the first one found.

    Parameters
    ----------
    serial
        Serial number.
    setup
        Called with the open pylon camera before anything is read from it.

    Raises
    ------
    InputError
        If pypylon is not installed, there is no such camera, or it cannot be opened.
    """
    pylon = pylon_module()
    found = [one for one in _devices(pylon) if serial in ("", one.GetSerialNumber())]
    if not found:
        todo = Message("advice.plug_in_pylon", "plug it in, and see that it shows in the pylon Viewer")
        what = (
            Message("camera.none_with_serial", "there is no camera with the serial number {serial}", serial=serial)
            if serial
            else Message("camera.none_found", "no camera is found")
        )
        raise InputError(what, where="Basler", todo=todo)
    name = found[0].GetFriendlyName()
    camera = None
    try:
        with _telling():
            camera = pylon.InstantCamera(pylon.TlFactory.GetInstance().CreateDevice(found[0]))
            camera.Open()
            if setup is not None:
                setup(camera)
            return PylonDriver(pylon, camera, name)
    except BaseException as problem:
        _let_go(camera)
        if not isinstance(problem, DriverError):
            raise
        todo = Message("advice.close_other_programs", "see that no other program uses it, then try again")
        raise InputError(
            Message("camera.cannot_be_opened_why", "the camera cannot be opened ({reason})", reason=str(problem)),
            where=name,
            todo=todo,
        ) from problem


def pylon_module() -> Any:
    """Import and return the module pypylon; InputError says what to install if it is missing."""
    try:
        return importlib.import_module(f"{MODULE}.pylon")
    except ImportError as missing:
        raise InputError(INSTALL) from missing


class PylonDriver:
    """Open Basler camera (:class:`core.acquire.drivers.genicam.Driver`)."""

    def __init__(self, pylon: Any, camera: Any, name: str) -> None:
        self.name, self.camera = name, camera
        self.features: Features = PylonFeatures(camera)
        self._pylon = pylon
        self._format = ""
        self._number = -1
        self._ticks_hz = 1e9

    def start(self) -> None:
        with _telling():
            self._format, self._number = self.features.entry("PixelFormat"), -1
            self._ticks_hz = self.features.number(TICKS) if self.features.has(TICKS) else 1e9
            self.camera.OutputQueueSize.SetValue(BUFFERS)
            self.camera.StartGrabbing(self._pylon.GrabStrategy_LatestImages)

    def stop(self) -> None:
        with _telling():
            self.camera.StopGrabbing()

    def grab(self, timeout_s: float) -> Grabbed | None:
        with _telling():
            result = self.camera.RetrieveResult(round(1000 * timeout_s), self._pylon.TimeoutHandling_Return)
            return self._grabbed(result) if result.IsValid() else None

    def gone(self) -> bool:
        with _telling():
            return self.camera.IsCameraDeviceRemoved() or not self.camera.IsGrabbing()

    def close(self) -> None:
        _let_go(self.camera)

    def _grabbed(self, result: Any) -> Grabbed:
        """What a grab result holds; a camera that does not number its frames is counted for by its driver."""
        try:
            self._number = max(int(result.GetBlockID()), self._number + 1 + int(result.GetNumberOfSkippedImages()))
            if not result.GrabSucceeded():
                return Grabbed(None, number=self._number)
            picture = result.GetArray()
            height, width = picture.shape[:2]
            ticks = int(result.GetTimeStamp())  # 0 of the emulator, which has no clock
            time_s = ticks / self._ticks_hz if ticks else None
            return Grabbed(picture.ravel(), self._format, width, height, self._number, time_s)
        finally:
            result.Release()


class PylonFeatures:
    """Nodes of a camera (:class:`core.acquire.drivers.genicam_features.Features`)."""

    def __init__(self, camera: Any) -> None:
        self._camera = camera

    def has(self, name: str) -> bool:
        with _telling():
            try:
                node = self._node(name)
            except _genicam().LogicalErrorException:
                return False
            return node is not None and bool(_genicam().IsAvailable(node))

    def number(self, name: str) -> float:
        with _telling():
            return float(self._node(name).GetValue())

    def limits(self, name: str) -> tuple[float, float, float]:
        with _telling():
            node = self._node(name)
            whole = isinstance(node.GetValue(), int)
            return float(node.GetMin()), float(node.GetMax()), float(node.GetInc()) if whole else 0.0

    def set_number(self, name: str, value: float) -> None:
        with _telling():
            node = self._node(name)
            node.SetValue(type(node.GetValue())(value))

    def entries(self, name: str) -> tuple[str, ...]:
        with _telling():
            return tuple(self._node(name).GetSymbolics())

    def entry(self, name: str) -> str:
        with _telling():
            return str(self._node(name).GetValue())

    def choose(self, name: str, entry: str) -> None:
        with _telling():
            self._node(name).SetValue(entry)

    def run(self, name: str) -> None:
        with _telling():
            if name == TRIGGER and self._camera.CanWaitForFrameTriggerReady():
                pylon = pylon_module()  # a trigger that comes too early is lost
                self._camera.WaitForFrameTriggerReady(READY_MS, pylon.TimeoutHandling_Return)
            self._node(name).Execute()

    def _node(self, name: str) -> Any:
        return self._camera.GetNodeMap().GetNode(name)


def _genicam() -> Any:
    return importlib.import_module(f"{MODULE}.genicam")


def _devices(pylon: Any) -> list[Any]:
    """What the driver knows of each camera that is plugged in."""
    try:
        with _telling():
            return list(pylon.TlFactory.GetInstance().EnumerateDevices())
    except DriverError as problem:
        raise InputError(
            Message(
                "camera.drivers_fail",
                "the drivers cannot look for cameras ({reason})",
                reason=str(problem),
            ),
            where="Basler",
        ) from problem


def _let_go(camera: Any) -> None:
    """Stop and close a camera, also one that is gone; None is none."""
    if camera is None:
        return
    try:
        with _telling():
            camera.StopGrabbing()
            camera.Close()
    except DriverError:
        camera.DetachDevice()  # it is gone already


@contextlib.contextmanager
def _telling() -> Iterator[None]:
    """What pylon raises, as DriverError: its first sentence, without where in its source it was said."""
    try:
        yield
    except DriverError:
        raise
    except _genicam().GenericException as problem:
        raise DriverError(str(problem).split(" : ")[0].strip().removesuffix(".")) from problem


def _make(id_: str, rig: Any) -> GenICamSource:
    name = f"Basler {id_}"
    return GenICamSource(name.strip(), partial(connect, id_), None if rig is None else rig.live_channel)


def _list() -> tuple[SourceInfo, ...]:
    return tuple(SourceInfo(SourceChoice("basler", id_), name, detail) for id_, name, detail in list_cameras())


KIND = SourceKind(
    "basler",
    Message("source.basler", "Basler camera"),
    Message("source.basler_help", "An industrial camera of Basler; needs pypylon"),
    DEVICE,
    Message("source.basler_device", "Serial number of the camera; empty: the first one found"),
    FIRST_CAMERA,
    _make,
    _list,
    GENICAM_SETTINGS,
    is_missing=lambda: importlib.util.find_spec(MODULE) is None,
    install=INSTALL,
)
