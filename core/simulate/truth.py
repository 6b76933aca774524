"""The hidden truth of a simulated set, in a folder beside it: never part of what a measurement may read."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.files.atomic import write_bytes, write_text
from core.messages import Message
from core.model import Camera, Fan, LightPlane, Pose

TRUTH_FILE = "truth.json"
DEPTH_FILE = "depth.npz"


@dataclass(frozen=True, eq=False, slots=True)
class Truth:
    """Truth of a simulated set: what was rendered.

    Parameters
    ----------
    camera, fan
        As rendered.
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
    """

    camera: Camera
    fan: Fan
    sweeps: Mapping[str, LightPlane]
    camera_poses: Mapping[str, Pose]
    plane_poses: Mapping[str, Pose]
    thing: Mapping[str, Any]
    depth: NDArray[np.float32]
    table: NDArray[np.bool_]


def truth_folder(set_folder: Path) -> Path:
    """Folder of the truth of the set in `set_folder`: SET.truth beside SET."""
    return set_folder.with_name(set_folder.name + ".truth")


def save_truth(folder: Path, truth: Truth, scenario: Mapping[str, Any]) -> None:
    """Write truth.json and depth.npz into `folder`, and with them the scenario."""
    content = {
        "unit": "mm",
        "scenario": dict(scenario),
        "camera": {
            "image_size": list(truth.camera.image_size),
            "matrix": truth.camera.matrix.tolist(),
            "distortion": truth.camera.distortion.tolist(),
        },
        "fan": {"pi": truth.fan.pis.tolist(), "angles_deg": np.degrees(truth.fan.angles).tolist()},
        "sweeps": {name: plane.pi.tolist() for name, plane in truth.sweeps.items()},
        "camera_poses": {name: pose.vector.tolist() for name, pose in truth.camera_poses.items()},
        "plane_poses": {name: pose.vector.tolist() for name, pose in truth.plane_poses.items()},
        "object": dict(truth.thing),
    }
    write_text(folder / TRUTH_FILE, json.dumps(content, indent=1) + "\n")
    packed = io.BytesIO()
    np.savez(packed, depth=truth.depth, table=truth.table)  # packing it would take a quarter of the rendering's time
    write_bytes(folder / DEPTH_FILE, packed.getvalue())


def load_truth(folder: Path) -> Truth:
    """Load the truth of a simulated set; `folder` is the set's or that of the truth itself.

    Raises
    ------
    InputError
        If there is none.
    """
    inside = folder if (folder / TRUTH_FILE).exists() else truth_folder(folder)
    try:
        content = json.loads((inside / TRUTH_FILE).read_text(encoding="utf-8"))
        with np.load(inside / DEPTH_FILE) as maps:
            depth, table = maps["depth"], maps["table"]
    except FileNotFoundError as error:
        raise InputError(
            Message("simulate.no_truth", "there is no truth beside this set: it was not simulated here"), where=folder
        ) from error
    camera = content["camera"]
    return Truth(
        Camera(tuple(camera["image_size"]), camera["matrix"], camera["distortion"]),
        Fan(tuple(LightPlane(pi) for pi in content["fan"]["pi"])),
        {name: LightPlane(pi) for name, pi in content["sweeps"].items()},
        {name: Pose.from_vector(vector) for name, vector in content["camera_poses"].items()},
        {name: Pose.from_vector(vector) for name, vector in content["plane_poses"].items()},
        content["object"],
        depth,
        table,
    )
