"""shown.npz beside inspection.json: what a window draws of an inspection, so that it need not be measured again for it.

The rows themselves stand in inspection.json alone; shown.npz knows by its hash which one it was written with.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from core.errors import InputError
from core.files.arrays_file import (
    Arrays,
    Member,
    check_parts,
    pack_texts,
    read_arrays,
    real,
    texts,
    whole,
    write_arrays,
)
from core.files.complaints import checked_json, fitting
from core.files.json_text import to_json
from core.files.reading import file_hash, json_of, read_json
from core.files.results.inspection_file import read_inspection
from core.files.tables import Finite, ResultFile, Row3
from core.inspect.characteristic import Characteristic
from core.inspect.shown.deviation_map import bounds, mark
from core.inspect.shown.shown_features import ShownClass, ShownDeviations, ShownFeature, ShownInspection, ShownProfile
from core.messages import as_text, from_text, plain
from core.model import Pose


class _Feature(ResultFile):
    """What is kept of a feature beside its arrays; `rows` is how many of inspection.json's are its own."""

    name: str
    kind: str
    used: Annotated[int, Field(ge=0)]
    problem: str
    rows: Annotated[int, Field(ge=0)]
    profile: bool
    tolerance_mm: Annotated[Finite | None, Field(gt=0)]


class _Pose(ResultFile):
    """Where the part's coordinates are in the camera's."""

    rotation: Annotated[tuple[Row3, ...], Field(min_length=3, max_length=3)]
    translation: Row3


class _About(ResultFile):
    """What is kept beside the arrays; `of` is the hash of the inspection.json it was written with."""

    features: tuple[_Feature, ...]
    of: str
    pose_camera_part: _Pose | None = None


NAME = "shown.npz"
"""Among the results of a scan."""
_PROFILE = ("position", "height", "mean_position", "mean_height", "mean_piece")
_MEMBERS = {
    "about": texts(1),
    "places_*": real(None, 3),
    "uv_*": real(None, 2),
    **{f"{name}_*": real(None) for name in _PROFILE[:-1]},
    **{f"{name}_*": whole(None) for name in (_PROFILE[-1], "classes", "drawn")},
    "shares_*": real(None),
    "deviating_*": real(None, 3),
    "nominal_*": real(None, 3, 3),
    "edges_*": real(None),
    "counts_*": Member("if", (None,)),
}


def write_shown(inspection: Path, shown: ShownInspection) -> None:
    """Write what is drawn of an inspection on its scan beside its file `inspection`; InputError if that fails."""
    arrays: dict[str, NDArray[Any]] = {}
    features = []
    for number, one in enumerate(shown.features):
        arrays |= {f"places_{number}": one.places, f"uv_{number}": one.uv}
        if one.profile is not None:
            arrays |= {f"{name}_{number}": getattr(one.profile, name) for name in _PROFILE}
        if one.deviations is not None:
            arrays |= _deviation_arrays(number, one.deviations)
        about = {
            "name": one.name,
            "kind": one.kind,
            "used": one.used,
            "problem": as_text(one.problem),
            "rows": len(one.rows),
        }
        tolerance = None if one.deviations is None else one.deviations.tolerance_mm
        features.append(about | {"profile": one.profile is not None, "tolerance_mm": tolerance})
    about = {"features": features, "of": file_hash(inspection)}
    if (pose := shown.pose_camera_part) is not None:
        about["pose_camera_part"] = {"rotation": pose.rotation, "translation": pose.translation}
    write_arrays(inspection.with_name(NAME), {**arrays, "about": pack_texts([to_json(about)])})


def read_shown(inspection: Path, plan: Mapping[str, Any]) -> ShownInspection | None:
    """Read what is drawn of an inspection on its scan, beside the file `inspection`; None if not of this `plan`.

    `plan` is what is to be shown, by the keys of plan.toml.

    Raises
    ------
    InputError
        If inspection.json is damaged.
    """
    path = inspection.with_name(NAME)
    if not path.exists() or not inspection.exists():
        return None
    if read_json(inspection).get("plan") != json.loads(to_json(plan)):
        return None
    try:
        arrays = read_arrays(path, _MEMBERS, todo=plain(""))
        with fitting(path):
            about = checked_json(_About, json_of(arrays["about"][0], path), path)
            return _shown(about, arrays, inspection) if about.of == file_hash(inspection) else None
    except InputError:
        return None  # damaged: what is drawn is made anew


def _shown(about: _About, arrays: Arrays, inspection: Path) -> ShownInspection:
    file = read_inspection(inspection)
    rows, features = list(file.characteristics), []
    for number, one in enumerate(about.features):
        mine: tuple[Characteristic, ...] = tuple(rows[: one.rows])
        del rows[: one.rows]
        features.append(
            ShownFeature(
                name=one.name,
                kind=one.kind,
                rows=mine,
                used=one.used,
                places=arrays[f"places_{number}"],
                uv=arrays[f"uv_{number}"],
                problem=from_text(one.problem),
                profile=ShownProfile(*(arrays[f"{name}_{number}"] for name in _PROFILE)) if one.profile else None,
                deviations=None if one.tolerance_mm is None else _deviations(number, one.tolerance_mm, arrays),
            )
        )
    pose = about.pose_camera_part
    return ShownInspection(
        tuple(features),
        file.unmeasured,
        file.notes,
        file.calibration_id,
        None if pose is None else Pose(np.array(pose.rotation), np.array(pose.translation)),
    )


def _deviation_arrays(number: int, found: ShownDeviations) -> dict[str, NDArray[Any]]:
    """Classes one after the other: their numbers, shares and how many places are drawn of each."""
    return {
        f"classes_{number}": np.array([one.number for one in found.classes]),
        f"shares_{number}": np.array([one.share for one in found.classes]),
        f"drawn_{number}": np.array([len(one.places) for one in found.classes]),
        f"deviating_{number}": np.concatenate([one.places for one in found.classes]),
        f"edges_{number}": found.edges,
        f"counts_{number}": found.counts,
        f"nominal_{number}": found.nominal,
    }


def _deviations(number: int, tolerance_mm: float, arrays: Arrays) -> ShownDeviations:
    check_parts(arrays[f"drawn_{number}"], len(arrays[f"deviating_{number}"]))
    ends = np.cumsum(arrays[f"drawn_{number}"])[:-1]
    places = np.split(arrays[f"deviating_{number}"], ends)
    numbers, shares = arrays[f"classes_{number}"].tolist(), arrays[f"shares_{number}"].tolist()
    classes = tuple(
        ShownClass(mark(one), one, *bounds(one, tolerance_mm), share, mine)
        for one, share, mine in zip(numbers, shares, places, strict=True)
    )
    edges, counts, nominal = (arrays[f"{name}_{number}"] for name in ("edges", "counts", "nominal"))
    return ShownDeviations(classes, edges, counts, tolerance_mm, nominal)
