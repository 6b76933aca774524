"""Faces of a project's scan, grown from the points that were clicked in the window."""

from __future__ import annotations

from collections.abc import MutableMapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from core.errors import InputError
from core.files.project.folder import results_folder
from core.files.results.ply import read_cloud
from core.files.step_graph import FILES
from core.inspect.faces import PARALLEL, SAME_FACE
from core.inspect.fit.grown_face import KINDS, FaceKind, GrownFace, grow_face
from core.inspect.fit.shapes import ParallelPlanes
from core.inspect.plan.feature_spec import FaceAt
from core.inspect.shown.clicked_faces import ClickedFace, ClickedFaces
from core.messages import Message
from core.model import Pose
from core.pipeline.project.inspect_view import scan_replaced
from core.pipeline.project.inspection import MOST_DRAWN
from core.progress import Progress, silent
from core.scan.surface.cloud import Cloud
from core.scan.surface.normals import with_normals

CLOUD = "cloud"
"""Its name in the memory, with the state of the file it was read from."""


def clicked_faces(
    folder: Path,
    points: Sequence[int],
    kind: str = "",
    pose_camera_part: Pose | None = None,
    progress: Progress = silent,
    memory: MutableMapping[str, Any] | None = None,
) -> ClickedFaces:
    """Find the faces of the scanned part that contain the clicked `points`, indices into the project's cloud.

    Parameters
    ----------
    folder
        The project's.
    points
        Indices of one or two points of the cloud.
    kind
        "plane", "sphere" or "cylinder"; anything else: the simplest of them that the points allow.
    pose_camera_part
        Part coordinates into the camera frame, where there are any.
    progress
        Called with what is being done; may raise Cancelled.
    memory
        Keeps the cloud from one call to the next.

    Raises
    ------
    InputError
        If there is no scan among the results, it is another one, no face goes on from a point, or both lie on one face.
    """
    progress("growing the face", 0, len(points) + 1)
    path = results_folder(folder) / FILES["cloud"]
    cloud = _cloud(path, {} if memory is None else memory)
    if max(points) >= len(cloud):
        raise scan_replaced(path, Message("feature.advice_click_again", "click the face on this scan"))
    grown: list[GrownFace] = []
    asked: FaceKind | None = next((name for name in KINDS if name == kind), None)
    for number, point in enumerate(points, start=1):
        progress("growing the face", number, len(points) + 1)
        grown.append(grow_face(cloud, point, asked))
    order = list(range(len(grown)))
    parallel = len(grown) == 2 and _parallel(grown[0], grown[1])
    if parallel:
        order.sort(key=lambda one: _depth(grown[one], cloud, grown[0]))
    progress("growing the face", len(points) + 1, len(points) + 1)
    faces = tuple(_face(cloud, points[one], grown[one], pose_camera_part) for one in order)
    return ClickedFaces(faces, parallel)


def _cloud(path: Path, memory: MutableMapping[str, Any]) -> Cloud:
    """The scan's points with their normals, read once."""
    state = path.stat() if path.exists() else None
    key = (path, state and (state.st_mtime_ns, state.st_size))
    if memory.get(CLOUD, (None,))[0] != key:
        cloud = read_cloud(path).cloud
        memory[CLOUD] = key, cloud if cloud.normals.any() else with_normals(cloud)
    found: Cloud = memory[CLOUD][1]
    return found


def _parallel(a: GrownFace, b: GrownFace) -> bool:
    """Whether two faces are parallel planes.

    Raises
    ------
    InputError
        If they are one and the same face.
    """
    same = len(np.intersect1d(a.indices, b.indices, assume_unique=True))
    if same > SAME_FACE * min(len(a.indices), len(b.indices)):
        raise InputError(
            Message("feature.one_face_clicked_twice", "both places that were clicked are on one and the same face"),
            todo=Message("feature.advice_click_other_face", "click another face"),
        )
    if not (isinstance(a.shape, ParallelPlanes) and isinstance(b.shape, ParallelPlanes)):
        return False
    return bool(abs(a.shape.outward_normal @ b.shape.outward_normal) > np.cos(PARALLEL))


def _depth(face: GrownFace, cloud: Cloud, of: GrownFace) -> float:
    """How far from the camera a face is, across the face `of`."""
    assert isinstance(of.shape, ParallelPlanes)
    return -float(cloud.points[face.indices].mean(axis=0) @ of.shape.outward_normal)


def _face(cloud: Cloud, point: int, grown: GrownFace, pose_camera_part: Pose | None) -> ClickedFace:
    u, v = (round(float(value), 1) for value in cloud.uv[point])
    seeds = [FaceAt(at_px=(u, v))]
    if pose_camera_part is not None:
        x, y, z = (round(float(value), 3) for value in pose_camera_part.inverse().apply(cloud.points[point][None])[0])
        seeds.insert(0, FaceAt(at_mm=(x, y, z)))
    sample = grown.indices[:: max(1, -(-len(grown.indices) // MOST_DRAWN))]
    return ClickedFace(
        grown.kind, len(grown.indices), grown.rms_mm, cloud.points[sample].astype(np.float32), tuple(seeds)
    )
