"""features.npz: what a scan's pictures showed, as plain arrays; the same arrays stand in scan.npz.

A recording keeps it beside its frames, which were looked at while they came: they are not looked at again.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.files.arrays_file import (
    Arrays,
    Member,
    centreline_members,
    pack_centrelines,
    pack_messages,
    pack_texts,
    read_arrays,
    real,
    texts,
    truth,
    unpack_centrelines,
    unpack_messages,
    unpack_texts,
    unpacking,
    whole,
    write_arrays,
)
from core.image.exclusion import known_exclusion
from core.image.stripes.stripe import StripeSettings
from core.messages import Message
from core.model.arrays import Array
from core.scan.features.crossings import CrossingTable
from core.scan.features.extraction import FrameFeatures, ScanFeatures

FEATURES = "features.npz"
"""Name of the file beside the frames of a recording."""

_TODO = Message("advice.measure_scan_again", "measure the scan again")
_CROSSINGS = tuple(one.name for one in fields(CrossingTable))

FEATURES_MEMBERS: Mapping[str, Member] = {
    "features_key": texts(optional=True),
    "image_size": whole(2),
    "frame_names": texts("frames"),
    "frame_reasons": texts("frames"),
    "frame_shift_px": real("frames"),
    "frame_gain": real("frames", optional=True),
    "notes": texts(None),
    "faults": texts(None, optional=True),
    "too_fine_for_mosaic": truth(optional=True),
    "stripes": real(2, 2),
    "frame_fan_shifts_px": real("frames", None, optional=True),
    "frame_fan_known": truth("frames", optional=True),
    "crossing_half_length_px": real(),
    **{f"crossing_{name}": real("crossings", 2) for name in ("uv", "tangent_a", "tangent_b")},
    **{f"crossing_{name}": real("crossings") for name in ("sigma_a", "sigma_b", "along_a", "along_b")},
    **{f"crossing_{name}": whole("crossings") for name in ("a", "b", "piece_a", "piece_b", "cell_a", "cell_b")},
    **{f"crossing_{name}": real("crossings", None) for name in ("share_a", "share_b")},
    **centreline_members("fan", 1),
    **centreline_members("sweep", "frames"),
}
"""The arrays of a scan's features."""


def write_features(path: Path, features: ScanFeatures, key: str) -> None:
    """Write what a scan's pictures show (stripes, crossings) to features.npz, under `key`; InputError if that fails."""
    write_arrays(path, pack_features(features, key))


def read_features(path: Path, key: str) -> ScanFeatures | None:
    """Read a scan's features from features.npz or scan.npz; None if missing, or not stored under `key`.

    Raises
    ------
    InputError
        If it is damaged, lacks an array, or holds values that are not finite or of a wrong shape.
    """
    if not path.exists():
        return None
    arrays = read_arrays(path, FEATURES_MEMBERS, todo=_TODO)
    if str(arrays.get("features_key", "")) != key:
        return None
    with unpacking(path, todo=_TODO):
        return unpack_features(arrays)


def pack_features(features: ScanFeatures, key: str) -> dict[str, NDArray[Any]]:
    """Pack a scan's features into arrays, with the `key` of what they rest on."""
    crossings = features.crossings
    return {
        "features_key": np.array(key),
        "image_size": np.array(features.image_size),
        "frame_names": pack_texts([frame.name for frame in features.frames]),
        "frame_reasons": pack_messages([frame.reason for frame in features.frames]),
        "frame_shift_px": np.array([frame.shift_px for frame in features.frames], dtype=np.float64),
        "notes": pack_messages(features.notes),
        "faults": pack_messages(features.faults),
        "stripes": _stripes(features.fan_stripe, features.sweep_stripe),
        **(
            {}
            if features.too_fine_for_mosaic is None
            else {"too_fine_for_mosaic": np.array(features.too_fine_for_mosaic)}
        ),
        **_pack_shifts(features),
        **_pack_gains(features),
        **{f"crossing_{name}": np.asarray(getattr(crossings, name)) for name in _CROSSINGS},
        **pack_centrelines("fan", [features.fan]),
        **pack_centrelines("sweep", [frame.centrelines for frame in features.frames]),
    }


