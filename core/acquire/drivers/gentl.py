"""Cameras of any maker through its GenTL producer (a .cti file), by `harvesters`, an optional extra."""

from __future__ import annotations

import contextlib
import importlib
import importlib.util
import os
import time
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
from core.extras import install
from core.messages import Message

MODULE = "harvesters"
INSTALL = Message(
    "source.install_harvesters",
    "GenICam cameras need harvesters: install it with {command}",
    command=install("genicam"),
)

PATH = "GENICAM_GENTL64_PATH"
"""Environment variable with the folders of the producers, by the GenTL standard."""

GONE_AFTER_S = 2.0
"""So long after the last frame the producer is asked whether the camera is still there, and again as often."""

_LIST_MS = 1000
"""How long in ms the producer may search for the cameras that are connected."""
_SEPARATOR = "#"


def producers() -> tuple[Path, ...]:
    """Find the GenTL producers, drivers of camera makers, that are installed on this computer."""
    folders = [Path(text) for text in os.environ.get(PATH, "").split(os.pathsep) if text]
    found = [path for folder in folders if folder.is_dir() for path in sorted(folder.glob("*.cti"))]
    return tuple(dict.fromkeys(found))


def list_cameras() -> list[tuple[str, str, str]]:
    """List identifier, name, and maker and connection of each camera that the GenTL producers find.

    Raises
    ------
    InputError
        If harvesters is not installed, or a producer fails.
    """
    if not producers():
        return []
    harvester = _harvester(producers())
    try:
        with _telling():
            return [(one.id_, _name(one), _kind_of(one)) for one in harvester.device_info_list]
    except DriverError as problem:
        raise InputError(
            Message(
                "camera.producers_fail",
                "the producers cannot look for cameras ({reason})",
                reason=str(problem),
            ),
            where="GenICam",
        ) from problem
    finally:
        harvester.reset()


def connect(identifier: str) -> GenTLDriver:
    """Open the camera of this identifier or serial number by a GenTL producer; "" opens the first one found.

    Parameters
    ----------
    identifier
        The producer's identifier of the camera, or its serial number; "" is the first camera found. A producer that
        the environment does not name stands before it: `FILE.cti` or `FILE.cti#IDENTIFIER`.

    Raises
    ------
    InputError
        If there is no producer, no such camera, or it cannot be opened.
    """
    file, camera = _parts(identifier)
    files = (file,) if file is not None else producers()
    if not files:
        todo = Message(
            "advice.install_producer",
            "install the camera maker's GenTL producer, or name its .cti file; {path} must hold its folder",
            path=PATH,
        )
        raise InputError(
            Message("camera.no_producer", "there is no GenTL producer on this computer"),
            where="GenICam",
            todo=todo,
        )
    harvester = _harvester(files, must_work=file is not None)
    try:
        with _telling():
            found = [one for one in harvester.device_info_list if camera in ("", one.id_, _serial(one))]
            if found:
                return GenTLDriver(harvester, found[0])
    except DriverError as problem:
        harvester.reset()
        todo = Message("advice.close_other_programs", "see that no other program uses it, then try again")
        raise InputError(
            Message("camera.cannot_be_opened_why", "the camera cannot be opened ({reason})", reason=str(problem)),
            where="GenICam",
            todo=todo,
        ) from problem
    except BaseException:
        harvester.reset()
        raise
    harvester.reset()
    what = (
        Message("camera.no_camera_named", "there is no camera {camera}", camera=camera)
        if camera
        else Message("camera.none_found", "no camera is found")
    )
    names = ", ".join(path.name for path in files)
    raise InputError(
        what,
        where="GenICam",
        todo=Message("advice.plug_in_asked", "plug it in; asked were {names}", names=names),
    )


class GenTLDriver:
    """Camera of a producer (:class:`core.acquire.drivers.genicam.Driver`)."""

    def __init__(self, harvester: Any, info: Any) -> None:
        self.name = _name(info)
        self._id = info.id_
        self._harvester = harvester
        self._acquirer = harvester.create({"id_": self._id})
        self._acquirer.num_buffers = BUFFERS
        self.features: Features = NodeFeatures(self._acquirer.remote_device.node_map)
        self._heard_s = time.monotonic()

    def start(self) -> None:
        with _telling():
            self._acquirer.start()
        self._heard_s = time.monotonic()

    def stop(self) -> None:
        with _telling():
            self._acquirer.stop()

    def grab(self, timeout_s: float) -> Grabbed | None:
        with _telling():
            buffer = self._acquirer.try_fetch(timeout=max(timeout_s, 1e-3))
            if buffer is None:
                return None
            self._heard_s = time.monotonic()
            try:
                return _grabbed(buffer)
            finally:
                buffer.queue()

    def gone(self) -> bool:
        if time.monotonic() - self._heard_s < GONE_AFTER_S:
            return False
        self._heard_s = time.monotonic()
        with _telling():
            interface = self._acquirer.interface.module
            interface.update_device_info_list(_LIST_MS)
            return all(info.id_ != self._id for info in interface.device_info_list)

    def close(self) -> None:
        with contextlib.suppress(DriverError), _telling():  # it may be gone already
            self._acquirer.destroy()
        with contextlib.suppress(DriverError), _telling():
            self._harvester.reset()


