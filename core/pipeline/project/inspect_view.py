"""What a window shows of a finished scan, made in one go: called in another process, sent ready to be drawn."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.errors import InputError
from core.files.project.data import Project
from core.files.project.folder import results_folder
from core.files.project.results import ProjectResults
from core.files.results.ply import read_cloud
from core.files.step_graph import FILES
from core.inspect.face_region import inside_polygon, on_face
from core.inspect.results import Face, GaugeResult
from core.inspect.shown.outline import face_outline, outline_px
from core.inspect.shown.relief import relief
from core.inspect.shown.shown_scan import DEPTH, HEIGHT, LOWER, NO_FACE, UPPER, InspectionView, NextPair, ShownMesh
from core.messages import Message, label
from core.model.arrays import Array
from core.pipeline.project.results import load_results
from core.pipeline.project.workspace import project_set
from core.progress import Progress, silent
from core.scan.features.frames import FrameRecord
from core.scan.surface.cloud import Cloud
from core.scan.surface.fused_surface import Mesh

SAMPLE = 2500
"""So many of the points used are shown on the picture."""

_STEP = label("preparing what is shown")


def inspection_view(folder: Path, project: Project, progress: Progress = silent) -> InspectionView:
    """Read the scan among the results of a project for display, with its thickness if one was measured.

    Parameters
    ----------
    folder, project
        The project; of it only the folder of the scan's pictures is used.
    progress
        Called with what is being done; may raise Cancelled.

    Raises
    ------
    InputError
        If there is no scan among the results, or it cannot be read.
    """
    results = load_results(folder, progress)
    cloud, camera = results.cloud, results.camera
    if cloud is None or camera is None or not len(cloud):
        raise InputError(
            Message("project.no_usable_scan", "there is no scan among the results ({why:;})", why=results.problems)
            if results.problems
            else Message("project.no_scan", "there is no scan among the results"),
            where=results_folder(folder),
            todo=Message("advice.scan_part_first", "scan the part first"),
        )
    progress(_STEP, 0, 3)
    order = np.argsort(cloud.sigma, kind="stable")
    gauge = results.gauge
    deviation = _deviation(gauge, len(cloud))[order]
    shown, height = cloud.select(order), _height(gauge, cloud.points)[order]
    progress(_STEP, 1, 3)
    mesh = None if results.mesh is None else _shown_mesh(results.mesh, gauge, cloud)
    progress(_STEP, 2, 3)
    pictures, best = _pictures(folder, project, results.frames)
    view = InspectionView(
        points=shown.points,
        normals=shown.normals.astype(np.float32),
        number=order.astype(np.int32),
        uv=shown.uv.astype(np.float32),
        sigma=shown.sigma.astype(np.float32),
        height=height.astype(np.float32),
        height_is=HEIGHT if gauge is not None else DEPTH,
        deviation=deviation.astype(np.float32),
        face=_face_of(gauge, len(cloud))[order],
        frame=np.where(shown.frame >= 0, shown.frame + 1.0, np.nan).astype(np.float32),
        frames=_names(results),
        ranges=_ranges(shown, height, deviation),
        mesh=mesh,
        gauge=None if gauge is None else _reordered(gauge, order),
        outlines=None if gauge is None else _outlines(gauge, cloud),
        next_pair=None if gauge is None else _next_pair(gauge, cloud),
        used_uv=None if gauge is None else _sample(gauge, cloud),
        relief=relief(camera.camera.image_size, shown.uv, shown.points[:, 2], shown.normals),
        image_size=camera.camera.image_size,
        pictures=pictures,
        shown=best,
        notes=results.notes,
        problems=results.problems,
        calibration_id=results.calibration_id,
    )
    progress(_STEP, 3, 3)
    return view


def outline_selected(folder: Path, numbers: NDArray[np.int32], face: str, progress: Progress = silent) -> Array:
    """Compute the outline (n, 2) in px of the points `numbers` of the cloud or, given `face`, of that plane face.

    Parameters
    ----------
    folder
        The project's.
    numbers
        Which points were chosen.
    face
        "upper" or "lower": which face is to be outlined; "": all of the points, whatever surface they are on.
    progress
        Called with what is being done; may raise Cancelled.

    Raises
    ------
    InputError
        If there is no scan among the results, it is another one, or the points hold no plane face.
    """
    progress("outline", 0, 1)
    path = results_folder(folder) / FILES["cloud"]
    cloud = read_cloud(path).cloud
    if len(numbers) and int(numbers.max()) >= len(cloud):
        raise scan_replaced(path, Message("advice.draw_region_again", "draw the region again"))
    chosen = numbers.astype(np.int64)
    outline = face_outline(cloud, chosen, face) if face else outline_px(cloud.uv[chosen])
    progress("outline", 1, 1)
    return outline


def scan_replaced(path: Path, todo: Message) -> InputError:
    """Make the error that the scan a choice was made on has been replaced by the one in `path`."""
    return InputError(
        Message("project.scan_replaced", "this scan has been replaced by another one"), where=path, todo=todo
    )


def _height(gauge: GaugeResult | None, points: Array) -> Array:
    """(N,) mm over the lower face, or the depth where there is none."""
    return points[:, 2] if gauge is None else -gauge.lower.plane.distances(points)


def _deviation(gauge: GaugeResult | None, count: int) -> Array:
    """(N,) mm from the face a point was used for; NaN for the others."""
    deviation = np.full(count, np.nan)
    for face in _faces(gauge):
        deviation[face.indices] = face.residuals
    return deviation


def _face_of(gauge: GaugeResult | None, count: int) -> NDArray[np.int8]:
    """(N,) which face a point was used for."""
    face = np.full(count, NO_FACE, dtype=np.int8)
    if gauge is not None:
        face[gauge.upper.indices], face[gauge.lower.indices] = UPPER, LOWER
    return face


def _shown_mesh(mesh: Mesh, gauge: GaugeResult | None, cloud: Cloud) -> ShownMesh | None:
    if not len(mesh.triangles):
        return None
    largest = mesh.sigma[mesh.triangles].max(axis=1)
    order = np.argsort(largest, kind="stable")
    deviation = np.full(len(mesh.vertices), np.nan)
    for face in _faces(gauge):
        on = on_face(mesh.vertices, cloud.points[face.indices], face.plane.normal, face.plane.d_mm)
        deviation[on] = -face.plane.distances(mesh.vertices[on])
    return ShownMesh(
        vertices=mesh.vertices,
        sigma=mesh.sigma.astype(np.float32),
        height=_height(gauge, mesh.vertices).astype(np.float32),
        deviation=deviation.astype(np.float32),
        triangles=mesh.triangles[order],
        triangle_sigma=largest[order].astype(np.float32),
    )


def _faces(gauge: GaugeResult | None) -> tuple[Face, ...]:
    return () if gauge is None else (gauge.upper, gauge.lower)


def _reordered(gauge: GaugeResult, order: NDArray[np.int64]) -> GaugeResult:
    """The same thickness, its faces' points by their places in `order`, ascending."""
    place = np.empty(len(order), dtype=np.int64)
    place[order] = np.arange(len(order))

    def moved(face: Face) -> Face:
        places = place[face.indices]
        sort = np.argsort(places)
        return replace(face, indices=places[sort], residuals=face.residuals[sort])

    return replace(gauge, upper=moved(gauge.upper), lower=moved(gauge.lower))


