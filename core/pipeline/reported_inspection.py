"""What a report says of an inspection and of studies, from the files among the results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from core.errors import InputError
from core.files.arrays_file import read_arrays
from core.files.inspection_file import NAME, InspectionFile, read_inspection
from core.files.json_text import read_json
from core.files.study_file import NAME as STUDY
from core.files.study_file import study_values
from core.files.study_reader import read_study
from core.inspect.feature_spec import Deviation
from core.model import Camera
from core.report.content import Deviations, ReportContent

_AGAIN = "inspect the scan again: trisect inspect SET --plan plan.toml --out DIR"


def with_inspection(content: ReportContent, out: Path) -> ReportContent:
    """The content with every characteristic of inspection.json in `out`, if there is one.

    Raises
    ------
    InputError
        If it is damaged, or of another scan than the one reported.
    """
    path = out / NAME
    if not path.exists():
        return content
    file = read_inspection(path)
    calibration = "-".join(mark.id for mark in content.calibrations)
    if file.calibration_id and file.calibration_id != calibration:
        raise InputError(
            f"is of a scan with calibration {file.calibration_id}, but this one has {calibration}",
            where=path,
            todo=_AGAIN,
        )
    beyond = [name for name, indices in file.points.items() if len(indices) and indices.max() >= len(content.cloud)]
    if beyond:
        raise InputError(f"{beyond[0]} names points that the cloud does not have", where=path, todo=_AGAIN)
    return replace(
        content,
        inspected=file.characteristics,
        points={name: indices for name, indices in file.points.items() if len(indices)},
        deviations=_deviations(path, file, content.camera.camera),
        notes=tuple(dict.fromkeys((*content.notes, *file.notes, *file.problems))),
    )


def with_studies(content: ReportContent, paths: Sequence[Path]) -> ReportContent:
    """The content with the studies in `paths`, each a study.json or its folder; InputError if one cannot be read."""
    read = tuple(study_values(read_study(path / STUDY if path.is_dir() else path)) for path in paths)
    return replace(content, studies=(*content.studies, *read)) if read else content


def _deviations(path: Path, file: InspectionFile, camera: Camera) -> tuple[Deviations, ...]:
    """The comparisons with nominal surfaces, as the camera sees them."""
    arrays_path = path.with_suffix(".npz")
    compared = [(number, name) for number, (name, kind) in enumerate(file.kinds.items()) if kind == "deviation"]
    if not compared or not arrays_path.exists():
        return ()
    arrays, plan = read_arrays(arrays_path, (), todo=_AGAIN), read_json(path).get("plan")
    shown = []
    for number, name in compared:
        table = arrays.get(f"deviation_{number}", np.zeros((0, 4)))
        if len(table):
            uv = camera.project(table[:, :3])
            shown.append(Deviations(name, uv, table[:, 3], _tolerance(plan, name)))
    return tuple(shown)


def _tolerance(plan: Any, name: str) -> float:
    """The tolerance a plan states for the comparison of this name, or the usual one."""
    features: Sequence[Any] = plan.get("feature", ()) if isinstance(plan, Mapping) else ()
    for one in features:
        if isinstance(one, Mapping) and one.get("name") == name and "deviation" in one:
            return float(one["deviation"]["tolerance_mm"])
    return Deviation("").tolerance_mm
