"""What is told of calibrations that were kept: when, how good, and which is in use; and what differs between two."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime
from typing import Protocol

from core.calibrate.camera.changes import CameraChanges
from core.messages import Message, decimals_of, label, plain
from core.report.facts.fact import Fact, Grade, Value
from core.report.facts.of_camera import CORNERS, parameter_fact
from core.report.facts.table import Column, FactTable

CHANGE_HEADS = (label("parameter"), label("chosen"), label("shown"), label("change"), label("sd"))
"""Of the rows of `change_cells`, what they are of before them."""
_ACCEPTED, _ID, _STATE = Column(label("accepted")), Column(label("id")), Column(label("state"))


class KeptCalibration(Protocol):
    """Summary of a stored calibration, as `core.files.project.calibration_store.StoredCalibration`."""

    @property
    def id(self) -> str: ...
    @property
    def kept_at(self) -> datetime: ...
    @property
    def used(self) -> int: ...
    @property
    def total(self) -> int: ...
    @property
    def rms_px(self) -> float: ...
    @property
    def rms_mm(self) -> Sequence[float]: ...
    @property
    def camera_id(self) -> str: ...


def stored_cameras(kept: Sequence[KeptCalibration], in_use: str) -> FactTable:
    """Make the table of stored camera calibrations; the one with the id `in_use` is marked ("" for none)."""
    columns = (_ACCEPTED, Column(CORNERS, "px", 3), Column(label("views")), _ID, _STATE)
    return FactTable(columns, tuple((*_about(one, one.rms_px), plain(one.id), _state(one, in_use)) for one in kept))


def stored_planes(kept: Sequence[KeptCalibration], in_use: str) -> FactTable:
    """Make the table of stored light-plane calibrations, each with its camera; the one with id `in_use` is marked."""
    lines = range(max((len(one.rms_mm) for one in kept), default=0))
    of_lines = (Column(Message("told.rms_of_line", "RMS of line {number}", number=n + 1), "mm", 3) for n in lines)
    columns = (_ACCEPTED, *of_lines, Column(label("poses")), _ID, Column(label("camera")), _STATE)
    rows = [
        (
            *_about(one, *(one.rms_mm[n] if n < len(one.rms_mm) else None for n in lines)),
            plain(one.id),
            plain(one.camera_id),
            _state(one, in_use),
        )
        for one in kept
    ]
    return FactTable(columns, tuple(rows))


def change_cells(changes: CameraChanges) -> tuple[tuple[Fact, ...], ...]:
    """Make the table rows that compare two camera calibrations: both values, the change and its standard deviation.

    Of the number of views both values alone.
    """
    rows: list[tuple[Fact, ...]] = [
        tuple(Fact(CORNERS, value, "px", 3) for value in changes.rms_px),
        tuple(Fact(label("views"), value) for value in changes.views),
    ]
    for one in changes.parameters:
        if not (one.first or one.second):
            continue
        shown = replace(parameter_fact(one.name, one.second, one.sd), digits=decimals_of(one.sd), sd=None)
        unlikely: Grade = "warn" if one.unlikely else ""
        change = replace(shown, value=one.change, signed=True, grade=unlikely)
        rows.append((replace(shown, value=one.first), shown, change, replace(shown, value=one.sd)))
    return tuple(rows)


def _about(one: KeptCalibration, *rms: float | None) -> tuple[Value, ...]:
    """When it was kept, how well it fits, and how many of its pictures count."""
    when = Message("told.time", "{at}", at=one.kept_at.astimezone())
    return when, *rms, Message("told.used", "{used:,} of {all:,}", used=one.used, all=one.total)


def _state(one: KeptCalibration, in_use: str) -> Value:
    return label("in use") if one.id == in_use else None
