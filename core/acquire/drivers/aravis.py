"""GigE Vision and USB3 Vision cameras through Aravis, which the system's packages bring."""

from __future__ import annotations

import contextlib
import importlib
import importlib.util
import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from core.acquire.drivers.genicam import BUFFERS, DriverError, GenICamSource, Grabbed
from core.acquire.drivers.genicam_features import Features
from core.acquire.source import SourceChoice, SourceInfo
from core.acquire.source_kind import DEVICE, FIRST_CAMERA, GENICAM_SETTINGS, SourceKind
from core.errors import InputError
from core.messages import Message

VERSION = "0.8"
INSTALL = Message(
    "source.install_aravis",
    "Aravis is not installed: on Debian and Ubuntu, apt install gir1.2-aravis-0.8 python3-gi, "
    "and run Trisect with the system's own version of Python",
)

SYSTEM_PACKAGES = Path("/usr/lib/python3/dist-packages")
"""Where the system's packages put Python's link to Aravis; it can be loaded by a Python of the same version only."""


def is_missing() -> bool:
    """Whether Aravis is not installed in a usable version; found without loading any of it."""
    try:
        _introspection()
    except (ImportError, ValueError):
        return True
    return False


def aravis() -> Any:
    """Import and return the module Aravis; InputError if it is missing.

    Raises
    ------
    InputError
        If it is not installed, or not for this version of Python.
    """
    try:
        _introspection()
        return importlib.import_module("gi.repository.Aravis")
    except (ImportError, ValueError) as missing:
        raise InputError(INSTALL) from missing


def list_cameras() -> list[tuple[str, str, str]]:
    """List identifier, name and kind of connection of each camera that Aravis finds; InputError without it."""
    module = aravis()
    module.update_device_list()
    return [
        (
            module.get_device_id(number),
            f"{module.get_device_vendor(number)} {module.get_device_model(number)}",
            f"{module.get_device_protocol(number)} {module.get_device_address(number)}",
        )
        for number in range(module.get_n_devices())
    ]


def connect(identifier: str) -> AravisDriver:
    """Open the camera Aravis calls `identifier`, or that has this network address; "" is the first one found.

    Raises
    ------
    InputError
        If Aravis is missing, or there is no such camera, or it cannot be opened.
    """
    module = aravis()
    if not identifier and not list_cameras():
        raise InputError(
            Message("camera.none_found", "no camera is found"),
            where="Aravis",
            todo=Message("advice.plug_in_with_address", "plug it in, and see that it has a network address"),
        )
    try:
        with _telling():
            return AravisDriver(module, module.Camera.new(identifier or None))
    except DriverError as problem:
        todo = Message(
            "advice.check_plug_then_try_again", "see that it is plugged in and no other program uses it, then try again"
        )
        raise InputError(
            Message(
                "camera.one_cannot_be_opened",
                "the camera {id} cannot be opened ({reason})",
                id=identifier,
                reason=str(problem),
            )
            if identifier
            else Message("camera.cannot_be_opened_why", "the camera cannot be opened ({reason})", reason=str(problem)),
            where="Aravis",
            todo=todo,
        ) from problem


class AravisDriver:
    """Camera of Aravis (:class:`core.acquire.drivers.genicam.Driver`)."""

    def __init__(self, module: Any, camera: Any) -> None:
        self._module, self._camera = module, camera
        self._device = camera.get_device()
        self.name = f"{camera.get_vendor_name()} {camera.get_model_name()}"
        self.features: Features = DeviceFeatures(module, self._device)
        self._stream: Any = None
        self._format = ""
        self._lost = False
        self._device.connect("control-lost", self._lose)

    def start(self) -> None:
        with _telling():
            self._camera.set_acquisition_mode(self._module.AcquisitionMode.CONTINUOUS)
            self._format = self.features.entry("PixelFormat")
            self._stream = self._camera.create_stream(None, None)
            payload = self._camera.get_payload()
            for _ in range(BUFFERS):
                self._stream.push_buffer(self._module.Buffer.new_allocate(payload))
            self._camera.start_acquisition()

    def stop(self) -> None:
        with _telling():
            self._camera.stop_acquisition()
        self._stream = None

    def grab(self, timeout_s: float) -> Grabbed | None:
        with _telling():
            buffer = self._stream.timeout_pop_buffer(max(round(timeout_s * 1e6), 1))
            if buffer is None:
                return None
            try:
                return self._grabbed(buffer)
            finally:
                self._stream.push_buffer(buffer)

    def gone(self) -> bool:
        return self._lost

    def close(self) -> None:
        self._stream = None
        with contextlib.suppress(DriverError), _telling():
            if not self._lost:
                self._camera.stop_acquisition()
        self._camera = self._device = self.features = None  # type: ignore[assignment]  # Aravis lets go of it then

    def _grabbed(self, buffer: Any) -> Grabbed:
        number = buffer.get_frame_id()
        if buffer.get_status() != self._module.BufferStatus.SUCCESS:
            return Grabbed(None, number=number)
        return Grabbed(
            data=np.frombuffer(buffer.get_data(), np.uint8),
            pixel_format=self._format,
            width=buffer.get_image_width(),
            height=buffer.get_image_height(),
            number=number,
            time_s=buffer.get_timestamp() * 1e-9 or None,
        )

    def _lose(self, device: Any) -> None:
        self._lost = True