class NodeFeatures:
    """Nodes of a camera (:class:`core.acquire.drivers.genicam_features.Features`)."""

    def __init__(self, nodes: Any) -> None:
        self._nodes = nodes

    def has(self, name: str) -> bool:
        with _telling():
            if not self._nodes.has_node(name):
                return False
            access = importlib.import_module("genicam.genapi").EAccessMode
            return self._nodes.get_node(name).get_access_mode() in (access.RO, access.RW, access.WO)

    def number(self, name: str) -> float:
        with _telling():
            return float(self._nodes.get_node(name).value)

    def limits(self, name: str) -> tuple[float, float, float]:
        with _telling():
            node = self._nodes.get_node(name)
            whole = isinstance(node.value, int)
            return float(node.min), float(node.max), float(node.inc) if whole else 0.0

    def set_number(self, name: str, value: float) -> None:
        with _telling():
            node = self._nodes.get_node(name)
            node.value = type(node.value)(value)

    def entries(self, name: str) -> tuple[str, ...]:
        with _telling():
            return tuple(self._nodes.get_node(name).symbolics)

    def entry(self, name: str) -> str:
        with _telling():
            return str(self._nodes.get_node(name).value)

    def choose(self, name: str, entry: str) -> None:
        with _telling():
            self._nodes.get_node(name).value = entry

    def run(self, name: str) -> None:
        with _telling():
            self._nodes.get_node(name).execute()


def _harvester(files: tuple[Path, ...], *, must_work: bool = False) -> Any:
    """A harvester that knows the cameras of these producers; one that cannot be loaded is passed by unless it must."""
    try:
        made = importlib.import_module(f"{MODULE}.core").Harvester()
    except ImportError as missing:
        raise InputError(INSTALL) from missing
    try:
        for file in files:
            if not file.is_file():
                raise InputError(
                    Message("camera.no_such_producer", "there is no such GenTL producer"),
                    where=file,
                    todo=Message("advice.choose_producer_file", "choose a .cti file"),
                )
            with _telling():
                made.add_file(str(file), check_validity=must_work)
        with _telling():
            made.update()
    except DriverError as problem:
        made.reset()
        names = ", ".join(path.name for path in files)
        raise InputError(
            Message("camera.producer_unusable", "the producer cannot be used ({reason})", reason=str(problem)),
            where=names,
        ) from problem
    except BaseException:
        made.reset()
        raise
    return made


def _grabbed(buffer: Any) -> Grabbed:
    picture = buffer.payload.components[0]
    number = _known(buffer.module, "frame_id")
    nanoseconds = _known(buffer.module, "timestamp_ns")
    return Grabbed(
        data=np.array(picture.data),  # the producer uses its buffer again
        pixel_format=str(picture.data_format),
        width=int(picture.width),
        height=int(picture.height),
        number=None if number is None else int(number),
        time_s=None if nanoseconds is None else nanoseconds * 1e-9,
    )


def _known(module: Any, name: str) -> Any:
    """What a producer says of a buffer; None if it does not."""
    try:
        with _telling():
            return getattr(module, name)
    except DriverError:
        return None


def _parts(identifier: str) -> tuple[Path | None, str]:
    """The producer, if one is named, and the camera."""
    file, _, camera = identifier.partition(_SEPARATOR)
    return (Path(file), camera) if file.lower().endswith(".cti") else (None, identifier)


def _name(info: Any) -> str:
    known = info.property_dict  # asked one by one, what a producer does not know is an error
    return str(known["user_defined_name"] or known["display_name"] or known["model"])


def _serial(info: Any) -> str:
    return str(info.property_dict["serial_number"] or "")


def _kind_of(info: Any) -> str:
    known = info.property_dict
    return f"{known['vendor']} {known['model']}, {known['tl_type']}"


@contextlib.contextmanager
def _telling() -> Iterator[None]:
    """What harvesters and the producer raise, as DriverError: their first sentence."""
    try:
        yield
    except (DriverError, InputError):
        raise
    except Exception as problem:
        if not _is_drivers(problem):
            raise
        raise DriverError(_said(problem)) from problem


def _is_drivers(problem: Exception) -> bool:
    modules = {kind.__module__.lstrip("_").split(".")[0] for kind in type(problem).__mro__}
    return bool(modules & {"gentl", "genapi", "genicam", "harvesters"}) or isinstance(problem, (OSError, ValueError))


def _said(problem: Exception) -> str:
    text = str(problem).split("from the source: ")[-1].split(") (ID")[0]
    return text.strip().removesuffix(".") or type(problem).__name__


def _make(id_: str, rig: Any) -> GenICamSource:
    name = id_ or "GenICam camera"
    return GenICamSource(name.strip(), partial(connect, id_), None if rig is None else rig.live_channel)


def _list() -> tuple[SourceInfo, ...]:
    return tuple(SourceInfo(SourceChoice("genicam", id_), name, detail) for id_, name, detail in list_cameras())


KIND = SourceKind(
    "genicam",
    Message("source.genicam", "GenICam camera"),
    Message("source.genicam_help", "An industrial camera of any maker, by its GenTL producer (.cti)"),
    DEVICE,
    Message("source.genicam_device", "The producer's name of the camera; empty: the first one found"),
    FIRST_CAMERA,
    _make,
    _list,
    GENICAM_SETTINGS,
    is_missing=lambda: importlib.util.find_spec(MODULE) is None,
    install=INSTALL,
)
