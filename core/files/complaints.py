"""What pydantic found wrong with a file, said in one sentence that names file, field and what is allowed."""

from __future__ import annotations

import json
from collections.abc import Iterator
from difflib import get_close_matches
from pathlib import Path
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from core.errors import InputError

_TYPES = {
    "finite_number": "a finite number",
    "float_type": "a finite number",
    "int_type": "a whole number",
    "string_type": "a text",
    "bool_type": "true or false",
    "list_type": "a list",
    "model_type": "a table",
    "dict_type": "a table",
}
"""What a field without a description must be, by pydantic's names of errors."""


class Clash(ValueError):
    """Two keys of one table that contradict each other; told as a complaint about `key`.

    Raise it from a model's validator; `what` continues the sentence that the key begins.
    """

    def __init__(self, key: str, what: str) -> None:
        self.key = key
        self.what = what
        super().__init__(what)


def complaint(path: Path, error: ValidationError, model: type[BaseModel]) -> InputError:
    """The sentence for the most telling of the errors found when `model` was read from `path`.

    The `description` of a field completes "… is <value>, not <description>".
    """
    # A misspelt key is unknown under one name and missing under the other: the first says more.
    errors = sorted(error.errors(include_url=False), key=lambda one: one["type"] != "extra_forbidden")
    first = errors[0]
    names, field, tables = _locate(model, first["loc"])
    name = ".".join(names)
    if first["type"] == "extra_forbidden":
        return InputError(_unknown_key(name, tables), where=path)
    clash = first.get("ctx", {}).get("error")
    if isinstance(clash, Clash):
        return InputError(f"{'.'.join([*names, clash.key])} {clash.what}", where=path)
    if first["type"] in ("union_tag_invalid", "union_tag_not_found"):
        kinds = " or ".join(f'"{kind}"' for kind in _kinds(tables))
        given = first.get("ctx", {}).get("tag")
        found = "is missing" if given is None else f'is "{given}"'
        return InputError(f"{name}.kind {found}, not {kinds}", where=path)
    wanted = field.description if field is not None and field.description else _TYPES.get(first["type"], first["msg"])
    if first["type"] == "missing":
        return InputError(f"{name} is missing; it must be {wanted}", where=path)
    whole = ".".join([*names[:-1], names[-1].partition("[")[0]]) if names else ""
    allowed = f"not {wanted}" if whole == name else f"but {whole} must be {wanted}"
    return InputError(f"{name} is {_shown(first['input'])}, {allowed}", where=path)


def _locate(model: type[BaseModel], loc: tuple[int | str, ...]) -> tuple[list[str], FieldInfo | None, list[Any]]:
    """Names along `loc`, the innermost field, and the models that hold the innermost name (or may stand there)."""
    names: list[str] = []
    field: FieldInfo | None = None
    tables: list[Any] = [model]
    for part in loc:
        if isinstance(part, int):
            names[-1] += f"[{part}]"
            continue
        tagged = [table for table in tables if part in _kinds([table])]
        if tagged and len(names) == len(loc[: loc.index(part)]):
            tables = tagged
            continue
        names.append(part)
        fields = [table.model_fields[part] for table in tables if part in table.model_fields]
        if fields:
            field = fields[0]
            inner = list(_models(field.annotation))
            tables = inner or tables
    return names, field, tables


def _models(annotation: Any) -> Iterator[type[BaseModel]]:
    """The models within an annotation: unions, lists and Annotated opened up."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for argument in get_args(annotation):
        yield from _models(argument)


def _kinds(tables: list[Any]) -> list[str]:
    """The values of `kind` by which `tables` are told apart."""
    fields = [table.model_fields["kind"] for table in tables if "kind" in table.model_fields]
    return [kind for field in fields for kind in get_args(field.annotation)]


def _unknown_key(name: str, tables: list[Any]) -> str:
    known = [key for table in tables for key in table.model_fields]
    near = get_close_matches(name.rpartition(".")[2], known, n=1, cutoff=0.6)
    hint = f"did you mean {near[0]}?" if near else "known here are " + ", ".join(known)
    return f"{name} is an unknown key ({hint})"


def _shown(value: object) -> str:
    """A value as the file has it, cut short."""
    try:
        text = json.dumps(value, ensure_ascii=False, default=str)
    except (TypeError, ValueError):
        text = str(value)
    return text if len(text) <= 60 else text[:57] + "…"