class DeviceFeatures:
    """Features of a device (:class:`core.acquire.drivers.genicam_features.Features`)."""

    def __init__(self, module: Any, device: Any) -> None:
        self._module, self._device = module, device

    def has(self, name: str) -> bool:
        with _telling():
            return bool(self._device.is_feature_available(name))

    def number(self, name: str) -> float:
        with _telling():
            whole = self._is_whole(name)
            read = self._device.get_integer_feature_value if whole else self._device.get_float_feature_value
            return float(read(name))

    def limits(self, name: str) -> tuple[float, float, float]:
        with _telling():
            if self._is_whole(name):
                bounds = self._device.get_integer_feature_bounds(name)
                return bounds[0], bounds[1], self._device.get_integer_feature_increment(name)
            bounds = self._device.get_float_feature_bounds(name)
            return bounds[0], bounds[1], 0.0

    def set_number(self, name: str, value: float) -> None:
        with _telling():
            if isinstance(self._device.get_feature(name), self._module.GcBoolean):
                self._device.set_boolean_feature_value(name, bool(value))
            elif self._is_whole(name):
                self._device.set_integer_feature_value(name, round(value))
            else:
                self._device.set_float_feature_value(name, value)

    def entries(self, name: str) -> tuple[str, ...]:
        with _telling():
            return tuple(self._device.dup_available_enumeration_feature_values_as_strings(name))

    def entry(self, name: str) -> str:
        with _telling():
            return str(self._device.get_string_feature_value(name))

    def choose(self, name: str, entry: str) -> None:
        with _telling():
            self._device.set_string_feature_value(name, entry)

    def run(self, name: str) -> None:
        with _telling():
            self._device.execute_command(name)

    def _is_whole(self, name: str) -> bool:
        return isinstance(self._device.get_feature(name), self._module.GcInteger)


def _introspection() -> None:
    """Load Python's link to the system's libraries for the Aravis we want; ImportError or ValueError if one is missing.

    It may be installed beside us; else the system's is taken, if it is for this version of Python.
    """
    if importlib.util.find_spec("gi") is None and _is_for_us(SYSTEM_PACKAGES):
        sys.path.append(str(SYSTEM_PACKAGES))
        try:
            gi = importlib.import_module("gi")
        finally:
            sys.path.remove(str(SYSTEM_PACKAGES))
    else:
        gi = importlib.import_module("gi")
    gi.require_version("Aravis", VERSION)


def _is_for_us(packages: Path) -> bool:
    version = f"cpython-{sys.version_info.major}{sys.version_info.minor}"
    return any(packages.glob(f"gi/_gi.{version}*"))


@contextlib.contextmanager
def _telling() -> Iterator[None]:
    """What Aravis raises, as DriverError."""
    try:
        yield
    except Exception as problem:
        if type(problem).__module__.split(".")[0] != "gi":
            raise
        raise DriverError(getattr(problem, "message", str(problem)).strip().removesuffix(".")) from problem


def _make(id_: str, rig: Any) -> GenICamSource:
    name = id_ or "Aravis camera"
    return GenICamSource(name.strip(), partial(connect, id_), None if rig is None else rig.live_channel)


def _list() -> tuple[SourceInfo, ...]:
    return tuple(SourceInfo(SourceChoice("aravis", id_), name, detail) for id_, name, detail in list_cameras())


KIND = SourceKind(
    "aravis",
    Message("source.aravis", "GigE or USB3 camera"),
    Message("source.aravis_help", "An industrial camera of any maker, by Aravis"),
    DEVICE,
    Message("source.aravis_device", "Name or network address of the camera; empty: the first one found"),
    FIRST_CAMERA,
    _make,
    _list,
    GENICAM_SETTINGS,
    is_missing=is_missing,
    install=INSTALL,
)
