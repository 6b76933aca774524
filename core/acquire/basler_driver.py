"""How pypylon is spoken to: its cameras, their settings, their grey levels."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.acquire.source import Picture
from core.errors import InputError

MODULE = "pypylon"
INSTALL = "Basler cameras need pypylon: install it with pip install 'trisect[basler]'."

_BITS = {"Mono8": 8, "Mono10": 10, "Mono12": 12, "Mono16": 16}


def list_cameras() -> list[tuple[str, str, str]]:
    """Serial number, name and kind of connection of each Basler camera that is plugged in.

    Raises
    ------
    InputError
        If pypylon is not installed, or its drivers cannot look.
    """
    pylon = pylon_module()
    return [(one.GetSerialNumber(), one.GetFriendlyName(), one.GetDeviceClass()) for one in devices(pylon)]


def pylon_module() -> Any:
    """Pypylon's module; InputError says what to install if it is missing."""
    try:
        return importlib.import_module(f"{MODULE}.pylon")
    except ImportError as missing:
        raise InputError(INSTALL.removesuffix(".")) from missing


def devices(pylon: Any) -> list[Any]:
    """What the driver knows of each camera that is plugged in."""
    try:
        return list(pylon.TlFactory.GetInstance().EnumerateDevices())
    except pylon.GenericException as problem:
        raise InputError(f"the drivers cannot look for cameras ({said(problem)})", where="Basler") from problem


def writable_node(camera: Any, name: str) -> Any:
    """A camera's node that can be written to, or None."""
    genicam = importlib.import_module(f"{MODULE}.genicam")
    try:
        node = camera.GetNodeMap().GetNode(name)
        return node if node is not None and genicam.IsWritable(node) else None
    except genicam.GenericException:
        return None


def choose(camera: Any, name: str, value: str) -> None:
    """Set an enumeration, where the camera has it and this entry of it."""
    node = writable_node(camera, name)
    if node is not None and value in node.GetSymbolics():
        node.SetValue(value)


def depth(camera: Any, name: str) -> int:
    """Bits of the camera's grey levels; its pixel format is made grey first."""
    node = camera.GetNodeMap().GetNode("PixelFormat")
    if node.GetValue() not in _BITS:
        choose(camera, "PixelFormat", "Mono8")
    if node.GetValue() not in _BITS:
        raise InputError(f"the camera gives {node.GetValue()} and no grey levels", where=name, todo="set it to Mono8")
    return _BITS[node.GetValue()]


def full_range(grey: NDArray[Any], bits: int) -> Picture:
    """Grey levels as they came with 8 or 16 bit; 10 and 12 bit spread over 16, white to white."""
    if bits in (8, 16):
        return np.array(grey)
    wide = grey.astype(np.uint16)
    spread: Picture = (wide << np.uint16(16 - bits)) | (wide >> np.uint16(2 * bits - 16))
    return spread


def let_go(pylon: Any, camera: Any) -> None:
    """Stop and close a camera, also one that is gone; None is none."""
    if camera is None:
        return
    try:
        camera.StopGrabbing()
        camera.Close()
    except pylon.GenericException:
        camera.DetachDevice()  # it is gone already


def said(problem: Exception) -> str:
    """The first sentence of what a driver says, without where in its source it was said."""
    return str(problem).split(" : ")[0].strip().removesuffix(".")
