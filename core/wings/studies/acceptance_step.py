"""Readings of an acceptance check from the clouds of several results: one artefact, a folder for each position."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError, WrongValue
from core.files.results.ply import read_cloud
from core.files.results.scan_file import scan_facts_of
from core.files.step_graph import FILES
from core.inspect.fit.plane_search import find_planes
from core.inspect.fit.round import find_sphere
from core.messages import Command, Message
from core.progress import Progress, silent
from core.scan.surface.cloud import Cloud
from core.scan.surface.normals import with_normals
from core.wings.studies.kinds.acceptance import ProbedSphere, Reading, probed_flatness, probed_sphere

Artefact: TypeAlias = Literal["sphere", "bar", "plane"]
NEARLY = 0.1
"""Spheres are looked for whose radius is that of the artefact to within this share."""


def read_positions(
    folders: Sequence[Path], artefact: Artefact, *, calibrated_mm: float = 0.0, u_mm: float = 0.0,
    diameter_mm: float = 0.0, progress: Progress = silent,
) -> tuple[Reading, ...]:  # fmt: skip
    """Measure an artefact in the cloud of each folder, one a position: a sphere, a ball bar, or a plane.

    Each has the doubts of its scan; of a cloud without a scan.npz nothing is known.

    Parameters
    ----------
    folders
        With a cloud.ply each, and the scan.npz it was measured with: the positions.
    artefact
        What stands there.
    calibrated_mm
        Diameter of the sphere, or distance of the two centres of a bar; nothing for a plane.
    u_mm
        Standard uncertainty of that.
    diameter_mm
        Of the two spheres of a bar, roughly: by it they are found.

    Raises
    ------
    InputError
        If there is no cloud, or nothing of that shape in it, or the scan.npz is damaged.
    """
    found: list[Reading] = []
    for number, folder in enumerate(folders):
        progress("positions", number, len(folders))
        path = folder / FILES["cloud"]
        if not path.is_file():
            raise InputError(
                Message("study.no_result_files", "there is no {files} in it", files=FILES["cloud"]),
                where=folder,
                todo=Message(
                    "advice.measure_first",
                    "measure first{command}",
                    command=Command("trisect run SET --out DIR"),
                ),
            )
        try:
            readings = _readings(read_cloud(path).cloud, folder.name, artefact, calibrated_mm, u_mm, diameter_mm)
        except (InputError, WrongValue) as error:
            raise InputError(
                Message(
                    "study.artefact_not_found", "no {artefact} was found: {why}", artefact=artefact, why=error.what
                ),
                where=path,
            ) from error
        doubts = scan_facts_of(folder / FILES["scan"]).doubts
        found += [replace(reading, doubts=doubts) for reading in readings]
    progress("positions", len(folders), len(folders))
    return tuple(found)


def _readings(
    cloud: Cloud, position: str, artefact: Artefact, calibrated: float, u: float, diameter: float
) -> list[Reading]:
    if artefact == "plane":
        planes = find_planes(cloud, most=1)
        if not planes:
            raise WrongValue(Message("study.no_plane", "the points lie on no plane"))
        return [Reading("flatness", position, probed_flatness(cloud.points[planes[0].region.indices])[0], u=u)]
    cloud = cloud if cloud.normals.any() else with_normals(cloud)
    if artefact == "sphere":
        sphere, _ = _sphere(cloud, calibrated / 2)
        size = Reading("size", position, sphere.diameter, calibrated, u)
        return [Reading("form", position, sphere.form), size]
    first, members = _sphere(cloud, diameter / 2)
    rest = cloud.select(np.setdiff1d(np.arange(len(cloud)), members))
    second, _ = _sphere(rest, diameter / 2)
    spacing = float(np.linalg.norm(first.centre - second.centre))
    return [Reading("spacing", position, spacing, calibrated, u)]


def _sphere(cloud: Cloud, radius: float) -> tuple[ProbedSphere, NDArray[np.int64]]:
    """The sphere of about that radius that explains most points, and which points those are."""
    members = find_sphere(cloud, radius_range_mm=((1 - NEARLY) * radius, (1 + NEARLY) * radius))
    return probed_sphere(cloud.points[members]), members
