"""A master block of a plan: its measurement as numbers, or as a result of an earlier inspection."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from core.errors import InputError
from core.files.plan.tables import MasterTable
from core.inspect.plan.conditions import Master
from core.inspect.uncertainty.causes import cause_named
from core.messages import Message


def master_of(table: MasterTable, path: Path) -> Master:
    """The master that [master] of the plan at `path` describes.

    Raises
    ------
    InputError
        If its result is missing, or has no such characteristic.
    """
    measured, budget = table.measured_mm, tuple((cause_named(row.source), row.u_mm) for row in table.budget)
    if table.result is not None:
        from core.files.results.inspection_file import read_inspection  # the whole of inspecting: only now

        rows = {row.name: row for row in read_inspection(path.parent / table.result).characteristics}
        if table.characteristic not in rows:
            known = ", ".join(rows) or "nothing"
            raise InputError(
                Message(
                    "inspection.no_such_characteristic",
                    "there is no {characteristic!r} in {result}, which holds {known}",
                    characteristic=table.characteristic,
                    result=table.result,
                    known=known,
                ),
                where=f"{path}, master.characteristic",
                todo=Message("advice.name_one_of", "name one of these"),
            )
        row = rows[table.characteristic]
        measured, budget = row.value, tuple((one.source, one.u_mm) for one in row.budget)
    assert measured is not None  # one of the two, says the table
    return Master(
        name=table.name,
        certified_mm=table.certified_mm,
        u_certified_mm=table.u_certified_mm,
        measured_mm=measured,
        budget=budget,
        features=tuple(table.features),
        same_calibration=table.same_calibration,
    )


def master_table(master: Master) -> dict[str, Any]:
    """[master] with the measurement as numbers."""
    return {
        "name": master.name,
        "certified_mm": master.certified_mm,
        "u_certified_mm": master.u_certified_mm,
        "features": list(master.features),
        "measured_mm": master.measured_mm,
        "budget": [{"source": str(source), "u_mm": u} for source, u in master.budget],
        "same_calibration": master.same_calibration,
    }
