"""The plan that a rig.toml describes: its usual tables, and [plan]; what is not said is as in the paper's rig."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from core.calibrate.change import Stability
from core.calibrate.drift import NO_DRIFT, USUAL_KELVINS, Air, apart, stability_after
from core.errors import InputError, WrongValue
from core.files.recording.rig import RigTables, TargetTable, known_planes_of, read_rig_tables, stated_part
from core.image.targets import Target
from core.inspect.uncertainty.part import Part
from core.messages import Message
from core.wings.rig_planning.prediction.design import PAPER_PIXEL_UM, Design


def read_design(path: Path) -> Design:
    """Read the design of a planned rig from the rig.toml at `path`, or from the one in the folder `path`.

    Raises
    ------
    InputError
        If it cannot be read, has an unknown key, or a quantity is impossible.
    """
    file = path / "rig.toml" if path.is_dir() else path
    tables = read_rig_tables(file)
    try:
        design = Design(**_quantities(tables, file))
        design.rig()  # what only camera, fan and work together can tell
    except InputError as error:
        raise InputError(error.what, where=f"{file}: {error.where}", todo=error.todo) from error
    return design


def read_stated(path: Path) -> tuple[Part, Stability | None]:
    """Read what a rig.toml, or the one in the folder `path`, states of the part and of the rig's stability.

    That is as far as its temperatures have it, and within the hour: nobody knows when it will be used. InputError as
    `read_design`.
    """
    tables = read_rig_tables(path / "rig.toml" if path.is_dir() else path)
    stated, drift = (
        (None, NO_DRIFT) if tables.stability is None else (tables.stability.stability(), tables.stability.drift())
    )
    air = Air() if tables.air is None else tables.air.air()
    return stated_part(tables), stability_after(stated, drift, apart(air.calibrated, air.scanned, 0.0, USUAL_KELVINS))


def _quantities(tables: RigTables, path: Path) -> dict[str, Any]:
    given: dict[str, Any] = {} if tables.plan is None else tables.plan.model_dump(exclude_none=True)
    if "focal_px" in given:
        given["focal_mm"] = given.pop("focal_px") * given.get("pixel_um", PAPER_PIXEL_UM) * 1e-3
    for name in ("pixels", "block_mm", "heights_mm"):
        if name in given:
            given[name] = tuple(given[name])
    if "heights_mm" not in given and tables.gauge is not None and tables.gauge.nominal_mm is not None:
        given["heights_mm"] = (tables.gauge.nominal_mm,)
    if tables.laser_fan is not None:
        given["lines"] = tables.laser_fan.lines
        if tables.laser_fan.angle_deg is not None:
            given["angle_deg"] = tables.laser_fan.angle_deg
    elif tables.known_planes:
        given["boards"] = tuple(known_planes_of(tables, path).items())
    for name, table in (("camera_target", tables.camera_target), ("plane_target", tables.plane_target)):
        if table is not None:
            given[name] = _target(table, name, path)
    return given


def _target(table: TargetTable, name: str, path: Path) -> Target:
    try:
        return table.target()
    except WrongValue as error:
        raise InputError(
            Message("plan.impossible_target", "{name}: {why}", name=name, why=error.what), where=path
        ) from error
