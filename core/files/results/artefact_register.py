"""The register of artefacts that rigs are checked by: artefacts.toml in the user's own folder, and beside rig.toml.

An artefact of the same id beside rig.toml counts::

    [[artefact]]
    id = "GB 50-0713"
    value_mm = 50.0003       # at 20 °C
    U_mm = 0.0004            # expanded, with its k
    k = 2.0
    certificate = "D-K-15070 2026-03"
    laboratory = "Physikalisches Labor Nord"
    due = 2028-03-01

    [[artefact]]
    id = "B 25-1"
    kind = "sphere"          # its diameter; "step": its height; "block", a thickness, where nothing is said
    value_mm = 25.0004
    U_mm = 0.0006
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Collection, Iterable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from core.checks.artefact_check import Artefact, ArtefactKind
from core.errors import InputError
from core.files.atomic import make_folder, write_text
from core.files.complaints import checked
from core.files.reading import read_toml
from core.files.recording.rig import Table
from core.files.results.rig_history import own_folder
from core.files.tables import OptionalDay, ShortText
from core.files.toml_text import toml_text
from core.messages import Message

REGISTER = "artefacts.toml"
_HEAD = re.compile(r"^[ \t]*\[\[[ \t]*artefact[ \t]*\]\]", re.MULTILINE)

_Length = Annotated[float, Field(gt=0, le=5000, allow_inf_nan=False, description="a length in mm above 0")]
_MISSING = Message("artefact.no_register", "there is no register of artefacts")


class ArtefactTable(Table):
    """Table of an artefact in a register."""

    id: str = Field(min_length=1, max_length=60, description="a text of at most 60 letters")
    value_mm: _Length
    U_mm: _Length
    k: float = Field(2.0, ge=1, le=10, allow_inf_nan=False, description="a coverage factor from 1 to 10")
    certificate: str = ""
    due: OptionalDay = None
    kind: ArtefactKind = Field("block", description='"block", "sphere" or "step"')
    laboratory: ShortText = ""

    def artefact(self) -> Artefact:
        """Make the artefact that this table describes."""
        return Artefact(**dict(self))


class _Register(Table):
    artefact: list[ArtefactTable] = Field(default_factory=list, description="tables [[artefact]]")


def read_register(beside: Path) -> Mapping[str, Artefact]:
    """Read all known artefacts, by their ids: the user's own, and those in the folder `beside` rig.toml.

    Raises
    ------
    InputError
        If a file is no TOML, or a value is wrong; names the file and the field.
    """
    return {**register_in(own_folder()), **register_in(beside)}


def own_register() -> Mapping[str, Artefact]:
    """Read the user's own artefacts, by their ids; {} without a file, InputError if it is wrong."""
    return register_in(own_folder())


def register_in(folder: Path) -> Mapping[str, Artefact]:
    """Read the artefacts in artefacts.toml in `folder`, by their ids; {} without a file, InputError if it is wrong."""
    path = folder / REGISTER
    return _artefacts(read_toml(path, missing=_MISSING), path) if path.exists() else {}


def register_text(artefacts: Iterable[Artefact]) -> str:
    """Write these artefacts as the text of artefacts.toml."""
    return "\n".join(map(_text, artefacts))


def store_own(artefact: Artefact) -> Mapping[str, Artefact]:
    """Add an artefact to the user's own register, at its end; returns all of them by id.

    Raises
    ------
    InputError
        If one of its id is there already, the register is damaged, or it cannot be written.
    """
    path, known = own_folder() / REGISTER, {**own_register()}
    _refuse_second(artefact, known, path)
    known[artefact.id] = artefact
    before = path.read_text(encoding="utf-8") if path.exists() else ""
    return _written(path, f"{before.rstrip()}\n\n{_text(artefact)}".lstrip(), known)


def change_own(id_: str, to: Artefact | None) -> Mapping[str, Artefact]:
    """Replace the artefact `id_` in the user's own register by `to`, or remove it if that is None; returns all left.

    Raises
    ------
    InputError
        If there is none of this id or already another one like the new one, the register is damaged, or it cannot be
        written.
    """
    path, before = own_folder() / REGISTER, own_register()
    if id_ not in before:
        raise InputError(
            Message("artefact.gone", "there is no artefact {id} any more", id=id_),
            where=path,
            todo=Message("artefact.advice_look_again", "open the registers again"),
        )
    if to is not None:
        _refuse_second(to, before.keys() - {id_}, path)
    changed = {id_: to}
    known = {one.id: one for name, known in before.items() if (one := changed.get(name, known)) is not None}
    text = _with_table(path.read_text(encoding="utf-8"), list(before).index(id_), "" if to is None else _text(to))
    return _written(path, text, known)


def _refuse_second(artefact: Artefact, known: Collection[str], path: Path) -> None:
    """InputError if one of its id is among those known."""
    if artefact.id in known:
        raise InputError(
            Message("artefact.known_already", "there is an artefact {id} already", id=artefact.id),
            where=path,
            todo=Message("artefact.advice_change_it", "change it there"),
        )


def _written(path: Path, text: str, known: Mapping[str, Artefact]) -> Mapping[str, Artefact]:
    """Write a register of those known: `text`, with what stood there by hand, unless that says something else."""
    try:
        same = list(_artefacts(tomllib.loads(text), path).values()) == list(known.values())
    except (tomllib.TOMLDecodeError, InputError):  # all in one line, artefact = [{ … }]: nothing can be put after that
        same = False
    make_folder(path.parent)
    write_text(path, text if same else register_text(known.values()))
    return known


def _artefacts(tables: Mapping[str, Any], path: Path) -> Mapping[str, Artefact]:
    return {row.id: row.artefact() for row in checked(_Register, tables, path).artefact}


def _with_table(text: str, number: int, table: str) -> str:
    """The text of a register with another table in the place of this one; comments before the next stay."""
    starts = [*(found.start() for found in _HEAD.finditer(text)), len(text)]
    if number + 1 >= len(starts):
        return ""
    old = text[starts[number] : starts[number + 1]].splitlines(keepends=True)
    ends = max(n for n, line in enumerate(old) if line.strip() and not line.lstrip().startswith("#"))
    return (text[: starts[number]] + table + "".join(old[ends + 1 :]) + text[starts[number + 1] :]).lstrip()


def _text(artefact: Artefact) -> str:
    """Its table in a register."""
    stated = {key: value for key, value in asdict(artefact).items() if value not in (None, "")}
    if artefact.kind == "block":
        del stated["kind"]
    return toml_text({"artefact": [stated]})


def artefact_named(id_: str, beside: Path) -> Artefact:
    """Find the artefact `id_` among the user's own and those in the folder `beside`; InputError if it is not there."""
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
