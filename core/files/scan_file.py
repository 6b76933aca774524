"""scan.npz: what the gauge and the report need of a scan besides its cloud, as plain arrays.

The light planes of the sweeps with their covariance, the crossings, the fan's centrelines, and those of one frame to
show. Written by numpy; every name below is an array in it.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.files.atomic import write_bytes
from core.files.pictures import read_bytes
from core.image.centreline import Centreline
from core.model.arrays import Array

_POINTS = ("uv", "normal", "width", "strength", "sigma", "saturated")
_TODO = "measure the scan first: trisect scan SET --out DIR"


@dataclass(frozen=True, eq=False, slots=True)
class ShownFrame:
    """One frame to show in the report: its name, the sweep's centrelines and the (M, 2) crossings used, in pixels."""

    name: str
    index: int
    sweep: tuple[Centreline, ...]
    crossings: Array


@dataclass(frozen=True, eq=False, slots=True)
class ScanFile:
    """What scan.npz holds.

    Parameters
    ----------
    pis
        (S, 3) light planes of the sweeps in 1/mm.
    covariance
        (3S, 3S) of them, without what camera and fan have in common.
    sweep_frames
        (S,) the frame of each.
    fan, fan_line
        The fan's centrelines and the line (from 0; −1 unknown) of each.
    shown
        One frame to show, or None.
    calibration_id
        Names the calibration the scan was measured with.
    """

    pis: Array
    covariance: Array
    sweep_frames: NDArray[np.int64]
    fan: tuple[Centreline, ...]
    fan_line: tuple[int, ...]
    shown: ShownFrame | None
    calibration_id: str


def write_scan(path: Path, scan: ScanFile) -> None:
    """Write scan.npz; the same scan gives the same bytes. InputError if it cannot be written."""
    arrays: dict[str, Any] = {
        "pis": scan.pis,
        "covariance": scan.covariance,
        "sweep_frames": scan.sweep_frames,
        "fan_line": np.array(scan.fan_line, dtype=np.int64),
        "calibration_id": np.array(scan.calibration_id),
        **_packed("fan", scan.fan),
    }
    if scan.shown is not None:
        arrays |= {
            "shown_name": np.array(scan.shown.name),
            "shown_index": np.array(scan.shown.index),
            "shown_crossings": scan.shown.crossings,
            **_packed("shown", scan.shown.sweep),
        }
    data = io.BytesIO()
    np.savez(data, **arrays)
    write_bytes(path, data.getvalue())


def read_scan(path: Path) -> ScanFile:
    """Read scan.npz.

    Raises
    ------
    InputError
        If it is missing, damaged, lacks an array, or holds values that are not finite or of a wrong shape.
    """
    if not path.exists():
        raise InputError("the file is missing", where=path, todo=_TODO)
    try:
        with np.load(io.BytesIO(read_bytes(path)), allow_pickle=False) as file:
            arrays = dict(file)
        return _unpacked(path, arrays)
    except (zipfile.BadZipFile, ValueError, EOFError, OSError) as error:
        raise InputError(f"this is no whole scan file ({error})", where=path, todo=_TODO) from error
    except KeyError as error:
        raise InputError(f"the array {error} is missing", where=path, todo=_TODO) from error


def _unpacked(path: Path, arrays: Mapping[str, NDArray[Any]]) -> ScanFile:
    pis, covariance = arrays["pis"], arrays["covariance"]
    sweeps = len(arrays["sweep_frames"])
    for name, shape in (("pis", (sweeps, 3)), ("covariance", (3 * sweeps, 3 * sweeps))):
        if arrays[name].shape != shape:
            wanted = " × ".join(map(str, shape))
            raise InputError(f"the array {name} has shape {arrays[name].shape}, not {wanted}", where=path, todo=_TODO)
        if not np.isfinite(arrays[name]).all():
            raise InputError(f"the array {name} holds values that are not finite", where=path, todo=_TODO)
    shown = None
    if "shown_name" in arrays:
        shown = ShownFrame(
            str(arrays["shown_name"]),
            int(arrays["shown_index"]),
            _centrelines("shown", arrays),
            arrays["shown_crossings"],
        )
    return ScanFile(
        pis=pis,
        covariance=covariance,
        sweep_frames=arrays["sweep_frames"],
        fan=_centrelines("fan", arrays),
        fan_line=tuple(int(line) for line in arrays["fan_line"]),
        shown=shown,
        calibration_id=str(arrays["calibration_id"]),
    )


def _packed(prefix: str, pieces: Sequence[Centreline]) -> dict[str, NDArray[Any]]:
    """Centrelines end to end, with the length of each."""
    packed: dict[str, NDArray[Any]] = {
        f"{prefix}_lengths": np.array([len(piece) for piece in pieces], dtype=np.int64),
        f"{prefix}_correlation_px": np.array([piece.correlation_px for piece in pieces], dtype=np.float64),
    }
    for name in _POINTS:
        empty = np.zeros((0, 2) if name in ("uv", "normal") else 0)
        packed[f"{prefix}_{name}"] = np.concatenate([getattr(piece, name) for piece in pieces]) if pieces else empty
    return packed


def _centrelines(prefix: str, arrays: Mapping[str, NDArray[Any]]) -> tuple[Centreline, ...]:
    ends = np.cumsum(arrays[f"{prefix}_lengths"])[:-1]
    if not len(arrays[f"{prefix}_lengths"]):
        return ()
    columns = [np.split(arrays[f"{prefix}_{name}"], ends) for name in _POINTS]
    correlations = arrays[f"{prefix}_correlation_px"].tolist()
    pieces = zip(*columns, strict=True)
    return tuple(Centreline(*piece, correlation_px=each) for piece, each in zip(pieces, correlations, strict=True))
