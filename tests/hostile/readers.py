"""Every reader of a file that a stranger may have written, with a good file of each kind to begin with."""

from __future__ import annotations

import json
import os
import secrets
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from core.calibrate.camera.views import SeenView, SeenViews
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.files.arrays_file import write_arrays
from core.files.exchange.opencv_calibration import read_opencv, write_opencv
from core.files.exchange.ros_camera_info import read_camera_info
from core.files.film import is_film, read_film
from core.files.pictures import compression_of, read_picture
from core.files.plan.plan_file import read_plan, write_plan
from core.files.project.data import ProjectFile, new_project
from core.files.project.folder import create_project, read_project
from core.files.project.lock import lock_owner, take_lock
from core.files.project.packing import pack_project, unpack_project
from core.files.project.report_template import read_report_template
from core.files.recording.features_file import read_poses, read_views, write_views
from core.files.recording.import_pictures import earlier_imports
from core.files.recording.import_plan import _taken_at
from core.files.recording.marks import marked_frames
from core.files.recording.recording_log import read_log
from core.files.recording.rig import read_rig
from core.files.recording.set_listing import check_sizes
from core.files.recording.unfinished import note_recording, unfinished_recording
from core.files.results.artefact_register import read_register
from core.files.results.camera_file import read_camera
from core.files.results.check_file import read_check
from core.files.results.gauge_file import read_gauge, read_thickness
from core.files.results.geometry_file import read_geometry
from core.files.results.inspection_file import read_inspection
from core.files.results.mesh_export import write_stl
from core.files.results.nominal_surface import read_nominal
from core.files.results.planes_file import planes_id, read_planes
from core.files.results.ply import read_cloud, read_mesh
from core.files.results.profile_file import read_profiles_file
from core.files.results.rig_history import DATA, read_history
from core.files.results.run_file import read_run
from core.files.results.scan_file import read_scan
from core.files.results.shown_file import read_shown, write_shown
from core.inspect.shown.shown_features import ShownClass, ShownDeviations, ShownFeature, ShownInspection, ShownProfile
from core.inspect.shown.view_frame import CAMERA_FRAME
from core.messages import Message
from core.simulate.scenario import Scenario
from core.simulate.truth import load_truth, truth_folder
from tests.code import ROOT
from tests.files.plan.test_plan_file import EVERYTHING
from tests.films import sweep, write_film
from tests.report.report_samples import camera_calibration


@dataclass(frozen=True, slots=True)
class Reader:
    """What is read of `file`, a path within the folder of good files."""

    file: str
    read: Callable[[Path], Any]


def _poses(path: Path) -> tuple[PoseFeatures, ...]:
    return read_poses(path, planes_id(read_planes(path.with_name("planes.json"), _camera(path)).fan))


def _camera(path: Path) -> Any:
    return read_camera(path.with_name("camera.json")).camera


def _picture(path: Path) -> None:
    compression_of(path, "red-green")
    check_sizes([path, path.with_name("other.png")] if path.suffix == "" else [path])
    _taken_at(path)
    read_picture(path)


def _film(path: Path) -> None:
    if is_film(path):
        read_film(path)


def _packed(path: Path) -> None:
    folder = path.with_name(f"unpacked-{secrets.token_hex(4)}")
    try:
        unpack_project(path, folder)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _of_the_rig(path: Path, read: Callable[[], Any]) -> Any:
    """What is read of a file in the user's own folder, which is `path`'s now; such folders are named by the system."""
    before = os.environ.get(DATA)
    os.environ[DATA] = str(path.parent.parent)
    try:
        return read()
    finally:
        os.environ.pop(DATA) if before is None else os.environ.update({DATA: before})


def _geometry(path: Path) -> Any:
    return read_geometry(path, read_cloud(path.with_name("cloud.ply")).cloud.points, CAMERA_FRAME)


PLAN: dict[str, Any] = {"feature": []}
FILMS = {"avi": "MJPG", "mkv": "FFV1", "mp4": "mp4v", "gif": "", "png": ""}
"""By the ending: the coding."""

