"""inspection.json: every characteristic with uncertainty, budget and verdict; inspection.npz beside it: points used."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from core import __version__
from core.errors import InputError
from core.files.arrays_file import read_arrays, real, whole, write_arrays
from core.files.atomic import remove, write_text
from core.files.complaints import checked
from core.files.json_text import to_json
from core.files.reading import read_json
from core.files.tables import BudgetRow, Finite, KeptMessage, OptionalMessage, ResultFile, kept, row_tables
from core.findings.proof import doubts_named, notes_beside
from core.inspect.characteristic import Characteristic
from core.inspect.conformity import Limits
from core.inspect.evaluate import Inspection
from core.inspect.features.measured import FeatureResult
from core.inspect.plan.control_frame import ControlFrame, control_frames, datum_letters
from core.inspect.plan.feature_kind import ToleranceSymbol
from core.inspect.results import Contribution
from core.messages import Command, Message
from core.model.arrays import Array

SCHEMA = 1
"""Version of the file's layout."""
MEMBERS = {
    "points_*": whole(None),
    "residuals_*": real(None),
    "profile_*": real(None, 2),
    "deviation_*": real(None, 4),
}
"""What inspection.npz holds of each feature: indices in the cloud, residuals in mm, and of some a profile (position and
height) or a comparison with a nominal surface (place and deviation)."""
AGAIN = Message(
    "advice.inspect_scan_first",
    "inspect the scan first{command}",
    command=Command("trisect inspect SET --plan plan.toml --out DIR"),
)


@dataclass(frozen=True, eq=False, slots=True)
class InspectionFile:
    """Content of inspection.json of an inspection.

    Parameters
    ----------
    characteristics
        As they were measured.
    kinds
        Kind of the feature each comes from, by the feature's name.
    problems, notes
        Why features were not measured, and what else is to be known.
    points
        Indices of the points of the cloud that each feature used, by its name.
    features
        By a characteristic's name, the feature it comes from.
    sections
        By a feature's name, its profile: (M, 2) position along it and height, in mm.
    control_frames
        By a characteristic's name, what is asked of it after ISO 1101.
    datums
        By a feature's name, its letter as a datum.
    calibration_id
        Of the scan.
    unmeasured
        Whether a feature with limits could not be measured, or one without a result may have had limits.
    """

    characteristics: tuple[Characteristic, ...]
    kinds: dict[str, str]
    problems: tuple[Message, ...]
    notes: tuple[Message, ...]
    points: dict[str, NDArray[np.int64]]
    features: dict[str, str]
    sections: dict[str, Array]
    control_frames: dict[str, ControlFrame]
    datums: dict[str, str]
    calibration_id: str
    unmeasured: bool


class _Limits(ResultFile):
    nominal: Finite
    lower: Finite | None = None
    upper: Finite | None = None


class _ControlFrame(ResultFile):
    symbol: ToleranceSymbol
    zone_mm: Finite
    round: str = ""
    datums: list[str] = Field(default_factory=list)


class _Contribution(BudgetRow):
    u: Finite = Field(ge=0, description="a number not below 0")

    def row(self) -> Contribution:
        return self.contributing(self.u)


class _Characteristic(ResultFile):
    name: str
    feature: str
    kind: str
    value: Finite = Field(description="a finite number")
    u: Finite = Field(ge=0, description="a number not below 0")
    k: Finite = Field(gt=0, description="a number above 0")
    quantity: Literal["length", "angle"] = "length"
    limits: _Limits | None = None
    control_frame: _ControlFrame | None = None
    complete: bool = False
    doubts: list[str] = Field(default_factory=list)
    at_20: bool | None = None
    rule: OptionalMessage = None
    notes: list[KeptMessage] = Field(default_factory=list)
    budget: list[_Contribution] = Field(default_factory=list)


class _Feature(ResultFile):
    name: str
    kind: str
    problem: OptionalMessage = None
    asked: bool = True
    """Whether it has limits."""


class _InspectionFile(ResultFile):
    schema_version: Literal[1] = Field(description="1: this file is of another version of Trisect")
    characteristics: list[_Characteristic] = Field(description="a list of characteristics")
    features: list[_Feature] = Field(default_factory=list)
    datums: dict[str, str] = Field(default_factory=dict)
    notes: list[KeptMessage] = Field(default_factory=list)
    calibration_id: str = ""


def inspection_values(inspection: Inspection) -> dict[str, Any]:
    """Make the table of an inspection's results, without points, by the names of inspection.json."""
    pose, frames = inspection.pose_camera_part, control_frames(inspection.plan)
    return {
        "schema_version": SCHEMA,
        "verdict": inspection.verdict,
        "characteristics": [
            _row(row, result.spec.name, frames.get(row.name))
            for result in inspection.results
            for row in result.characteristics
        ],
        "datums": datum_letters(inspection.plan),
        "features": [_feature(result) for result in inspection.results],
        "pose_camera_part": None if pose is None else {"rotation": pose.rotation, "translation_mm": pose.translation},
        "notes": [kept(note) for note in inspection.notes],
    }


