"""A calibration target as the fields of a form, and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from core.image.targets import BlackSquare, Charuco, Checkerboard, CircleGrid, Target
from core.image.targets.usual import USUAL, USUAL_MARKER

DICTIONARIES = tuple(f"DICT_{side}X{side}_{count}" for side in (4, 5, 6, 7) for count in (50, 100, 250, 1000))
"""Markers a ChArUco board may have, by OpenCV's names."""

PAPERS = ("A4", "A3", "A2", "Letter", "Tabloid")
"""What a target can be printed on (core.report.target_sheet.PAPER_MM)."""


def values_of(target: Target) -> dict[str, Any]:
    """The fields of a target; what it does not have is not among them."""
    match target:
        case Checkerboard():
            return {
                "kind": "checkerboard",
                "columns": target.columns,
                "rows": target.rows,
                "size_mm": target.square_mm,
            }
        case Charuco():
            return {
                "kind": "charuco",
                "columns": target.columns,
                "rows": target.rows,
                "size_mm": target.square_mm,
                "marker_mm": target.marker_mm,
                "dictionary": target.dictionary_id,
            }
        case CircleGrid():
            return {
                "kind": "circle_grid",
                "columns": target.columns,
                "rows": target.rows,
                "size_mm": target.pitch_mm,
                "asymmetric": target.asymmetric,
            }
        case BlackSquare():
            return {"kind": "black_square", "size_mm": target.side_mm}


def target_of(values: Mapping[str, Any]) -> Target:
    """The target of these fields; ValueError with one sentence if there is none like that."""
    columns, rows, size = int(values.get("columns", 0)), int(values.get("rows", 0)), float(values["size_mm"])
    match values["kind"]:
        case "checkerboard":
            return Checkerboard(columns, rows, size)
        case "charuco":
            return Charuco(columns, rows, size, float(values["marker_mm"]), str(values["dictionary"]))
        case "circle_grid":
            return CircleGrid(columns, rows, size, bool(values["asymmetric"]))
        case "black_square":
            return BlackSquare(size)
    raise ValueError(f"{values['kind']!r} is no kind of target")


def changed_target(target: Target, field: str, value: Any) -> Target:
    """The target with one field changed; another kind comes in its usual sizes. ValueError as `target_of`."""
    values = values_of(target)
    if field != "kind":
        return target_of({**values, field: value})
    if value == values["kind"]:
        return target
    columns, rows, size = USUAL[value]
    usual = {"kind": value, "columns": columns, "rows": rows, "size_mm": size}
    return target_of({**usual, "marker_mm": USUAL_MARKER * size, "dictionary": DICTIONARIES[0], "asymmetric": False})