READERS = {
    "rig": Reader("rig.toml", read_rig),
    "plan": Reader("plan.toml", read_plan),
    "template": Reader("template.toml", read_report_template),
    "logo": Reader("logo.png", lambda path: read_report_template(path.with_name("template.toml"))),
    "scenario": Reader("scenario.toml", Scenario.read),
    "project": Reader("project/project.json", read_project),
    "lock": Reader("project/.lock.json", lambda path: lock_owner(path.parent)),
    "packed": Reader("packed.trisectz", _packed),
    "camera": Reader("camera.json", read_camera),
    "planes": Reader("planes.json", lambda path: read_planes(path, _camera(path))),
    "poses": Reader("planes.npz", _poses),
    "views": Reader("views.npz", lambda path: read_views(path, "key")),
    "scan": Reader("scan.npz", read_scan),
    "gauge": Reader("gauge.json", lambda path: read_gauge(path, read_cloud(path.with_name("cloud.ply")).cloud)),
    "thickness": Reader("gauge.json", read_thickness),
    "faces": Reader("gauge.npz", lambda path: read_gauge(path.with_suffix(".json"), _cloud(path))),
    "run": Reader("run.json", read_run),
    "check": Reader("check.json", read_check),
    "inspection": Reader("inspection.json", read_inspection),
    "geometry": Reader("inspection.json", _geometry),
    "measured points": Reader("inspection.npz", lambda path: _geometry(path.with_suffix(".json"))),
    "shown": Reader("shown.npz", lambda path: read_shown(path.with_name("inspection.json"), PLAN)),
    "profile": Reader("profile.json", read_profiles_file),
    "history": Reader("own/rigs/rig.json", lambda path: _of_the_rig(path, lambda: read_history("rig"))),
    "artefacts": Reader("set/artefacts.toml", lambda path: _of_the_rig(path, lambda: read_register(path.parent))),
    "imports": Reader("set/import.json", lambda path: earlier_imports(path.parent)),
    "marks": Reader("set/marks.csv", lambda path: marked_frames(path.parent)),
    "unfinished": Reader("begun/recordings/.unfinished.json", lambda path: unfinished_recording(path.parents[1])),
    "truth": Reader("set.truth/truth.json", lambda path: load_truth(path.parent)),
    "true depth": Reader("set.truth/depth.npz", lambda path: load_truth(path.parent)),
    "cloud": Reader("small.ply", read_cloud),
    "mesh": Reader("mesh.ply", read_mesh),
    "nominal": Reader("part.stl", lambda path: read_nominal(path, 0.1)),
    "log": Reader("log/recording.csv", lambda path: read_log(path.parent)),
    "opencv yaml": Reader("opencv.yml", read_opencv),
    "opencv json": Reader("opencv.json", read_opencv),
    "opencv xml": Reader("opencv.xml", read_opencv),
    "ros": Reader("ros.yaml", read_camera_info),
    **{f"film {end}": Reader(f"film.{end}", _film) for end in FILMS},
    **{f"picture {end}": Reader(f"picture.{end}", _picture) for end in ("png", "jpg", "tif", "bmp", "pgm")},
}


@cache
def of_wings() -> tuple[Any, ...]:
    """The modules `readers` among the tests of the wings: each has READERS, and `good_files` of a folder."""
    places = sorted((ROOT / "tests" / "wings").glob("*/readers.py"))
    return tuple(import_module(f"tests.wings.{path.parent.name}.readers") for path in places)


@cache
def all_readers() -> dict[str, Reader]:
    """Those of the house, and those of the wings."""
    return READERS | {name: reader for wing in of_wings() for name, reader in wing.READERS.items()}


def _cloud(path: Path) -> Any:
    return read_cloud(path.with_name("cloud.ply")).cloud


