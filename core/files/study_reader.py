"""Reads study.json back: the same study, made again from what it was made of."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, RootModel, ValidationError

from core.errors import InputError
from core.files.complaints import complaint
from core.files.json_text import read_json
from core.files.result_file import Finite, ResultFile
from core.files.study_file import Study
from core.inspect.results import Contribution
from core.study.acceptance import AcceptanceCheck, Quantity, Reading, acceptance_check
from core.study.budget import UncertaintyBudget, add_up
from core.study.grr import GrrStudy, grr_study
from core.study.repeats import RepeatStudy, repeat_study
from core.study.type1 import Type1Study, type1_study

_TODO = "make the study again: trisect study … --out DIR"


class _Row(ResultFile):
    source: str
    contribution: Finite
    u_input: Finite | None = None
    distribution: str = "normal"
    dof: Finite | None = None
    value: Finite | None = None
    unit: str = "mm"

    def row(self) -> Contribution:
        dof = math.inf if self.dof is None else self.dof
        return Contribution(self.source, self.contribution, self.u_input, self.distribution, dof, self.value, self.unit)


class _Budget(ResultFile):
    rows: list[_Row]
    coverage: Finite
    value: Finite | None = None
    unit: str = "mm"

    def budget(self) -> UncertaintyBudget:
        return add_up([one.row() for one in self.rows], value=self.value, coverage=self.coverage, unit=self.unit)


class _Scan(ResultFile):
    scan: str
    value: Finite
    U: Finite | None = None


class _Decision(ResultFile):
    lower: Finite | None = None
    upper: Finite | None = None
    r: Finite


class _Repeats(ResultFile):
    kind: Literal["repeats"]
    characteristic: str
    unit: str
    scans: list[_Scan]
    nominal: Finite | None = None
    budget_of_mean: _Budget
    budget_is_complete: bool
    decision: _Decision | None = None

    def study(self) -> RepeatStudy:
        asked, limits = self.decision, None
        if asked is not None:
            limits = (
                -math.inf if asked.lower is None else asked.lower,
                math.inf if asked.upper is None else asked.upper,
            )
        return repeat_study(
            [one.value for one in self.scans],
            self.budget_of_mean.budget(),
            complete=self.budget_is_complete,
            name=self.characteristic,
            labels=[one.scan for one in self.scans],
            U=[math.nan if one.U is None else one.U for one in self.scans],
            nominal=self.nominal,
            limits=limits,
            r=1.0 if asked is None else asked.r,
            unit=self.unit,
        )


class _Type1(ResultFile):
    kind: Literal["type1"]
    unit: str
    values: list[Finite]
    reference: Finite
    tolerance_width: Finite
    resolution: Finite | None = None

    def study(self) -> Type1Study:
        return type1_study(
            self.values, self.reference, self.tolerance_width, resolution=self.resolution, unit=self.unit
        )


class _Grr(ResultFile):
    kind: Literal["grr"]
    unit: str
    parts: list[str]
    operators: list[str]
    values: list[list[list[Finite]]]
    tolerance_width: Finite | None = None

    def study(self) -> GrrStudy:
        return grr_study(
            np.array(self.values),
            parts=self.parts,
            operators=self.operators,
            tolerance=self.tolerance_width,
            unit=self.unit,
        )


class _Reading(ResultFile):
    position: str
    measured: Finite
    calibrated: Finite
    u: Finite


class _Quantity(ResultFile):
    quantity: Quantity
    limit: Finite | None = None
    k: Finite
    readings: list[_Reading]


class _Acceptance(ResultFile):
    kind: Literal["acceptance"]
    quantities: list[_Quantity]

    def study(self) -> AcceptanceCheck:
        readings = [
            Reading(one.quantity, row.position, row.measured, row.calibrated, row.u)
            for one in self.quantities
            for row in one.readings
        ]
        limits = {one.quantity: one.limit for one in self.quantities if one.limit is not None}
        return acceptance_check(readings, limits, k=self.quantities[0].k if self.quantities else 2.0)


class _StudyFile(RootModel[Annotated[_Repeats | _Type1 | _Grr | _Acceptance, Field(discriminator="kind")]]):
    pass


def read_study(path: Path) -> Study:
    """Read study.json.

    Raises
    ------
    InputError
        If it is missing, damaged, or no study can be made of what it holds.
    """
    tables = read_json(path, todo=_TODO)
    try:
        return _StudyFile.model_validate(tables).root.study()
    except ValidationError as error:
        raise complaint(path, error, _StudyFile) from error
    except ValueError as error:
        raise InputError(str(error), where=path, todo=_TODO) from error
