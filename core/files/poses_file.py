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
from core.files.views_arrays import pack_views, unpack_views

_TODO = "calibrate the fan first: trisect planes SET --out DIR"


def write_poses(path: Path, fan_id: str, poses: Sequence[PoseFeatures]) -> None:
    """Write planes.npz with the id of the fan that was fitted to `poses`; InputError if it cannot be written."""
    arrays: dict[str, NDArray[Any]] = {
        "fan_id": np.array(fan_id),
        "names": pack_texts([pose.name for pose in poses]),
        "reasons": pack_texts([pose.reason for pose in poses]),
        "notes": pack_texts(["\n".join(pose.notes) for pose in poses]),
        **pack_views([pose.view for pose in poses]),
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
    names = arrays["names"].tolist()
    notes = arrays["notes"].tolist() if "notes" in arrays else [""] * len(names)  # files of earlier versions
    columns = zip(
        names,
        unpack_views(names, arrays),
        unpack_centrelines("stripe", arrays),
        arrays["reasons"].tolist(),
        (tuple(said.splitlines()) for said in notes),
        strict=True,
    )
    return tuple(PoseFeatures(*pose) for pose in columns)
