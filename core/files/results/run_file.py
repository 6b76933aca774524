"""run.json: how the results beside it came about. The only result that holds times, and so differs from run to run."""

from __future__ import annotations

import contextlib
import math
import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from datetime import datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from pydantic import Field, ValidationError

from core import __version__
from core.errors import InputError
from core.files.atomic import write_text
from core.files.complaints import complaint
from core.files.json_text import read_json, to_json
from core.files.project_tables import Time
from core.files.result_file import Finite, Maybe, ResultFile
from core.scan.results import FrameRecord

LIBRARIES = ("numpy", "scipy", "opencv-python-headless", "numba", "matplotlib", "reportlab")
"""The packages that numbers and pictures come from; their versions are recorded."""

_A_TIME = "a date and time as in 2025-01-31T12:00:00+00:00"


@dataclass(frozen=True, slots=True)
class RunRecord:
    """What is known of a run; each step adds its own part.

    Parameters
    ----------
    set_name, part
        Name of the recording set's folder, and of the part in the report.
    measured_at
        When the last measuring step began, with its time zone.
    settings, notes
        By step: what it was told, and its sentences for the technician.
    timings
        Seconds by step.
    inputs
        SHA-256 in hex of every file read, by its name within the set.
    frames
        What became of every frame.
    made_at
        By measuring step: when it began, as far as that is known. A calibration taken from elsewhere keeps its own.
    """

    set_name: str
    part: str
    measured_at: datetime
    settings: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    notes: Mapping[str, Sequence[str]] = field(default_factory=dict)
    timings: Mapping[str, float] = field(default_factory=dict)
    inputs: Mapping[str, str] = field(default_factory=dict)
    frames: tuple[FrameRecord, ...] = ()
    made_at: Mapping[str, datetime] = field(default_factory=dict)

    def with_step(
        self, step: str, seconds: float, inputs: Mapping[str, str], settings: Mapping[str, Any], notes: Sequence[str]
    ) -> RunRecord:
        """The record after `step`; what an earlier run of the same step said is replaced."""
        return replace(
            self,
            settings={**self.settings, step: settings},
            notes={**self.notes, step: tuple(notes)},
            timings={**self.timings, step: round(seconds, 3)},
            inputs=dict(sorted({**self.inputs, **inputs}.items())),
        )

    @property
    def all_notes(self) -> tuple[str, ...]:
        """The sentences of all steps, in the order the steps were done."""
        return tuple(note for notes in self.notes.values() for note in notes)


class _Frame(ResultFile):
    index: int
    name: str
    used: bool
    reason: str = ""
    stripes: int = 0
    stripe_px: int = 0
    fan_crossings: int = 0
    fan_lines_met: int = 0
    sweep_crossings: int = 0
    left_out: int = 0
    condition: Maybe = None
    points: int = 0
    sigma_mm: Maybe = None
    left_out_reasons: dict[str, int] = Field(default_factory=dict)


class _RunFile(ResultFile):
    set: str
    part: str = ""
    measured_at: str = Field(description=_A_TIME)
    settings: dict[str, dict[str, Any]] = Field(default_factory=dict)
    notes: dict[str, list[str]] = Field(default_factory=dict)
    timings_s: dict[str, Finite] = Field(default_factory=dict)
    inputs: dict[str, str] = Field(default_factory=dict)
    frames: list[_Frame] = Field(default_factory=list)
    made_at: dict[str, Time] = Field(default_factory=dict, description="a table of times")


def write_run(path: Path, record: RunRecord) -> None:
    """Write run.json; InputError if it cannot be written."""
    write_text(
        path,
        to_json(
            {
                "version": __version__,
                "set": record.set_name,
                "part": record.part,
                "measured_at": record.measured_at.isoformat(timespec="seconds"),
                "made_at": {step: at.isoformat(timespec="seconds") for step, at in record.made_at.items()},
                "timings_s": record.timings,
                "settings": record.settings,
                "notes": record.notes,
                "versions": _versions(),
                "frames": [_frame(frame) for frame in record.frames],
                "inputs": record.inputs,
            }
        ),
    )


def read_run(path: Path) -> RunRecord:
    """Read run.json; InputError if it is missing or a field is not what it must be."""
    tables = read_json(path, todo="measure the set first: trisect run SET --out DIR")
    try:
        file = _RunFile.model_validate(tables)
        measured_at = datetime.fromisoformat(file.measured_at)
    except ValidationError as error:
        raise complaint(path, error, _RunFile) from error
    except ValueError as error:
        raise InputError(f"measured_at is {file.measured_at!r}, not {_A_TIME}", where=path) from error
    return RunRecord(
        set_name=file.set,
        part=file.part or file.set,
        measured_at=measured_at,
        settings=file.settings,
        notes=file.notes,
        timings=file.timings_s,
        inputs=file.inputs,
        frames=tuple(_record(frame) for frame in file.frames),
        made_at=file.made_at,
    )


def _versions() -> dict[str, str]:
    """Versions of Python and of LIBRARIES; one may be installed under another name, as OpenCV with windows is."""
    versions = {"python": platform.python_version()}
    for name in LIBRARIES:
        with contextlib.suppress(PackageNotFoundError):
            versions[name] = version(name)
    return versions


def _frame(frame: FrameRecord) -> dict[str, Any]:
    values = {one.name: getattr(frame, one.name) for one in fields(frame)}
    return values | {"left_out_reasons": dict(frame.left_out_reasons)}


def _record(frame: _Frame) -> FrameRecord:
    values = frame.model_dump()
    values["condition"] = math.inf if frame.condition is None else frame.condition
    values["sigma_mm"] = math.nan if frame.sigma_mm is None else frame.sigma_mm
    values["left_out_reasons"] = tuple(frame.left_out_reasons.items())
    return FrameRecord(**values)
