"""Tables as the text of a TOML file, which Python reads (tomllib) and does not write."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from datetime import date
from typing import Any


def toml_text(tables: Mapping[str, Any]) -> str:
    """Write tables as TOML text: single values first, then tables, then lists of tables.

    What is inside a table stands on one line each; a table of nothing but tables has a block for each of them. Values
    are strings, numbers, truth values, days, and lists and mappings of these; TypeError for others.
    """
    single = [(key, value) for key, value in tables.items() if not _is_table(value) and not _are_tables(value)]
    blocks = [_lines(single)] if single else []
    for key, value in tables.items():
        if _is_table(value):
            within = value and all(map(_is_table, value.values()))
            inner = (
                {f"{_key(key)}.{_key(name)}": table for name, table in value.items()} if within else {_key(key): value}
            )
            blocks += [[f"[{name}]", *_lines(table.items())] for name, table in inner.items()]
    for key, value in tables.items():
        if _are_tables(value):
            blocks += [[f"[[{_key(key)}]]", *_lines(table.items())] for table in value]
    return "\n\n".join("\n".join(block) for block in blocks) + "\n"


def _is_table(value: Any) -> bool:
    return isinstance(value, Mapping)


def _are_tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(item, Mapping) for item in value)


def _lines(pairs: Iterable[tuple[str, Any]]) -> list[str]:
    return [f"{_key(key)} = {_value(value)}" for key, value in pairs]


def _value(value: Any) -> str:
    """A value on one line."""
    if isinstance(value, Mapping):
        return f"{{ {', '.join(_lines(value.items()))} }}" if value else "{}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_value(item) for item in value) + "]"
    if isinstance(value, date):
        return value.isoformat()
    return json.dumps(value, ensure_ascii=False)


def _key(key: str) -> str:
    bare = key.replace("_", "").replace("-", "")
    return key if bare.isascii() and bare.isalnum() else json.dumps(key, ensure_ascii=False)
