"""rig.toml: the targets, the laser and the gauge of a recording set, read and written."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from core.acquire.grey import Channel
from core.calibrate.board_shape import BoardTolerance
from core.errors import InputError
from core.files.complaints import complaint
from core.files.rig_tables import GaugeTable, PlannedRigTables, RigTables, TargetTable
from core.files.toml_text import toml_text
from core.image.targets import BlackSquare, Charuco, Checkerboard, CircleGrid, Target
from core.model.arrays import Array, frozen_array, set_field


@dataclass(frozen=True, eq=False, slots=True)
class GaugeSpec:
    """What is to be measured: nominal value and tolerance in mm, faces as (N, 2) polygons in pixels."""

    nominal_mm: float | None = None
    tolerance_mm: float | None = None
    upper_polygon_px: Array | None = None
    lower_polygon_px: Array | None = None

    def __post_init__(self) -> None:
        for name in ("upper_polygon_px", "lower_polygon_px"):
            polygon = getattr(self, name)
            if polygon is not None:
                set_field(self, name, frozen_array(polygon, (None, 2), name))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, GaugeSpec):
            return NotImplemented
        return self._values() == other._values()

    def __hash__(self) -> int:
        return hash(self._values())

    def _values(self) -> tuple[object, ...]:
        polygons = (self.upper_polygon_px, self.lower_polygon_px)
        corners = [None if polygon is None else tuple(map(tuple, polygon.tolist())) for polygon in polygons]
        return self.nominal_mm, self.tolerance_mm, *corners


@dataclass(frozen=True, slots=True)
class Rig:
    """What rig.toml says. `angle` between neighbouring lines is in rad (0 with one line).

    `camera_board` and `plane_board` say how true the two targets are.
    """

    camera_target: Target
    plane_target: Target
    lines: int
    angle: float
    gauge: GaugeSpec | None = None
    channel: Channel | None = None
    camera_board: BoardTolerance = field(default_factory=BoardTolerance)
    plane_board: BoardTolerance = field(default_factory=BoardTolerance)


def default_rig() -> Rig:
    """The rig of the paper: its checkerboard, its black square, three laser lines 5° apart; nothing to be measured."""
    return Rig(Checkerboard(17, 12, 10.0), BlackSquare(60.0), lines=3, angle=math.radians(5.0))


def read_rig(path: Path) -> Rig:
    """Read and check rig.toml.

    Raises
    ------
    InputError
        If it is missing, is no TOML, has an unknown key, lacks one, or a value has the wrong type or is absurd.
        The sentence names the file, the field and what is allowed.
    """
    tables = _toml(path)
    try:
        rig = RigTables.model_validate(tables)
    except ValidationError as error:
        raise complaint(path, error, RigTables) from error
    return rig_of(rig, path)


def read_planned_rig(path: Path) -> PlannedRigTables:
    """Read and check the rig.toml of a rig that is only planned; its tables as they are, those not there None.

    Raises
    ------
    InputError
        As `read_rig`, but no table need be there.
    """
    try:
        return PlannedRigTables.model_validate(_toml(path))
    except ValidationError as error:
        raise complaint(path, error, PlannedRigTables) from error


def _toml(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise InputError(
            "the file is missing; it says what the targets and the laser are",
            where=path,
            todo="write one as the README shows",
        ) from error
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"cannot be read as UTF-8 text ({error})", where=path) from error
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"this is no valid TOML: {error}", where=path) from error


def rig_of(tables: RigTables, path: Path, within: str = "") -> Rig:
    """The rig that checked `tables` describe; `path`, and the field `within` it, are for complaints."""
    angle = math.radians(tables.laser_fan.angle_deg or 0.0)
    return Rig(
        _target(path, f"{within}camera_target", tables.camera_target),
        _target(path, f"{within}plane_target", tables.plane_target),
        tables.laser_fan.lines,
        angle,
        _gauge(tables.gauge) if tables.gauge else None,
        tables.channel,
        _tolerance(tables.camera_target),
        _tolerance(tables.plane_target),
    )


def rig_tables(rig: Rig) -> dict[str, Any]:
    """The tables of `rig` as rig.toml has them, without those that are not there; `RigTables` checks them."""
    tables = {
        "channel": rig.channel,
        "camera_target": _target_table(rig.camera_target) | _tolerance_table(rig.camera_board),
        "plane_target": _target_table(rig.plane_target) | _tolerance_table(rig.plane_board),
        "laser_fan": _present({"lines": rig.lines, "angle_deg": _in_degrees(rig.angle) if rig.angle else None}),
        "gauge": None if rig.gauge is None else _gauge_table(rig.gauge),
    }
    return _present(tables)


def rig_to_toml(rig: Rig) -> str:
    """The text of a rig.toml that :func:`read_rig` reads as the same rig."""
    return toml_text(rig_tables(rig))


def _target(path: Path, name: str, table: TargetTable) -> Target:
    try:
        return table.target()
    except ValueError as error:  # what only the target itself can judge, as a dictionary of markers
        raise InputError(f"{name}: {error}", where=path) from error


def _tolerance(table: TargetTable) -> BoardTolerance:
    return BoardTolerance(table.flatness_mm, table.scale_sd)


def _tolerance_table(tolerance: BoardTolerance) -> dict[str, Any]:
    return _present({"flatness_mm": tolerance.flatness_mm, "scale_sd": tolerance.scale_sd or None})


def _target_table(target: Target) -> dict[str, Any]:
    if isinstance(target, Checkerboard):
        return {
            "kind": "checkerboard",
            "inner_corners": [target.columns, target.rows],
            "square_mm": float(target.square_mm),
        }
    if isinstance(target, Charuco):
        return {
            "kind": "charuco",
            "squares": [target.columns, target.rows],
            "square_mm": float(target.square_mm),
            "marker_mm": float(target.marker_mm),
            "dictionary": target.dictionary_id,
        }
    if isinstance(target, CircleGrid):
        return {
            "kind": "circle_grid",
            "circles": [target.columns, target.rows],
            "pitch_mm": float(target.pitch_mm),
            "asymmetric": target.asymmetric,
        }
    return {"kind": "black_square", "side_mm": float(target.side_mm)}


def _gauge(table: GaugeTable) -> GaugeSpec:
    def array(polygon: list[list[float]] | None) -> Array | None:
        return None if polygon is None else np.array(polygon, dtype=np.float64)

    upper, lower = array(table.upper_polygon_px), array(table.lower_polygon_px)
    return GaugeSpec(table.nominal_mm, table.tolerance_mm, upper, lower)


def _gauge_table(gauge: GaugeSpec) -> dict[str, Any]:
    polygons = {"upper_polygon_px": gauge.upper_polygon_px, "lower_polygon_px": gauge.lower_polygon_px}
    return _present(
        {
            "nominal_mm": gauge.nominal_mm,
            "tolerance_mm": gauge.tolerance_mm,
            **{name: None if polygon is None else polygon.tolist() for name, polygon in polygons.items()},
        }
    )


def _present(table: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in table.items() if value is not None}


def _in_degrees(angle: float) -> float:
    """The shortest number of degrees that is `angle` in rad to the last bit, if there is one."""
    degrees = math.degrees(angle)
    near = (degrees, math.nextafter(degrees, 0), math.nextafter(degrees, math.inf))
    exact = [
        value for value in (*(round(degrees, digits) for digits in range(16)), *near) if math.radians(value) == angle
    ]
    return exact[0] if exact else degrees
