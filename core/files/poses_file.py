"""planes.npz: what the pictures of the plane target showed, so that the fan can be fitted again without them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.calibrate.plane_pose import PoseFeatures
from core.errors import InputError
from core.files.arrays_file import (
    Arrays,
    pack_centrelines,
    pack_texts,
    read_arrays,
    unpack_centrelines,
    write_arrays,
)
from core.image.target_view import TargetView

_TODO = "calibrate the fan first: trisect planes SET --out DIR"
_NO_VIEW = -1


def write_poses(path: Path, fan_id: str, poses: Sequence[PoseFeatures]) -> None:
    """Write planes.npz with the id of the fan that was fitted to `poses`; InputError if it cannot be written."""
    views = [pose.view for pose in poses if pose.view is not None]
    arrays: dict[str, NDArray[Any]] = {
        "fan_id": np.array(fan_id),
        "names": pack_texts([pose.name for pose in poses]),
        "reasons": pack_texts([pose.reason for pose in poses]),
        "view_lengths": np.array([_NO_VIEW if pose.view is None else len(pose.view.uv) for pose in poses], np.int64),
        "view_points": np.concatenate([np.zeros((0, 3)), *(view.points for view in views)]),
        "view_uv": np.concatenate([np.zeros((0, 2)), *(view.uv for view in views)]),
        "view_sigma": np.concatenate([np.zeros(0), *(view.sigma for view in views)]),
        **pack_centrelines("stripe", [pose.centrelines for pose in poses]),
    }
    write_arrays(path, arrays)


def read_poses(path: Path, fan_id: str) -> tuple[PoseFeatures, ...]:
    """Read planes.npz; nothing if it is not there or belongs to another fan than `fan_id`.

    Raises
    ------
    InputError
        If it is damaged or its arrays do not fit together.
    """
    if not path.exists():
        return ()
    arrays = read_arrays(path, ("fan_id", "names"), todo=_TODO)
    if str(arrays["fan_id"]) != fan_id:
        return ()
    try:
        return _unpacked(arrays)
    except KeyError as error:
        raise InputError(f"the array {error} is missing", where=path, todo=_TODO) from error
    except (ValueError, TypeError) as error:
        raise InputError(f"its arrays do not fit together ({error})", where=path, todo=_TODO) from error


def _unpacked(arrays: Arrays) -> tuple[PoseFeatures, ...]:
    names, reasons = arrays["names"].tolist(), arrays["reasons"].tolist()
    poses, first = [], 0
    columns = zip(names, reasons, arrays["view_lengths"].tolist(), unpack_centrelines("stripe", arrays), strict=True)
    for name, reason, length, centrelines in columns:
        view = None
        if length != _NO_VIEW:
            part = slice(first, first + length)
            points, uv, sigma = (arrays[f"view_{column}"][part] for column in ("points", "uv", "sigma"))
            view = TargetView(points, uv, sigma, name)
            first += length
        poses.append(PoseFeatures(name, view, centrelines, reason))
    return tuple(poses)
