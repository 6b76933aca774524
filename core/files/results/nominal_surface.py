"""Nominal surfaces: STL files in mm, to compare a measured part with."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from core.errors import InputError, words_of
from core.files.stl import read_corners
from core.inspect.plan.inspection_plan import InspectionPlan
from core.messages import Message
from core.scan.surface.triangles import Triangles

_TODO = Message("advice.export_stl_again", "export the part again as STL, in mm")


def read_nominal(path: Path) -> Triangles:
    """The triangles of an STL file, binary or text, those without area left out.

    Raises
    ------
    InputError
        If it is missing, no STL, or holds no usable triangle.
    """
    if not path.is_file():
        raise InputError(
            Message("inspection.nominal_surface_missing", "the nominal surface is missing"),
            where=path,
            todo=Message("advice.name_stl_beside_plan", "name an STL file beside the plan"),
        )
    try:
        corners = read_corners(path)
    except (OSError, ValueError) as problem:
        raise InputError(
            Message(
                "inspection.nominal_unreadable", "it cannot be read as an STL mesh ({reason})", reason=words_of(problem)
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
    return Triangles(corners[area > 0])


def read_nominals(plan: InspectionPlan, folder: Path) -> dict[str, Triangles]:
    """Every nominal surface a plan names, by that name; names are of files in `folder` or whole paths.

    Raises
    ------
    InputError
        If one of them cannot be read as a surface in mm; names the file.
    """
    return {name: read_nominal(folder / name) for name in nominal_names(plan)}


def nominal_names(plan: InspectionPlan) -> list[str]:
    """Every nominal surface a plan names."""
    return sorted({feature.deviation.nominal for feature in plan.features if feature.deviation is not None})
