"""The register of artefacts that rigs are checked by: artefacts.toml in the user's own folder, and beside rig.toml.

An artefact of the same id beside rig.toml counts::

    [[artefact]]
    id = "GB 50-0713"
    value_mm = 50.0003       # at 20 °C
    U_mm = 0.0004            # expanded, with its k
    k = 2.0
    certificate = "D-K-15070 2026-03"
    due = 2028-03-01
"""

from __future__ import annotations

from collections.abc import Mapping
from datetime import date
from pathlib import Path
from typing import Annotated

from pydantic import Field

from core.errors import InputError
from core.files.complaints import checked
from core.files.reading import read_toml
from core.files.recording.rig import Table
from core.files.results.rig_history import own_folder
from core.messages import Message
from core.study.artefact_check import Artefact

REGISTER = "artefacts.toml"

_Length = Annotated[float, Field(gt=0, le=5000, allow_inf_nan=False, description="a length in mm above 0")]
_MISSING = Message("artefact.no_register", "there is no register of artefacts")


class _Artefact(Table):
    id: str = Field(min_length=1, max_length=60, description="a text of at most 60 letters")
    value_mm: _Length
    U_mm: _Length
    k: float = Field(2.0, ge=1, le=10, allow_inf_nan=False, description="a coverage factor from 1 to 10")
    certificate: str = ""
    due: date | None = Field(None, description="a date, as 2028-03-01")


class _Register(Table):
    artefact: list[_Artefact] = Field(default_factory=list, description="tables [[artefact]]")


def read_register(beside: Path) -> Mapping[str, Artefact]:
    """The artefacts that are known by their ids: the user's own, and those in the folder `beside` rig.toml.

    Raises
    ------
    InputError
        If a file is no TOML, or a value is wrong; names the file and the field.
    """
    known: dict[str, Artefact] = {}
    for path in (own_folder() / REGISTER, beside / REGISTER):
        if path.exists():
            file = checked(_Register, read_toml(path, missing=_MISSING), path)
            known |= {row.id: Artefact(**dict(row)) for row in file.artefact}
    return known


def artefact_named(id_: str, beside: Path) -> Artefact:
    """The artefact of this id; InputError if the registers do not have it, or as `read_register`."""
    known = read_register(beside)
    if id_ not in known:
        raise InputError(
            Message(
                "artefact.unknown",
                "there is no artefact {id} in {register}, which has {known}",
                id=id_,
                register=REGISTER,
                known=tuple(known) or ("nothing",),
            ),
            where=beside / REGISTER,
            todo=Message("artefact.advice_register", "write it there, or into {own}", own=own_folder() / REGISTER),
        )
    return known[id_]