def unpack_features(arrays: Arrays) -> ScanFeatures:
    """Rebuild a scan's features from the arrays of `pack_features`; KeyError or ValueError if they do not fit."""
    frames = zip(
        unpack_texts(arrays["frame_names"]),
        unpack_centrelines("sweep", arrays),
        map(known_exclusion, unpack_messages(arrays["frame_reasons"])),
        arrays["frame_shift_px"].tolist(),
        [0.0] * len(arrays["frame_names"]),
        _unpack_shifts(arrays),
        [{}] * len(arrays["frame_names"]),
        _unpack_gains(arrays),
        strict=True,
    )
    width, height = arrays["image_size"].tolist()
    fan_stripe, sweep_stripe = _settings(arrays["stripes"])
    table: dict[str, Any] = {name: arrays[f"crossing_{name}"] for name in _CROSSINGS}
    table["half_length_px"] = float(table["half_length_px"])
    return ScanFeatures(
        image_size=(width, height),
        fan=unpack_centrelines("fan", arrays)[0],
        frames=tuple(FrameFeatures(index, *frame) for index, frame in enumerate(frames)),
        crossings=CrossingTable(**table),
        sweep_stripe=sweep_stripe,
        fan_stripe=fan_stripe,
        notes=tuple(filter(None, unpack_messages(arrays["notes"]))),
        faults=tuple(filter(None, unpack_messages(arrays["faults"]))) if "faults" in arrays else (),
        too_fine_for_mosaic=bool(arrays["too_fine_for_mosaic"]) if "too_fine_for_mosaic" in arrays else None,
    )


def _pack_shifts(features: ScanFeatures) -> dict[str, NDArray[Any]]:
    """Shifts (F, C) of the fan's stretches, and of which frames (F,) they are known."""
    known = np.array([len(frame.fan_shifts_px) > 0 for frame in features.frames], dtype=np.bool_)
    widest = max((len(frame.fan_shifts_px) for frame in features.frames), default=0)
    shifts = np.zeros((len(known), widest))
    for row, frame in zip(shifts, features.frames, strict=True):
        row[: len(frame.fan_shifts_px)] = frame.fan_shifts_px
    return {"frame_fan_shifts_px": shifts, "frame_fan_known": known}


def _unpack_shifts(arrays: Arrays) -> list[Array]:
    if "frame_fan_known" not in arrays:
        return [np.zeros(0)] * len(arrays["frame_names"])
    rows = zip(arrays["frame_fan_known"].tolist(), arrays["frame_fan_shifts_px"], strict=True)
    return [shifts if known else np.zeros(0) for known, shifts in rows]


def _pack_gains(features: ScanFeatures) -> dict[str, NDArray[Any]]:
    """The frames' gains (F,); nothing where all have the reference's brightness."""
    gains = np.array([frame.gain for frame in features.frames], dtype=np.float64)
    return {"frame_gain": gains} if np.any(gains != 1) else {}


def _unpack_gains(arrays: Arrays) -> list[float]:
    return arrays["frame_gain"].tolist() if "frame_gain" in arrays else [1.0] * len(arrays["frame_names"])


def _stripes(fan: StripeSettings, sweep: StripeSettings | None) -> Array:
    """Width and contrast of the fan's stripes and of the sweep's; 0 where there is none."""
    return np.array([[fan.width_px, fan.contrast], [sweep.width_px, sweep.contrast] if sweep else [0.0, 0.0]])


def _settings(stripes: NDArray[Any]) -> tuple[StripeSettings, StripeSettings | None]:
    fan, sweep = stripes.tolist()
    return StripeSettings(*fan), StripeSettings(*sweep) if sweep[0] > 0 else None
