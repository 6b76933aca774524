"""Comparison step: a scan and another surface of the part → comparison.json, .ply and .csv."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.errors import InputError
from core.files.atomic import make_folder, remove
from core.files.project.folder import is_project, results_in
from core.files.results.geometry_file import read_part_frame
from core.files.step_graph import FILES
from core.inspect.fit.plane_search import above_table, search_tolerance
from core.inspect.plan.alignment import best_fit
from core.messages import Message
from core.model import Pose
from core.pipeline.steps.inspect_step import InspectedScan, open_scan
from core.progress import Progress, silent
from core.scan.surface.cloud import Cloud
from core.scan.surface.triangles import ProximityQuery, Triangles
from core.wings.geometry.comparison.compare import Comparison, ComparisonScales, SurfacePoints, compare, sampled_surface
from core.wings.geometry.comparison.comparison_file import (
    ComparisonFile,
    write_comparison,
    write_comparison_csv,
    write_comparison_ply,
)
from core.wings.geometry.comparison.shown import ALIGNED, AUTOMATIC, Alignment
from core.wings.geometry.comparison.surface_file import OtherSurface, read_surface

ALIGNMENTS = (AUTOMATIC, *ALIGNED)
USUAL = ComparisonScales()
"""Scales where none are given."""
SAMPLED_MM = 0.5
"""Spacing of places on triangles: finer than stripes lie beside each other."""
LEAST_PART = 0.05
"""Of the points lie above the table, or there is none."""


@dataclass(frozen=True, eq=False, slots=True)
class Compared:
    """Comparison of a scan with another surface, in full and in summary, and with its points (M, 3) as aligned."""

    comparison: Comparison
    summary: ComparisonFile
    other: SurfacePoints


@dataclass(frozen=True, eq=False, slots=True)
class _Other:
    """The other surface: points or triangles in its own frame, and what is known of it where it is a scan of ours."""

    surface: OtherSurface
    name: str
    scan: InspectedScan | None = None
    frame: Pose | None = None


def compare_surfaces(
    source: Path, other: Path, align: str, scales: ComparisonScales, progress: Progress = silent
) -> Compared:
    """Compare a scan with another surface, point by point, after aligning them by `align`.

    Parameters
    ----------
    source
        The scan: a folder of results, a project's, or a cloud.ply.
    other
        The surface it is compared with, as it was before or should be: the same, or a PLY, STL, STEP or E57 file in mm.
    align
        One of ALIGNMENTS. The part coordinates of a file are its own.
    scales
        How it is compared.
    progress
        Called with how far it is; may raise Cancelled.

    Raises
    ------
    InputError
        If one of them cannot be read, they cannot be aligned so, or have nothing in common.
    """
    scan, frame = _scan(source)
    against = _other(other)
    cloud = scan.cloud
    if not cloud.normals.any():
        from core.scan.surface.normals import with_normals

        cloud = with_normals(cloud, progress=progress)
    how, part = _chosen(align, frame, against), np.arange(len(cloud))
    if how == "best fit":
        if against.scan is not None or against.surface.triangles is not None:
            part = _of_part(cloud, progress)  # points of a file may be of the table as well: both are taken whole
        pose = _fitted(scan, cloud, part, against, progress)
    elif how == "frame":
        pose = _by_frames(frame, against, source)
    else:
        pose = Pose.identity()
    ours = SurfacePoints.of_cloud(cloud).select(part)
    theirs = against.surface.points
    if against.surface.triangles is not None:
        theirs = sampled_surface(against.surface.triangles, SAMPLED_MM)
    same = against.scan is not None and scan.calibration_id == against.scan.calibration_id != ""
    if how != "as measured" or same:
        ours, theirs = ours.without_common(), theirs.without_common()
    theirs = theirs.moved(pose)
    comparison = compare(ours, theirs, scales, progress)
    return Compared(comparison, ComparisonFile.of(comparison, against.name, how, scan.calibration_id), theirs)


def compare_step(
    source: Path,
    other: Path,
    align: str = AUTOMATIC,
    scales: ComparisonScales = USUAL,
    to: Path | None = None,
    progress: Progress = silent,
) -> tuple[Compared, dict[str, Path]]:
    """Compare a scan with the surface in `other`; write that into `to` (None: among the results of `source`).

    Returns the comparison and its files by their keys.

    Raises
    ------
    InputError
        As `compare_surfaces`, or if nothing can be written.
    """
    made = compare_surfaces(source, other, align, scales, progress)
    folder = to or results_in(source)
    if folder.is_file():
        folder = folder.parent
    paths = {name: make_folder(folder) / FILES[name] for name in ("comparison", "compared", "comparison_table")}
    remove(paths["comparison"])  # it never tells of other points than those beside it
    write_comparison_ply(paths["compared"], made.comparison, made.summary.other)
    write_comparison_csv(paths["comparison_table"], made.comparison)
    write_comparison(paths["comparison"], made.summary)
    return made, paths


def _scan(path: Path) -> tuple[InspectedScan, Pose | None]:
    """A scan of ours, and its part coordinates into the camera frame, where it has any."""
    scan = open_scan(results_in(path))
    return scan, None if scan.folder is None else read_part_frame(scan.folder / FILES["inspection"])


def _other(path: Path) -> _Other:
    if path.is_dir() or is_project(path) or path.name == FILES["cloud"]:
        scan, frame = _scan(path)
        return _Other(OtherSurface(SurfacePoints.of_cloud(scan.cloud)), path.resolve().name, scan, frame)
    return _Other(read_surface(path), path.name)


def _chosen(align: str, frame: Pose | None, other: _Other) -> Alignment:
    if align == AUTOMATIC:
        return "frame" if frame is not None and other.frame is not None else "as measured"
    for known in ALIGNED:
        if align == known:
            return known
    raise InputError(
        Message("comparison.no_such_alignment", 'there is no alignment "{name}"', name=align),
        where="--align",
        todo=Message("advice.choose_among", "choose among {choices}", choices=ALIGNMENTS),
    )


def _by_frames(frame: Pose | None, other: _Other, source: Path) -> Pose:
    theirs = other.frame if other.scan is not None else Pose.identity()
    for one, where in ((frame, str(source)), (theirs, other.name)):
        if one is None:
            raise InputError(
                Message("comparison.no_part_coordinates", "it has no part coordinates to align it by"),
                where=where,
                todo=Message(
                    "comparison.advice_inspect", "inspect it with a plan that has a frame, or align by best fit"
                ),
            )
    assert frame is not None and theirs is not None
    return frame @ theirs.inverse()


def _of_part(cloud: Cloud, progress: Progress = silent) -> NDArray[np.int64]:
    """Which points are of the part, not of the table it stands on: all where there is none."""
    above = above_table(cloud, search_tolerance(cloud), 0, progress)
    return above if len(above) >= LEAST_PART * len(cloud) else np.arange(len(cloud))


def _fitted(scan: InspectedScan, cloud: Cloud, part: NDArray[np.int64], other: _Other, progress: Progress) -> Pose:
    """The other surface's frame into the scan's, by best fit of the part alone."""
    up = np.array([0.0, 0.0, -1.0])
    if other.surface.triangles is not None:
        query = ProximityQuery(other.surface.triangles)
        return best_fit(cloud.points[part], up, query, progress, near=Pose.identity()).pose_camera_nominal
    if scan.mesh is None or not len(scan.mesh.triangles):
        raise InputError(
            Message("comparison.no_mesh", "without its mesh a scan cannot be laid on other points"),
            todo=Message("comparison.advice_folder", "name the folder of its results, not the cloud alone"),
        )
    points = other.surface.points.points
    if other.scan is not None:
        points = points[_of_part(other.scan.cloud, progress)]
    of_part = np.isin(cKDTree(cloud.points).query(scan.mesh.vertices)[1], part)
    triangles = scan.mesh.triangles[of_part[scan.mesh.triangles].all(axis=1)]
    query = ProximityQuery(Triangles(scan.mesh.vertices[triangles]))
    return best_fit(points, up, query, progress, near=Pose.identity()).pose_camera_nominal.inverse()
