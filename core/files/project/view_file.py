"""view.json in the folder of a project: how the surface was left in 3D, for a figure of the report."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from core.errors import InputError
from core.files.atomic import remove, write_text
from core.files.complaints import checked
from core.files.json_text import to_json
from core.files.reading import read_json
from core.files.tables import Finite, LengthAbove0, ResultFile, Row3
from core.inspect.shown.seen_from import SeenFrom

NAME = "view.json"
DIGITS = 6
"""Decimals of its numbers: a nanometre, a microradian."""
SQUARE = 1e-3
"""Axes that are less square to each other, or by more of no unit length, are no view."""

_Rows2 = Annotated[list[Row3], Field(min_length=2, max_length=2)]
_Rows3 = Annotated[list[Row3], Field(min_length=3, max_length=3)]


class _ViewFile(ResultFile):
    recording: str
    axes: _Rows3
    focal: Row3
    half_height_mm: LengthAbove0
    aspect: Annotated[Finite, Field(gt=0)]
    hidden: _Rows2 | None = None


def view_text(view: SeenFrom, recording: str) -> str:
    """Write a view of the surface measured from `recording` as the JSON text of its file."""
    return to_json(
        {
            "recording": recording,
            "axes": view.axes.round(DIGITS) + 0.0,
            "focal": view.focal.round(DIGITS) + 0.0,
            "half_height_mm": round(view.half_height_mm, DIGITS),
            "aspect": round(view.aspect, DIGITS),
            "hidden": None if view.hidden is None else view.hidden.round(DIGITS) + 0.0,
        }
    )


def write_view(folder: Path, view: SeenFrom, recording: str) -> None:
    """Write the view of the surface to its file in a project's folder; InputError if it cannot be written.

    `recording` is that of the scan that is seen, as the project names it.
    """
    write_text(folder / NAME, view_text(view, recording), sync=False)  # what is lost with it is one look


def drop_view(folder: Path) -> None:
    """Remove the file of the view from a project's folder; InputError if it cannot be removed."""
    remove(folder / NAME)


def drop_view_of_another(folder: Path, recording: str) -> None:
    """Remove the view from a project's folder unless it is of the scan `recording`; InputError if that fails."""
    file = _read(folder)
    if file is None or file.recording != recording:
        drop_view(folder)


def read_view(folder: Path) -> SeenFrom | None:
    """Read the view of the surface stored in a project's folder; None if there is none that can be shown."""
    file = _read(folder)
    if file is None:
        return None
    axes = np.array(file.axes)
    if np.abs(axes @ axes.T - np.eye(3)).max() > SQUARE or np.linalg.det(axes) < 0:
        return None
    hidden = None if file.hidden is None else np.array(file.hidden)
    return SeenFrom(axes, np.array(file.focal), file.half_height_mm, file.aspect, hidden)


def _read(folder: Path) -> _ViewFile | None:
    path = folder / NAME
    try:
        return checked(_ViewFile, read_json(path), path) if path.exists() else None
    except InputError:
        return None