def write_inspection(
    path: Path, inspection: Inspection, calibration_id: str = "", plan: Mapping[str, Any] | None = None
) -> None:
    """Write an inspection to `path`, inspection.json, and inspection.npz beside it; InputError if it fails.

    `plan` is what was asked, by the keys of plan.toml.
    """
    arrays: dict[str, NDArray[Any]] = {}
    for number, result in enumerate(inspection.results):
        arrays[f"points_{number}"] = result.indices
        arrays[f"residuals_{number}"] = result.residuals
        if result.profile is not None:
            arrays[f"profile_{number}"] = np.column_stack([result.profile.position, result.profile.height])
        if result.deviations is not None:
            arrays[f"deviation_{number}"] = np.column_stack([result.deviations.points, result.deviations.deviation])
    remove(path)  # two files: better none than one of each inspection
    write_arrays(path.with_suffix(".npz"), arrays)
    values = inspection_values(inspection) | {"plan": plan, "calibration_id": calibration_id, "version": __version__}
    write_text(path, to_json(values))


def read_inspection(path: Path) -> InspectionFile:
    """Read an inspection from inspection.json, points from inspection.npz if there; InputError if missing or wrong.

    Raises
    ------
    InputError
        If it is missing, damaged or a value is absurd; names it.
    """
    tables = read_json(path, todo=AGAIN)
    file = checked(_InspectionFile, tables, path)
    members = path.with_suffix(".npz")
    arrays = read_arrays(members, MEMBERS, todo=AGAIN) if members.exists() else {}
    points = {
        feature.name: np.asarray(arrays[f"points_{number}"], dtype=np.int64)
        for number, feature in enumerate(file.features)
        if f"points_{number}" in arrays
    }
    sections = {
        feature.name: arrays[f"profile_{number}"]
        for number, feature in enumerate(file.features)
        if f"profile_{number}" in arrays
    }
    return InspectionFile(
        characteristics=tuple(_characteristic(row, path) for row in file.characteristics),
        kinds={feature.name: feature.kind for feature in file.features},
        problems=tuple(feature.problem for feature in file.features if feature.problem),
        notes=tuple(file.notes),
        points=points,
        features={row.name: row.feature for row in file.characteristics},
        sections=sections,
        control_frames={
            row.name: ControlFrame(one.symbol, one.zone_mm, one.round, tuple(one.datums))
            for row in file.characteristics
            if (one := row.control_frame) is not None
        },
        datums=file.datums,
        calibration_id=file.calibration_id,
        unmeasured=any(feature.problem and feature.asked for feature in file.features),
    )


def _row(row: Characteristic, feature: str, frame: ControlFrame | None) -> dict[str, Any]:
    limits = row.limits
    return {
        "name": row.name,
        "feature": feature,
        "kind": row.kind,
        "quantity": row.quantity,
        "value": row.value,
        "u": row.u,
        "U": row.U,
        "k": row.k,
        "limits": None
        if limits is None
        else {"nominal": limits.nominal, "lower": limits.lower, "upper": limits.upper},  # infinite: null
        "control_frame": None if frame is None else asdict(frame),
        "deviation": row.deviation,
        "verdict": row.verdict,
        "complete": not row.doubts,
        "doubts": [doubt.fact for doubt in row.doubts],
        "at_20": row.at_20,
        "rule": kept(row.rule),
        "notes": [kept(note) for note in row.notes],
        "budget": [row_tables(one, "u") for one in row.budget],
    }


def _feature(result: FeatureResult) -> dict[str, Any]:
    return {
        "name": result.spec.name,
        "kind": result.spec.kind,
        "problem": kept(result.problem),
        "asked": bool(result.spec.limits),
        "points": len(result.indices),
        "rms_mm": float(np.sqrt(np.mean(result.residuals**2))) if len(result.residuals) else None,
        "shape": None if result.shape is None else result.shape.values(),
        **_section(result),
    }


def _section(result: FeatureResult) -> dict[str, Any]:
    """Where the profile of a section lies, in the camera frame; nothing of others."""
    profile, asked = result.profile, result.spec.section
    if profile is None or asked is None:
        return {}
    place = {"origin_mm": profile.origin, "along": profile.along, "up": profile.up, "step_mm": asked.step_mm}
    return {"section": place}


def _characteristic(row: _Characteristic, path: Path) -> Characteristic:
    limits = None
    if row.limits is not None:
        lower = -math.inf if row.limits.lower is None else row.limits.lower
        upper = math.inf if row.limits.upper is None else row.limits.upper
        if lower > upper:
            raise InputError(
                Message("inspection.limits_out_of_order", "the limits of {name} are not in order", name=row.name),
                where=path,
                todo=AGAIN,
            )
        limits = Limits(row.limits.nominal, lower, upper)
    doubts = doubts_named(row.doubts, complete=row.complete)
    return Characteristic(
        name=row.name,
        kind=row.kind,
        value=row.value,
        u=row.u,
        quantity=row.quantity,
        k=row.k,
        limits=limits,
        budget=tuple(one.row() for one in row.budget),
        rule=row.rule,
        notes=notes_beside(doubts, row.notes),
        at_20=row.at_20,
        doubts=doubts,
    )
