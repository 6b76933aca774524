"""What the pictures of a target showed, as arrays: camera and fan can be solved again without the pictures."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.calibrate.camera.views import SeenView, SeenViews
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.files.arrays_file import (
    Arrays,
    centreline_members,
    check_parts,
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
from core.image.stripes.centreline import Centreline
from core.image.targets.target_view import TargetView
from core.messages import Command, Message, as_text, from_text

_OF_VIEWS = {
    "names": texts("pictures"),
    "reasons": texts("pictures"),
    "view_lengths": whole("pictures"),
    "view_points": real("points", 3),
    "view_uv": real("points", 2),
    "view_sigma": real("points"),
    "view_shares_errors": truth("pictures", optional=True),
    "view_covariance": real(None, optional=True),
}
_VIEWS = {**_OF_VIEWS, "key": texts(), "where": texts(), "sizes": whole("pictures", 2), "hot": whole(optional=True)}
_POSES = {
    **_OF_VIEWS,
    "fan_id": texts(),
    "notes": texts("pictures", optional=True),
    "moved_px": real("pictures", optional=True),
    "gain": real("pictures", optional=True),
    **centreline_members("stripe", "pictures"),
    "other_channels": texts("channels", optional=True),
    **{name: replace(one, optional=True) for name, one in centreline_members("other", "others").items()},
}
_TODO = Message("advice.calibrate_camera_again", "calibrate the camera again")


def write_views(path: Path, key: str, seen: SeenViews) -> None:
    """Write the views of the target, under the `key` of what they rest on; InputError if that fails."""
    arrays: dict[str, NDArray[Any]] = {
        "key": np.array(key),
        "where": np.array(seen.where),
        "names": pack_texts([one.name for one in seen.views]),
        "reasons": pack_messages([one.reason for one in seen.views]),
        "sizes": np.array([one.size or (0, 0) for one in seen.views], dtype=np.int64).reshape(-1, 2),
        **({} if seen.hot is None else {"hot": np.array(seen.hot, dtype=np.int64)}),
        **pack_views([one.view for one in seen.views]),
    }
    write_arrays(path, arrays)


def read_views(path: Path, key: str) -> SeenViews | None:
    """Read the target's views stored under `key`; None if the file is not there, or rests on something else.

    Raises
    ------
    InputError
        If it is damaged or its arrays do not fit together.
    """
    if not path.exists():
        return None
    arrays = read_arrays(path, _VIEWS, todo=_TODO)
    if str(arrays["key"]) != key:
        return None
    with unpacking(path, todo=_TODO):
        names = unpack_texts(arrays["names"])
        reasons = map(known_exclusion, unpack_messages(arrays["reasons"]))
        columns = zip(names, unpack_views(names, arrays), reasons, arrays["sizes"], strict=True)
        views = tuple(
            SeenView(name, view, reason, (int(size[0]), int(size[1])) if size.any() else None)
            for name, view, reason, size in columns
        )
        hot = int(arrays["hot"]) if "hot" in arrays else None  # files of earlier versions
        return SeenViews(views, str(arrays["where"]), hot)


_PLANES_TODO = Message(
    "advice.calibrate_planes_first",
    "calibrate the laser planes first{command}",
    command=Command("trisect planes SET --out DIR"),
)


def write_poses(path: Path, planes_id: str, poses: Sequence[PoseFeatures]) -> None:
    """Write planes.npz, what the poses' pictures show, with the id of their fan; InputError if that fails."""
    arrays: dict[str, NDArray[Any]] = {
        "fan_id": np.array(planes_id),
        "names": pack_texts([pose.name for pose in poses]),
        "reasons": pack_messages([pose.reason for pose in poses]),
        "notes": pack_texts(["\n".join(map(as_text, pose.notes)) for pose in poses]),
        "moved_px": np.array([_NOT_KNOWN if math.isnan(pose.moved_px) else pose.moved_px for pose in poses]),
        "gain": np.array([pose.gain for pose in poses]),
        **pack_views([pose.view for pose in poses]),
        **pack_centrelines("stripe", [pose.centrelines for pose in poses]),
        **_packed_others(poses),
    }
    write_arrays(path, arrays)


def read_poses(path: Path, *planes_ids: str) -> tuple[PoseFeatures, ...]:
    """Read planes.npz, what the poses' pictures show; () if missing, or of a fan not among `planes_ids`.

    Raises
    ------
    InputError
        If it is damaged or its arrays do not fit together.
    """
    if not path.exists():
        return ()
    arrays = read_arrays(path, _POSES, todo=_PLANES_TODO)
    if str(arrays["fan_id"]) not in planes_ids:
        return ()
    with unpacking(path, todo=_PLANES_TODO):
        return _unpacked(arrays)