def _outlines(gauge: GaugeResult, cloud: Cloud) -> tuple[Array, Array] | None:
    try:
        return outline_px(cloud.uv[gauge.upper.indices]), outline_px(cloud.uv[gauge.lower.indices])
    except InputError:
        return None  # a thickness of one light profile: lines have no outline


def _next_pair(gauge: GaugeResult, cloud: Cloud) -> NextPair | None:
    """The second of the pairs that could be meant; None without one, or where its outlines are not known."""
    if len(gauge.candidates) < 2:
        return None
    first, second = gauge.candidates[:2]
    own = tuple(np.array(outline) for outline in second.outlines_px if outline and outline not in first.outlines_px)
    return NextPair(second.thickness_mm, own, tuple(_on_surface(cloud, outline) for outline in own)) if own else None


def _on_surface(cloud: Cloud, outline: Array) -> Array:
    """For each corner (n, 2) in pixels of an outline the measured point (n, 3) inside it that is nearest."""
    inside = np.flatnonzero(inside_polygon(cloud.uv, outline))
    _, nearest = cKDTree(cloud.uv[inside]).query(outline)
    return np.asarray(cloud.points[inside[nearest]])


def _sample(gauge: GaugeResult, cloud: Cloud) -> tuple[Array, Array]:
    """Pixels of some of the points used on the upper and on the lower face, as dense on both."""
    step = max(1, -(-sum(gauge.points_used) // SAMPLE))
    upper, lower = gauge.upper.indices[::step], gauge.lower.indices[::step]
    return np.asarray(cloud.uv[upper]), np.asarray(cloud.uv[lower])


def _ranges(cloud: Cloud, height: Array, deviation: Array) -> Mapping[str, tuple[float, float]]:
    """Ends of the colour bars: what nearly all points lie between."""
    low, high = (float(value) for value in np.quantile(height, [0.005, 0.995]))
    known = deviation[np.isfinite(deviation)]
    widest = float(np.quantile(np.abs(known), 0.99)) if len(known) else 1.0
    frames = cloud.frame[cloud.frame >= 0]
    last = float(frames.max()) if len(frames) else 1.0
    return {
        "sigma": (0.0, max(float(np.quantile(cloud.sigma, 0.99)), 1e-6)),
        "height": (low, max(high, low + 1e-6)),
        "deviation": (-max(widest, 1e-6), max(widest, 1e-6)),
        "frame": (1.0, max(last + 1.0, 2.0)),
    }


def _names(results: ProjectResults) -> tuple[str, ...]:
    """Names of the frames by their index."""
    names = {record.index: record.name for record in results.frames}
    return tuple(names.get(index, "") for index in range(max(names, default=-1) + 1))


def _pictures(folder: Path, project: Project, frames: tuple[FrameRecord, ...]) -> tuple[tuple[str, ...], str]:
    """Names of the scan's pictures that are there, and of the frame that shows most."""
    try:
        recording_set = project_set(folder, project)
    except InputError:
        return (), ""  # a scan can be looked at without the pictures it was made from
    reference = () if recording_set.reference is None else (recording_set.reference,)
    names = tuple(recording_set.name_of(path) for path in (*reference, *recording_set.frames))
    used = [frame for frame in frames if frame.used and frame.name in names]
    best = max(used, key=lambda frame: (frame.fan_lines_met, frame.points, -frame.index), default=None)
    return names, best.name if best is not None else (names[0] if names else "")
