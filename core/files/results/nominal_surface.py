"""Nominal surfaces, to compare a measured part with: STEP files of CAD, and STL files in mm."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from core.errors import InputError, words_of
from core.files import cad_part, stl
from core.inspect.plan.inspection_plan import InspectionPlan
from core.messages import Message
from core.progress import Progress, silent
from core.scan.surface.triangles import Triangles

CHORD_SHARE = 0.1
"""Of the tolerance: how far the triangles made of a CAD part's curved faces may be off them."""

_TODO = Message("advice.export_nominal_again", "export the part again, as STEP or as STL in mm")


def read_nominal(path: Path, tolerance_mm: float, progress: Progress = silent) -> Triangles:
    """Read a nominal surface, the triangles of a STEP or STL file in mm; triangles without area are left out.

    Parameters
    ----------
    tolerance_mm
        What deviations from the surface are judged by.
    progress
        May raise Cancelled.

    Raises
    ------
    InputError
        If it is missing, cannot be read, or holds no usable triangle; if STEP needs an extra that is not installed.
    """
    if not path.is_file():
        raise InputError(
            Message("inspection.nominal_surface_missing", "the nominal surface is missing"),
            where=path,
            todo=Message("advice.name_nominal_beside_plan", "name a STEP or STL file beside the plan"),
        )
    chord_mm = CHORD_SHARE * tolerance_mm if path.suffix.lower() in cad_part.SUFFIXES else 0.0
    try:
        corners = cad_part.read_corners(path, chord_mm, progress) if chord_mm else stl.read_corners(path)
    except (OSError, ValueError) as problem:
        raise InputError(
            Message(
                "inspection.nominal_unreadable", "no surface can be read from it ({reason})", reason=words_of(problem)
            ),
            where=path,
            todo=_TODO,
        ) from problem
    if not len(corners) or not np.isfinite(corners).all():
        raise InputError(
            Message("inspection.nominal_without_triangle", "it holds no usable triangle"), where=path, todo=_TODO
        )
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    if not (area > 0).any():
        raise InputError(
            Message("inspection.nominal_without_area", "all of its triangles are without area"),
            where=path,
            todo=_TODO,
        )
    return Triangles(corners[area > 0], chord_mm)


def read_nominals(plan: InspectionPlan, folder: Path, progress: Progress = silent) -> dict[str, Triangles]:
    """Read each nominal surface that a plan names, a file in `folder` or full path; InputError if one is wrong.

    A surface that several features name is as fine as the smallest of their tolerances wants it.

    Raises
    ------
    InputError
        If one of them cannot be read as a surface; names the file.
    """
    finest: dict[str, float] = {}
    for feature in plan.features:
        if (asked := feature.deviation) is not None:
            finest[asked.nominal] = min(asked.tolerance_mm, finest.get(asked.nominal, np.inf))
    return {name: read_nominal(folder / name, finest[name], progress) for name in sorted(finest)}


def nominal_names(plan: InspectionPlan) -> list[str]:
    """List the file names of the nominal surfaces in a plan, each once."""
    return sorted({feature.deviation.nominal for feature in plan.features if feature.deviation is not None})
