"""Clouds as E57 (ASTM E2807), for scanning software: points in metres, σ as intensity.

E57 has no field for an uncertainty that every program shows, but all show the intensity: so it holds σ, the standard
uncertainty of each point's depth in mm, and the scan's name and description say so.
"""

from __future__ import annotations

import hashlib
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any
from uuid import UUID

import numpy as np
from pye57 import libe57

from core.errors import InputError
from core.files.atomic import write_beside
from core.files.results.frame_text import frame_words
from core.inspect.shown.view_frame import CAMERA_FRAME, ViewFrame
from core.messages import Message
from core.scan.surface.cloud import Cloud

METRES = 1e-3
"""Metres in a millimetre: E57 states coordinates in metres."""
_GPS_EPOCH = datetime(1980, 1, 6, tzinfo=UTC)
_LEAP_SECONDS = 18
"""GPS time − UTC since 2017."""


def write_e57(
    path: Path,
    cloud: Cloud,
    at: datetime,
    *,
    name: str = "",
    calibration_id: str = "",
    frame: ViewFrame = CAMERA_FRAME,
) -> None:
    """Write a point cloud as E57: x, y, z in m, intensity = σ in mm; InputError if it has no point or that fails.

    Parameters
    ----------
    path
        Where to write.
    cloud
        The points; at least one.
    at
        When they were measured.
    name
        Of the part.
    calibration_id
        Of the calibration they were measured with.
    frame
        That the places are written in; the description names it.

    Raises
    ------
    InputError
        If there is no point, or the file cannot be written.
    """
    if not len(cloud):
        raise InputError(Message("file.empty_cloud", "the cloud has no point, and E57 takes none without"), where=path)

    placed = replace(cloud, points=frame.coordinates(cloud.points))
    about = (
        f"Points in m; {frame_words(frame.kind)}. Intensity is the standard uncertainty of each "
        "point's depth in mm, without what is common to the scan. "
        f"Calibration {calibration_id or 'not told'}."
    )

    def put(beside: Path) -> None:
        beside.touch(exist_ok=False)  # says what is wrong with the place, which the library does not
        try:
            _write(beside, placed, at, name, about)
        except libe57.E57Exception as error:
            raise OSError(0, "the E57 library failed; the disk may be full") from error

    write_beside(path, put)


def _write(path: Path, cloud: Cloud, at: datetime, name: str, about: str) -> None:
    file = libe57.ImageFile(str(path), "w")
    try:
        scan = _head(file, cloud, at, name, about)
        points = libe57.CompressedVectorNode(file, _prototype(file, cloud), libe57.VectorNode(file, True))
        scan.set("points", points)
        file.root()["data3D"].append(scan)
        columns = {axis: METRES * cloud.points[:, n] for n, axis in enumerate(_AXES)}
        columns["intensity"] = cloud.sigma.astype(np.float32)
        buffers = libe57.VectorSourceDestBuffer()
        kept = {key: np.ascontiguousarray(values) for key, values in columns.items()}  # alive until written
        for key, values in kept.items():
            buffers.append(libe57.SourceDestBuffer(file, key, values, len(cloud), True, True))
        writer = points.writer(buffers)
        writer.write(len(cloud))
        writer.close()
    finally:
        file.close()


_AXES = ("cartesianX", "cartesianY", "cartesianZ")


def _head(file: Any, cloud: Cloud, at: datetime, name: str, about: str) -> Any:
    """The file's own nodes, and those of the scan but its points."""
    digest = hashlib.sha256(cloud.points.tobytes() + cloud.sigma.tobytes() + about.encode()).digest()
    seconds = (at.astimezone(UTC) - _GPS_EPOCH).total_seconds() + _LEAP_SECONDS
    file.extensionsAdd("", libe57.E57_V1_0_URI)
    root = file.root()
    _set(file, root, "formatName", "ASTM E57 3D Imaging Data File")
    _set(file, root, "guid", f"{{{UUID(bytes=digest[:16])}}}")
    _set(file, root, "versionMajor", int(libe57.E57_FORMAT_MAJOR))
    _set(file, root, "versionMinor", int(libe57.E57_FORMAT_MINOR))
    _set(file, root, "e57LibraryVersion", str(libe57.E57_LIBRARY_ID))
    _set(file, root, "coordinateMetadata", "")
    root.set("creationDateTime", _time(file, seconds))
    root.set("data3D", libe57.VectorNode(file, True))
    root.set("images2D", libe57.VectorNode(file, True))
    scan = libe57.StructureNode(file)
    _set(file, scan, "guid", f"{{{UUID(bytes=digest[16:])}}}")
    _set(file, scan, "name", f"{name or 'scan'} (intensity: sigma in mm)")
    _set(file, scan, "description", about)
    _set(file, scan, "sensorVendor", "Trisect")
    scan.set("acquisitionStart", _time(file, seconds))
    low, high = METRES * cloud.points.min(axis=0), METRES * cloud.points.max(axis=0)
    bounds = {f"{axis}{end}": float(value[n]) for n, axis in enumerate("xyz") for end, value in
              (("Minimum", low), ("Maximum", high))}  # fmt: skip
    scan.set("cartesianBounds", _structure(file, bounds))
    sigma = cloud.sigma.astype(np.float32)
    limits = {"intensityMinimum": float(sigma.min()), "intensityMaximum": float(sigma.max())}
    scan.set("intensityLimits", _structure(file, limits))
    return scan


def _prototype(file: Any, cloud: Cloud) -> Any:
    """The fields of a point: coordinates in double, σ in single precision."""
    point = libe57.StructureNode(file)
    for axis in _AXES:
        point.set(axis, libe57.FloatNode(file, 0.0, libe57.E57_DOUBLE, libe57.E57_DOUBLE_MIN, libe57.E57_DOUBLE_MAX))
    sigma = cloud.sigma.astype(np.float32)
    low, high = float(sigma.min()), float(sigma.max())
    point.set("intensity", libe57.FloatNode(file, low, libe57.E57_SINGLE, low, high))
    return point


def _structure(file: Any, values: dict[str, float]) -> Any:
    node = libe57.StructureNode(file)
    for key, value in values.items():
        _set(file, node, key, value)
    return node


def _time(file: Any, seconds: float) -> Any:
    node = libe57.StructureNode(file)
    _set(file, node, "dateTimeValue", float(seconds))
    _set(file, node, "isAtomicClockReferenced", 0)
    return node


def _set(file: Any, node: Any, key: str, value: str | int | float) -> None:
    kinds = {str: libe57.StringNode, int: libe57.IntegerNode, float: libe57.FloatNode}
    node.set(key, kinds[type(value)](file, value))