def _unpacked(arrays: Arrays) -> tuple[PoseFeatures, ...]:
    names = unpack_texts(arrays["names"])
    notes = unpack_texts(arrays["notes"]) if "notes" in arrays else [""] * len(names)  # files of earlier versions
    moved_px = arrays.get("moved_px", np.full(len(names), _NOT_KNOWN))  # the same
    columns = zip(
        names,
        unpack_views(names, arrays),
        unpack_centrelines("stripe", arrays),
        map(known_exclusion, unpack_messages(arrays["reasons"])),
        (tuple(note for line in said.splitlines() if (note := from_text(line))) for said in notes),
        np.where(moved_px == _NOT_KNOWN, math.nan, moved_px).tolist(),
        arrays.get("gain", np.ones(len(names))).tolist(),
        _unpacked_others(arrays, len(names)),
        strict=True,
    )
    return tuple(PoseFeatures(*pose) for pose in columns)


def _packed_others(poses: Sequence[PoseFeatures]) -> dict[str, NDArray[Any]]:
    """Stripes in other channels, channel by channel of each pose; nothing where there are none."""
    channels = sorted({channel for pose in poses for channel in pose.others})
    if not channels:
        return {}
    lines = [pose.others.get(channel, ()) for pose in poses for channel in channels]
    return {"other_channels": pack_texts(channels), **pack_centrelines("other", lines)}


def _unpacked_others(arrays: Arrays, poses: int) -> list[Mapping[str, tuple[Centreline, ...]]]:
    """What `_packed_others` packed, pose by pose; KeyError or ValueError if the arrays do not fit together."""
    if "other_channels" not in arrays:
        return [{}] * poses
    channels, lines = unpack_texts(arrays["other_channels"]), unpack_centrelines("other", arrays)
    if len(lines) != poses * len(channels):
        raise ValueError(f"{len(lines)} stripes in other channels do not make {poses} poses")
    rows = (lines[first : first + len(channels)] for first in range(0, len(lines), len(channels)))
    return [{channel: own for channel, own in zip(channels, row, strict=True) if own} for row in rows]


_NO_VIEW = -1
"""Stands in place of the number of corners where the target was not found."""
_NOT_KNOWN = -1.0
"""Stands in place of how far a target moved where that is not known."""


def pack_views(views: Sequence[TargetView | None]) -> dict[str, NDArray[Any]]:
    """Pack the target's points in several views end to end into arrays; a None, for no target, has no points."""
    found = [view for view in views if view is not None]
    squares = [view.covariance.ravel() for view in found if view.covariance is not None]
    return {
        "view_lengths": np.array([_NO_VIEW if view is None else len(view.uv) for view in views], np.int64),
        "view_points": np.concatenate([np.zeros((0, 3)), *(view.points for view in found)]),
        "view_uv": np.concatenate([np.zeros((0, 2)), *(view.uv for view in found)]),
        "view_sigma": np.concatenate([np.zeros(0), *(view.sigma for view in found)]),
        "view_shares_errors": np.array([view is not None and view.covariance is not None for view in views]),
        "view_covariance": np.concatenate([np.zeros(0), *squares]),
    }


def unpack_views(names: Sequence[str], arrays: Arrays) -> tuple[TargetView | None, ...]:
    """Rebuild the views that `pack_views` packed, with these `names`; KeyError or ValueError if arrays do not fit."""
    found = arrays["view_lengths"]
    check_parts(found[found != _NO_VIEW], len(arrays["view_points"]))
    lengths = found.tolist()
    sharing = arrays.get("view_shares_errors", np.zeros(len(lengths), dtype=np.bool_)).tolist()  # earlier versions
    views: list[TargetView | None] = []
    first = square = 0
    for name, length, shares in zip(names, lengths, sharing, strict=True):
        if length == _NO_VIEW:
            views.append(None)
            continue
        part = slice(first, first + length)
        points, uv, sigma = (arrays[f"view_{column}"][part] for column in ("points", "uv", "sigma"))
        covariance = None
        if shares:
            size = 2 * length
            covariance = arrays["view_covariance"][square : square + size**2].reshape(size, size)
            square += size**2
        views.append(TargetView(points, uv, sigma, name, covariance))
        first += length
    return tuple(views)
