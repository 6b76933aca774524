"""JSON that a person can read: tables indented, rows of numbers on one line, no NaN, the same bytes every time."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from core.files.atomic import write_text

WIDTH = 110
"""Lists of lists or tables longer than this many characters are broken into lines, one item each."""


def to_json(value: object) -> str:
    """Write `value` as JSON text. Arrays become lists; NaN and infinity, which JSON does not have, become null."""
    return _text(_plain(value), 0) + "\n"


def write_json(path: Path, value: object) -> None:
    """Write `value` as a JSON file, whole or not at all; InputError if it cannot be written."""
    write_text(path, to_json(value))


def rounded(values: ArrayLike, digits: int) -> Any:
    """Round numbers to `digits` decimals, as nested lists, for bulky arrays that only plots and tables use."""
    return (np.round(np.asarray(values, dtype=np.float64), digits) + 0.0).tolist()


def _plain(value: object) -> Any:
    """Python's own types only."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value


def _text(value: Any, depth: int) -> str:
    inside, outside = " " * (2 * depth + 2), " " * (2 * depth)
    if isinstance(value, dict) and value:
        rows = [f"{inside}{_flat(key)}: {_text(item, depth + 1)}" for key, item in value.items()]
        return "{\n" + ",\n".join(rows) + "\n" + outside + "}"
    flat = _flat(value)
    if isinstance(value, list) and len(flat) > WIDTH and any(isinstance(item, dict | list | str) for item in value):
        rows = [inside + _text(item, depth + 1) for item in value]
        return "[\n" + ",\n".join(rows) + "\n" + outside + "]"
    return flat


def _flat(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)
