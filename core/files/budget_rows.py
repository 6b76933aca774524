"""A row of an uncertainty budget as result files have it."""

from __future__ import annotations

import math
from typing import Any

from pydantic import Field

from core.files.result_file import Finite, ResultFile
from core.inspect.results import Contribution


class BudgetRow(ResultFile):
    """All of a row but its contribution, which each file calls by a key of its own."""

    source: str
    point_mm: Finite | None = None
    distribution: str = "normal"
    dof: Finite | None = Field(default=None, ge=1, description="a number of at least 1, or null for infinitely many")
    value: Finite | None = None
    unit: str = "mm"

    def contributing(self, u: float) -> Contribution:
        """The row, if it contributes `u`."""
        dof = math.inf if self.dof is None else self.dof
        return Contribution(self.source, u, self.point_mm, self.distribution, dof, self.value, self.unit)


def row_tables(row: Contribution, key: str) -> dict[str, Any]:
    """A row as it is written, its contribution under `key`; infinitely many degrees of freedom become null."""
    return {
        "source": row.source,
        key: row.u_mm,
        "point_mm": row.point_mm,
        "distribution": row.distribution,
        "dof": row.dof,
        "value": row.value,
        "unit": row.unit,
        "sensitivity": row.sensitivity,
    }
