"""What pydantic found wrong with a file, said in one sentence that names file, field and what is allowed."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any, TypeVar, get_args, get_type_hints

from pydantic import BaseModel, TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from core.errors import InputError, WrongValue, words_of
from core.messages import Message, label

_Schema = TypeVar("_Schema")
_TYPES = {
    "finite_number": label("a finite number"),
    "float_type": label("a finite number"),
    "int_type": label("a whole number"),
    "string_type": label("a text"),
    "bool_type": label("true or false"),
    "list_type": label("a list"),
    "tuple_type": label("a list"),
    "frozen_set_type": label("a list"),
    "model_type": label("a table"),
    "dataclass_type": label("a table"),
    "dict_type": label("a table"),
}
"""What a field without a description must be, by pydantic's names of errors."""


_UNKNOWN = ("extra_forbidden", "unexpected_keyword_argument")
"""Pydantic's names of unknown keys, of models and of dataclasses."""


class Clash(WrongValue):
    """Error that two keys of one table contradict each other; shown as a complaint about `key`.

    Raise it from a model's validator; `what` continues the sentence that the key begins.
    """

    def __init__(self, key: str, what: Message) -> None:
        super().__init__(what)
        self.key = key


def checked(schema: type[_Schema], tables: object, path: Path) -> _Schema:
    """Check `tables` read from `path` against a model and return it filled; InputError tells the most telling fault.

    The `description` of a field completes "… is <value>, not <description>".
    """
    try:
        return _adapter(schema).validate_python(tables)
    except ValidationError as error:
        raise InputError(_complaint(error, schema), where=path) from error


def checked_json(schema: type[_Schema], tables: object, path: Path) -> _Schema:
    """Check the content of a JSON file against a dataclass or model and return it filled; InputError if it is wrong.

    By the rules of JSON: lists become tuples and sets, and tables dataclasses. A dataclass is its own schema: its
    fields are annotated with what they may hold.
    """
    try:
        return _adapter(schema).validate_json(json.dumps(tables))
    except ValidationError as error:
        raise InputError(_complaint(error, schema), where=path) from error


_ADAPTERS: dict[Any, TypeAdapter[Any]] = {}
"""By schema, each made once: that of a dataclass takes milliseconds."""


def _adapter(schema: type[_Schema]) -> TypeAdapter[_Schema]:
    if schema not in _ADAPTERS:
        _ADAPTERS[schema] = TypeAdapter(schema)
    return _ADAPTERS[schema]


@contextmanager
def fitting(path: Path, *, todo: Message | str = "") -> Iterator[None]:
    """Within the `with` block, turn errors of values that do not fit each other into an InputError about `path`."""
    try:
        yield
    except (ValueError, TypeError, LookupError, OverflowError) as error:
        what = Message("file.values_do_not_fit", "its values do not fit together ({reason})", reason=words_of(error))
        raise InputError(what, where=path, todo=todo) from error


def _complaint(error: ValidationError, schema: Any) -> Message:
    # A misspelt key is unknown under one name and missing under the other: the first says more.
    errors = sorted(error.errors(include_url=False), key=lambda one: one["type"] not in _UNKNOWN)
    first = errors[0]
    names, field, tables = _locate(schema, first["loc"])
    name = ".".join(names)
    if first["type"] in _UNKNOWN:
        return _unknown_key(name, tables)
    wrong = first.get("ctx", {}).get("error")
    if isinstance(wrong, Clash):
        return Message("file.clash", "{field} {what}", field=".".join([*names, wrong.key]), what=wrong.what)
    if isinstance(wrong, WrongValue):
        return Message("file.field_refused", "{field}: {what}", field=name, what=wrong.what) if name else wrong.what
    if first["type"] in ("union_tag_invalid", "union_tag_not_found"):
        kinds = " or ".join(f'"{kind}"' for kind in _kinds(tables))
        given = first.get("ctx", {}).get("tag")
        if given is None:
            return Message("file.kind_missing", "{field}.kind is missing, not {kinds}", field=name, kinds=kinds)
        return Message(
            "file.kind_unknown", '{field}.kind is "{given}", not {kinds}', field=name, given=given, kinds=kinds
        )
    described = field.description if field is not None and field.description else None
    wanted = label(described) if described else _TYPES.get(first["type"], first["msg"])
    if first["type"] == "missing" and not described:
        return Message("file.field_is_missing", "{field} is missing", field=name)
    if first["type"] == "missing":
        return Message("file.field_missing", "{field} is missing; it must be {wanted}", field=name, wanted=wanted)
    whole = ".".join([*names[:-1], names[-1].partition("[")[0]]) if names else ""
    given = _shown(first["input"])
    if whole == name:
        return Message("file.field_wrong", "{field} is {given}, not {wanted}", field=name, given=given, wanted=wanted)
    return Message(
        "file.item_wrong", "{field} is {given}, but {whole} must be {wanted}",
        field=name, given=given, whole=whole, wanted=wanted,
    )  # fmt: skip


def _locate(schema: Any, loc: tuple[int | str, ...]) -> tuple[list[str], FieldInfo | None, list[Any]]:
    """Names along `loc`, the innermost field, and the models that hold the innermost name (or may stand there)."""
    names: list[str] = []
    field: FieldInfo | None = None
    tables = list(_models(schema))
    for part in loc:
        if isinstance(part, int):
            names[-1] += f"[{part}]"
            continue
        tagged = [table for table in tables if part in _kinds([table])]
        if tagged and len(names) == len(loc[: loc.index(part)]):
            tables = tagged
            continue
        names.append(part)
        found = [known[part] for known in map(_fields, tables) if part in known]
        if found:
            field = found[0]
            inner = list(_models(field.annotation))
            tables = inner or tables
    return names, field, tables


def _fields(table: Any) -> Mapping[str, FieldInfo]:
    """The fields of a model or a dataclass."""
    if issubclass(table, BaseModel):
        known: Mapping[str, FieldInfo] = table.model_fields
        return known
    hints = get_type_hints(table, include_extras=True)
    return {one.name: FieldInfo.from_annotation(hints[one.name]) for one in fields(table)}


def _models(annotation: Any) -> Iterator[Any]:
    """The models and dataclasses within an annotation: unions, lists and Annotated opened up."""
    if isinstance(annotation, type) and (issubclass(annotation, BaseModel) or is_dataclass(annotation)):
        yield annotation
    for argument in get_args(annotation):
        yield from _models(argument)


def _kinds(tables: list[Any]) -> list[str]:
    """The values of `kind` by which `tables` are told apart."""
    found = [known["kind"] for known in map(_fields, tables) if "kind" in known]
    return [kind for field in found for kind in get_args(field.annotation)]


def _unknown_key(name: str, tables: list[Any]) -> Message:
    known = [key for table in tables for key in _fields(table)]
    near = get_close_matches(name.rpartition(".")[2], known, n=1, cutoff=0.6)
    if near:
        return Message(
            "file.misspelt_key", "{field} is an unknown key (did you mean {near}?)", field=name, near=near[0]
        )
    return Message(
        "file.unknown_key", "{field} is an unknown key (known here are {known})", field=name, known=tuple(known)
    )


def _shown(value: object) -> str:
    """A value as the file has it, cut short."""
    try:
        text = json.dumps(value, ensure_ascii=False, default=str)
    except (TypeError, ValueError):
        text = str(value)
    return text if len(text) <= 60 else text[:57] + "…"