_NOTE = {"code": "scan.fan_disagrees", "text": "3 of them.", "values": {"n": 3}}
CHECK = {
    "calibration_id": "a", "pictures_id": "b", "taken_at": "2026-01-01T00:00:00+00:00", "p": 0.5, "step_mm": 50.0,
    "error_mm": 0.1, "unseen_mm": 0.2, "stated_mm": None,
    "poses": [{"name": "p", "reason": None, "lines": [
        {"line": 1, "offset_mm": 0.1, "offset_px": 0.2, "sd_mm": 0.01},
        {"line": 2, "offset_mm": 0.1, "offset_px": 0.2, "sd_mm": 0.1},
    ]}, {"name": "q", "reason": _NOTE, "lines": []}],
}  # fmt: skip
INSPECTION = {
    "schema_version": 1, "plan": PLAN, "calibration_id": "a", "notes": [_NOTE, "a note"],
    "features": [
        {"name": "top", "kind": "plane", "shape": {"normal": [0.0, 0.0, -1.0], "centres": [[0.0, 0.0, 600.0]]}},
        {"name": "side", "kind": "plane", "problem": _NOTE},
        {"name": "bore", "kind": "cylinder",
         "shape": {"centre": [0.0, 0.0, 600.0], "direction": [1.0, 0.0, 0.0], "radius_mm": 8.0}},
        {"name": "cut", "kind": "section", "section": {
            "origin_mm": [0.0, 0.0, 600.0], "along": [1.0, 0.0, 0.0], "up": [0.0, 0.0, -1.0], "step_mm": 0.5}},
    ],
    "pose_camera_part": {
        "rotation": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], "translation_mm": [0.0, 0.0, 600.0],
    },
    "characteristics": [{
        "name": "top flatness", "feature": "top", "kind": "plane", "value": 0.02, "u": 0.004, "k": 2.0,
        "quantity": "length",
        "limits": {"nominal": 0.0, "lower": None, "upper": 0.05}, "complete": True, "rule": _NOTE, "notes": [],
        "budget": [{"source": "camera", "u": 0.001, "point_mm": 1.0, "distribution": "normal", "dof": None}],
    }],
}  # fmt: skip
MEASURED = {
    "points_0": np.arange(40), "points_2": np.arange(40, 60),
    "profile_3": np.column_stack([np.arange(30.0), np.ones(30)]),
}  # fmt: skip
PROFILE = {
    "thickness_mm": 50.0, "U_mm": 0.1, "u_mm": 0.05, "k": 2.0, "shown": 0, "calibration_id": "a", "pictures": [
        {"index": 0, "name": "a.png", "thickness_mm": 50.0, "own_mm": 0.1, "points": [5, 6], "reason": None},
        {"index": 1, "name": "b.png", "thickness_mm": None, "own_mm": None, "points": [0, 0], "reason": _NOTE},
    ],
}  # fmt: skip
PAST_CHECK = {
    "taken_at": "2026-01-01T00:00:00+00:00", "calibration_id": "a", "pictures_id": "b", "verdict": "passed", "p": 0.5,
    "step_mm": 50.0, "offset_px": 0.1, "error_mm": 0.01, "unseen_mm": 0.02, "stated_mm": None, "celsius": 20.5,
}  # fmt: skip
SHOWN = ShownInspection(
    (
        ShownFeature("top", "plane", (), 3, np.zeros((3, 3), np.float32), np.zeros((3, 2), np.float32)),
        ShownFeature(
            "cut", "section", (), 0, np.zeros((0, 3), np.float32), np.zeros((0, 2), np.float32), Message("a.b", "why"),
            ShownProfile(np.zeros(4), np.zeros(4), np.zeros(4), np.zeros(4), np.zeros(4, np.int64)),
            ShownDeviations(
                (ShownClass("good", 0, -1.0, 1.0, 1.0, np.zeros((2, 3), np.float32)),),
                np.arange(3.0), np.arange(2), 0.1, np.zeros((1, 3, 3), np.float32),
            ),
        ),
    ),
    False, (), "a",
)  # fmt: skip
"""As the programs of an interim check and of a plan write them."""


