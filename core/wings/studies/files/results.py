"""One characteristic of a folder of results, as a study takes it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from pathlib import Path

from core.errors import InputError
from core.files.results.folder_results import read_results
from core.findings.proof import Doubts
from core.inspect.characteristic import Characteristic
from core.inspect.conformity import Limits
from core.inspect.results import Contribution
from core.messages import Command, Message


@dataclass(frozen=True, eq=False, slots=True)
class Measured:
    """Measured characteristic of one scan.

    Parameters
    ----------
    value, u
        With its standard uncertainty, in `unit`: "mm", or "deg" for an angle.
    k
        Coverage factor.
    budget
        What u is made of.
    limits
        What was asked of it, in `unit`; None for nothing.
    doubts
        By what facts it proves nothing.
    """

    value: float
    u: float
    k: float
    budget: tuple[Contribution, ...]
    unit: str
    limits: Limits | None = None
    doubts: Doubts = field(kw_only=True)


def measured_in(folder: Path, name: str) -> Measured:
    """Read the characteristic `name` of a folder of results, from gauge.json (the thickness) or inspection.json.

    Raises
    ------
    InputError
        If there are no results, or none of that name, or its value or uncertainty is not known.
    """
    found = _find(folder, name)
    if not math.isfinite(found.value) or not math.isfinite(found.u):
        raise InputError(Message("study.unknown_quantity", "the {name} is not known", name=name), where=folder)
    if found.quantity == "length":
        return Measured(found.value, found.u, found.k, found.budget, "mm", found.limits, doubts=found.doubts)
    degree = math.degrees(1.0)
    rows = tuple(replace(row, u_mm=row.u_mm * degree) for row in found.budget)
    asked = found.limits
    limits = None if asked is None else Limits(asked.nominal * degree, asked.lower * degree, asked.upper * degree)
    return Measured(found.value * degree, found.u * degree, found.k, rows, "deg", limits, doubts=found.doubts)


def _find(folder: Path, name: str) -> Characteristic:
    if not folder.is_dir():
        raise InputError(Message("study.no_such_folder", "there is no such folder of results"), where=folder)
    known = read_results(folder).rows
    found = [one for one in known if one.name == name]
    if not found:
        names = tuple(one.name for one in known)
        raise InputError(
            Message("study.no_such_result", 'no result is called "{name}"; there are {names}', name=name, names=names)
            if names
            else Message("study.no_results_at_all", 'no result is called "{name}"', name=name),
            where=folder,
            todo=Message("advice.another_characteristic", "choose another --characteristic")
            if names
            else Message(
                "advice.measure_first", "measure first{command}", command=Command("trisect run SET --out DIR")
            ),
        )
    return found[0]
