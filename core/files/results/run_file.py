"""run.json: how the results beside it came about. The only result that holds times, and so differs from run to run."""

from __future__ import annotations

import contextlib
import math
import platform
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from datetime import datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, TypeVar

from pydantic import Field

from core import __version__
from core.files.complaints import checked
from core.files.json_text import write_json
from core.files.reading import read_json
from core.files.tables import Finite, KeptMessage, OptionalMessage, OrInfinite, OrNan, ResultFile, Time, kept
from core.findings.table import gravest_first
from core.messages import Command, Message, plain
from core.processor import IMPORTED_BEFORE
from core.scan.features.frames import CrossingUse, FrameRecord

T = TypeVar("T")

LIBRARIES = ("numpy", "scipy", "opencv-python-headless", "numba", "matplotlib", "reportlab")
"""The packages that numbers and pictures come from; their versions are recorded."""

_USES = {use.name.lower(): use for use in CrossingUse} | {str(use.message): use for use in CrossingUse}
"""By the names that files hold; older ones hold the English texts."""


@dataclass(frozen=True, slots=True)
class RunRecord:
    """Record of a run; each step adds its own part.

    Parameters
    ----------
    set_name, part
        Name of the recording set's folder, and of the part in the report.
    measured_at
        When the last measuring step began, with its time zone.
    settings, notes
        By step: what it was told, and what it tells the technician.
    timings
        Seconds by step.
    inputs
        SHA-256 in hex of every file read, by its name within the set.
    frames
        What became of every frame.
    made_at
        By measuring step: when it began, as far as that is known. A calibration taken from elsewhere keeps its own.
    simulated
        Whether the scan's pictures are rendered by a program; None: not known.
    """

    set_name: str
    part: str
    measured_at: datetime
    settings: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    notes: Mapping[str, Sequence[Message]] = field(default_factory=dict)
    timings: Mapping[str, float] = field(default_factory=dict)
    inputs: Mapping[str, str] = field(default_factory=dict)
    frames: tuple[FrameRecord, ...] = ()
    made_at: Mapping[str, datetime] = field(default_factory=dict)
    simulated: bool | None = None

    def with_step(
        self,
        step: str,
        seconds: float,
        inputs: Mapping[str, str],
        settings: Mapping[str, Any],
        notes: Sequence[Message | str],
    ) -> RunRecord:
        """Record a run of `step`: its time in s, inputs, settings and notes, in place of an earlier run's."""
        return replace(
            self,
            settings={**self.settings, step: settings},
            notes={**self.notes, step: tuple(note if isinstance(note, Message) else plain(note) for note in notes)},
            timings={**self.timings, step: round(seconds, 3)},
            inputs=dict(sorted({**self.inputs, **inputs}.items())),
        )

    def without(self, steps: Collection[str]) -> RunRecord:
        """Remove what is recorded of these steps; the hashes of the files they read are kept."""

        def left(told: Mapping[str, T]) -> dict[str, T]:
            return {step: one for step, one in told.items() if step not in steps}

        return replace(
            self,
            settings=left(self.settings),
            notes=left(self.notes),
            timings=left(self.timings),
            made_at=left(self.made_at),
            frames=() if {"scan", "profile"} & {*steps} else self.frames,
        )

    @property
    def all_notes(self) -> tuple[Message, ...]:
        """Notes of all steps, each once, the gravest first; those of one weight in the order of the steps."""
        return gravest_first(note for notes in self.notes.values() for note in notes)


class _Frame(ResultFile):
    index: int
    name: str
    used: bool
    reason: OptionalMessage = None
    stripes: int = 0
    stripe_px: int = 0
    fan_crossings: int = 0
    fan_lines_met: int = 0
    sweep_crossings: int = 0
    left_out: int = 0
    condition: OrInfinite = math.inf
    points: int = 0
    sigma_mm: OrNan = math.nan
    left_out_reasons: dict[str, int] = Field(default_factory=dict)
    second_bounces: int = 0


class _RunFile(ResultFile):
    set: str
    part: str = ""
    measured_at: Time
    settings: dict[str, dict[str, Any]] = Field(default_factory=dict)
    notes: dict[str, list[KeptMessage]] = Field(default_factory=dict)
    timings_s: dict[str, Finite] = Field(default_factory=dict)
    inputs: dict[str, str] = Field(default_factory=dict)
    frames: list[_Frame] = Field(default_factory=list)
    made_at: dict[str, Time] = Field(default_factory=dict, description="a table of times")
    simulated: bool | None = None


def write_run(path: Path, record: RunRecord) -> None:
    """Write the record of how results were made as run.json; InputError if it cannot be written."""
    write_json(
        path,
        {
            "version": __version__,
            "set": record.set_name,
            "part": record.part,
            **({} if record.simulated is None else {"simulated": record.simulated}),
            "measured_at": record.measured_at.isoformat(timespec="seconds"),
            "made_at": {step: at.isoformat(timespec="seconds") for step, at in record.made_at.items()},
            "timings_s": record.timings,
            "settings": record.settings,
            "notes": {step: [kept(note) for note in notes] for step, notes in record.notes.items()},
            "versions": _versions(),
            "imported_before": list(IMPORTED_BEFORE),
            "frames": [_frame(frame) for frame in record.frames],
            "inputs": record.inputs,
        },
    )


def read_run(path: Path) -> RunRecord:
    """Read the record of how results were made from run.json; InputError if it is missing or wrong."""
    tables = read_json(
        path,
        todo=Message(
            "advice.measure_set_first", "measure the set first{command}", command=Command("trisect run SET --out DIR")
        ),
    )
    file = checked(_RunFile, tables, path)
    return RunRecord(
        set_name=file.set,
        part=file.part or file.set,
        measured_at=file.measured_at,
        settings=file.settings,
        notes={step: tuple(notes) for step, notes in file.notes.items()},
        timings=file.timings_s,
        inputs=file.inputs,
        frames=tuple(_record(frame) for frame in file.frames),
        made_at=file.made_at,
        simulated=file.simulated,
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
    reasons = {use.name.lower(): count for use, count in frame.left_out_reasons}
    return values | {"reason": kept(frame.reason), "left_out_reasons": reasons}


def _record(frame: _Frame) -> FrameRecord:
    reasons = [(_USES.get(name), count) for name, count in frame.left_out_reasons.items()]
    known = tuple((use, count) for use, count in reasons if use is not None)
    return FrameRecord(**{**dict(frame), "left_out_reasons": known})