def good_files(folder: Path, recording: Path, results: Path) -> None:
    """Write a good file of each kind into `folder`, from a recording set and what was measured of it."""
    shutil.copytree(results, folder)
    shutil.copy(recording / "rig.toml", folder)
    write_plan(folder / "plan.toml", EVERYTHING)
    for wing in of_wings():
        wing.good_files(folder)
    template = (
        'name = "A"\naddress = ["B", "C"]\nlogo = "logo.png"\naccent = "#14586E"\ntext = "D"\nwithout = ["frame"]'
    )
    (folder / "template.toml").write_text(template)
    (folder / "scenario.toml").write_text('object = "block"\nscale = 0.25\nframes = 20\nseed = 3\n')
    (folder / "check.json").write_text(json.dumps(CHECK))
    (folder / "inspection.json").write_text(json.dumps(INSPECTION))
    write_arrays(folder / "inspection.npz", MEASURED)
    write_shown(folder / "inspection.json", SHOWN)
    (folder / "profile.json").write_text(json.dumps(PROFILE))
    _pictures(folder)
    _of_a_set(folder, recording)
    _tables(folder)
    _cameras(folder)
    (folder / "project").mkdir()
    create_project(folder / "project", ProjectFile(new_project("a")))
    pack_project(folder / "project", folder / "packed.trisectz")
    take_lock(folder / "project")
    poses = _poses(folder / "planes.npz")
    seen = tuple(SeenView(pose.name, pose.view, None, (1024, 768)) for pose in poses)
    write_views(folder / "views.npz", "key", SeenViews(seen, "camera"))
    mesh = read_mesh(folder / "mesh.ply")
    write_stl(folder / "part.stl", mesh)
    data = (folder / "cloud.ply").read_bytes()
    head, _, _ = data.partition(b"end_header\n")
    small = b"element vertex 50"
    lines = [small if line.startswith(b"element vertex") else line for line in head.split(b"\n")]
    body = data[len(head) + 11 :]
    (folder / "small.ply").write_bytes(b"\n".join(lines) + b"end_header\n" + body[: 50 * (len(body) // _count(head))])


def _of_a_set(folder: Path, recording: Path) -> None:
    """What lies in and beside a recording set, and in the user's own folder."""
    inside = folder / "set"
    inside.mkdir()
    block = 'id = "GB 50"\nkind = "step"\nvalue_mm = 50.0\nU_mm = 0.001\ndue = 2028-03-01'
    (inside / "artefacts.toml").write_text(f"[[artefact]]\n{block}\n")
    (inside / "import.json").write_text(json.dumps({"imports": [{"version": "1", "pictures": []}]}))
    (inside / "marks.csv").write_text("name\nframe1.png\nframe2.png\n")
    shutil.copytree(truth_folder(recording), folder / "set.truth")
    (folder / "own" / "rigs").mkdir(parents=True)
    (folder / "own" / "rigs" / "rig.json").write_text(json.dumps({"rig": "rig", "checks": [PAST_CHECK]}))
    (folder / "begun" / "recordings" / "scan").mkdir(parents=True)
    note_recording(folder / "begun", "scan", folder / "begun" / "recordings" / "scan")
    shutil.copy(folder / "picture.png", folder / "begun" / "recordings" / "scan")


def _count(head: bytes) -> int:
    return int(next(line.split()[2] for line in head.split(b"\n") if line.startswith(b"element vertex")))


def _pictures(folder: Path) -> None:
    grey = np.random.default_rng(0).integers(0, 255, (20, 30)).astype(np.uint8)
    for end in ("png", "jpg", "tif", "bmp", "pgm"):
        cv2.imwrite(str(folder / f"picture.{end}"), grey)
    cv2.imwrite(str(folder / "logo.png"), grey)
    for end, coding in FILMS.items():
        write_film(folder / f"film.{end}", sweep(4, size=(32, 32)), coding)


def _tables(folder: Path) -> None:
    (folder / "log").mkdir()
    rows = "".join(f"frame{i}.png,{i},{i / 30:.6f},0\n" for i in range(9))
    (folder / "log" / "recording.csv").write_text(f"name,index,time_s,dropped\n{rows}")


def _cameras(folder: Path) -> None:
    calibration = camera_calibration()
    for end in ("yml", "json"):
        write_opencv(folder / f"opencv.{end}", calibration, datetime(2026, 1, 1, tzinfo=UTC))
    storage = cv2.FileStorage(str(folder / "opencv.xml"), cv2.FILE_STORAGE_WRITE)
    storage.write("image_width", 640)
    storage.write("image_height", 480)
    storage.write("camera_matrix", np.array([[500.0, 0, 320], [0, 501, 240], [0, 0, 1]]))
    storage.write("distortion_coefficients", np.zeros((5, 1)))
    storage.release()
    matrix = "{rows: 3, cols: 3, data: [500, 0, 320, 0, 500, 240, 0, 0, 1]}"
    (folder / "ros.yaml").write_text(
        f"image_width: 640\nimage_height: 480\ncamera_matrix: {matrix}\n"
        "distortion_model: plumb_bob\ndistortion_coefficients: {data: [0.1, 0, 0, 0]}\n"
    )
