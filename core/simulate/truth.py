"""The hidden truth of a simulated set, in a folder beside it: never part of what a measurement may read."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from core.errors import InputError
from core.files.arrays_file import Member, read_arrays
from core.files.atomic import write_bytes, write_text
from core.files.complaints import checked_json, fitting
from core.files.reading import read_json
from core.files.tables import Finite, ResultFile, Row3
from core.messages import Message, plain
from core.model import Camera, Fan, LightPlane, Pose

TRUTH_FILE = "truth.json"
DEPTH_FILE = "depth.npz"


_Row6 = Annotated[list[Finite], Field(min_length=6, max_length=6)]
_MAPS = {"depth": Member("f", ("rows", "columns")), "table": Member("b", ("rows", "columns"))}


class _Camera(ResultFile):
    """The camera as rendered."""

    image_size: tuple[int, int]
    matrix: Annotated[list[Row3], Field(min_length=3, max_length=3)]
    distortion: list[Finite]


class _Fan(ResultFile):
    """The fan as rendered."""

    pi: Annotated[list[Row3], Field(min_length=1)]


class _Content(ResultFile):
    """truth.json, but for the scenario."""

    camera: _Camera
    fan: _Fan | None
    sweeps: dict[str, Row3]
    camera_poses: dict[str, _Row6]
    plane_poses: dict[str, _Row6]
    object: dict[str, Any]
    known_planes: dict[str, _Row6] = Field(default_factory=dict)


@dataclass(frozen=True, eq=False, slots=True)
class Truth:
    """Truth of a simulated set: the figures that were rendered.

    Parameters
    ----------
    camera, fan
        As rendered; a rig may have no fan.
    sweeps
        Light plane of each frame of the scan, in order, by the frames' names.
    camera_poses, plane_poses
        `pose_cam_target` by the pictures' names, frames as in :mod:`core.image.targets.kinds`.
    thing
        Kind and figures of the object (`thickness_mm`, `step_heights_mm`, `centre_mm` and `radius_mm`, …), with
        `table_normal` and `table_point` in the camera frame.
    depth
        (height, width) float32, z in mm seen by each pixel centre during the scan; 0 where nothing is seen.
    table
        (height, width), True where that is the table.
    known_planes
        `pose_cam_target` of the boards beside the object, by their names, before anything is moved; of a bent one that
        of the plane through its middle.
    """

    camera: Camera
    fan: Fan | None
    sweeps: Mapping[str, LightPlane]
    camera_poses: Mapping[str, Pose]
    plane_poses: Mapping[str, Pose]
    thing: Mapping[str, Any]
    depth: NDArray[np.float32]
    table: NDArray[np.bool_]
    known_planes: Mapping[str, Pose] = field(default_factory=dict)


def truth_folder(set_folder: Path) -> Path:
    """Return the folder SET.truth beside `set_folder`, SET, for what is true of a simulated set."""
    return set_folder.with_name(set_folder.name + ".truth")


def save_truth(folder: Path, truth: Truth, scenario: Mapping[str, Any]) -> None:
    """Write the truth of a simulated set (camera, planes, poses, depths) and its scenario into `folder`."""
    content: dict[str, Any] = {
        "unit": "mm",
        "scenario": dict(scenario),
        "camera": {
            "image_size": list(truth.camera.image_size),
            "matrix": truth.camera.matrix.tolist(),
            "distortion": truth.camera.distortion.tolist(),
        },
        "fan": None
        if truth.fan is None
        else {"pi": truth.fan.pis.tolist(), "angles_deg": np.degrees(truth.fan.angles).tolist()},
        "sweeps": {name: plane.pi.tolist() for name, plane in truth.sweeps.items()},
        "camera_poses": {name: pose.vector.tolist() for name, pose in truth.camera_poses.items()},
        "plane_poses": {name: pose.vector.tolist() for name, pose in truth.plane_poses.items()},
        "object": dict(truth.thing),
    }
    if truth.known_planes:
        content["known_planes"] = {name: pose.vector.tolist() for name, pose in truth.known_planes.items()}
    write_text(folder / TRUTH_FILE, json.dumps(content, indent=1) + "\n")
    packed = io.BytesIO()
    np.savez(packed, depth=truth.depth, table=truth.table)  # packing it would take a quarter of the rendering's time
    write_bytes(folder / DEPTH_FILE, packed.getvalue())


def load_truth(folder: Path) -> Truth:
    """Load the truth of a simulated set (camera, planes, poses, depths); InputError if there is none.

    `folder` is the set's or that of the truth itself.

    Raises
    ------
    InputError
        If there is none.
    """
    inside = folder if (folder / TRUTH_FILE).exists() else truth_folder(folder)
    path = inside / TRUTH_FILE
    if not path.exists() or not (inside / DEPTH_FILE).exists():
        what = Message("simulate.no_truth", "there is no truth beside this set: it was not simulated here")
        raise InputError(what, where=folder)
    content = checked_json(_Content, read_json(path), path)
    maps = read_arrays(inside / DEPTH_FILE, _MAPS, todo=plain(""))
    camera = content.camera
    with fitting(path):
        return Truth(
            Camera(camera.image_size, np.array(camera.matrix), np.array(camera.distortion)),
            None if content.fan is None else Fan(tuple(LightPlane(np.array(pi)) for pi in content.fan.pi)),
            {name: LightPlane(np.array(pi)) for name, pi in content.sweeps.items()},
            {name: Pose.from_vector(vector) for name, vector in content.camera_poses.items()},
            {name: Pose.from_vector(vector) for name, vector in content.plane_poses.items()},
            content.object,
            maps["depth"],
            maps["table"],
            {name: Pose.from_vector(vector) for name, vector in content.known_planes.items()},
        )
