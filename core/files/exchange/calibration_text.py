"""What camera calibrations of other programs say: fields and their numbers, from YAML, JSON or XML.

Read by Python's own readers and only so far as a calibration needs: no tags, no entities, no references to other
files, one number or list of numbers under a name.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import yaml

from core.errors import InputError
from core.files.limits import CAMERA_BYTES, DEPTH, check_json
from core.files.reading import json_of, read_text
from core.messages import Message

_LOADER = getattr(yaml, "CBaseLoader", yaml.BaseLoader)
"""Lists, tables and texts only: tags, such as OpenCV's `!!opencv-matrix`, are passed over, and make nothing."""
_MOST_NUMBERS = 100
"""In one field: a distortion has at most 14."""
_MOST_EVENTS = 200_000
"""Numbers and lists of one file: 100 views of 1,000 corners have as many."""


def read_fields(path: Path) -> Mapping[str, Any]:
    """Read a calibration file in YAML or JSON as a table of fields; InputError if it is neither.

    The fields' values are texts, numbers, lists, or tables that hold `data`.

    Raises
    ------
    InputError
        If the file cannot be read, is larger or deeper than any calibration, or is neither YAML, JSON nor XML.
    """
    text = read_text(path, most=CAMERA_BYTES)
    begin = text.lstrip()[:1]
    fields = json_of(text, path) if begin == "{" else _xml(text, path) if begin == "<" else _yaml(text, path)
    if not isinstance(fields, Mapping):
        raise _no_fields(path)
    return fields


def numbers(value: Any) -> list[float] | None:
    """Convert a field to a list of finite numbers: one, a list, or a matrix's `data`; None for anything else."""
    data = value.get("data") if isinstance(value, Mapping) else value
    words: list[Any] = data.split() if isinstance(data, str) else data if isinstance(data, list) else [data]
    if len(words) > _MOST_NUMBERS or not all(type(one) in (str, int, float) for one in words):
        return None
    try:
        found = [float(one) for one in words]
    except ValueError:
        return None
    return found if all(map(math.isfinite, found)) else None


def first_of(fields: Mapping[str, Any], names: Sequence[str]) -> Any:
    """Return the value of that of `names` which comes first and is in `fields`; None if none is."""
    return next((fields[name] for name in names if name in fields), None)


def _yaml(text: str, path: Path) -> Any:
    check_json(text, path)
    if text.startswith("%YAML:"):  # as OpenCV writes it; YAML wants a space
        text = text.partition("\n")[2]
    try:
        _check_events(text, path)
        return yaml.load(text, Loader=_LOADER)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise _no_fields(path) from error


def _check_events(text: str, path: Path) -> None:
    """InputError if the text is deep, long or refers to parts of itself: the loader builds by recursion, in C."""
    depth = 0
    for place, event in enumerate(yaml.parse(text, Loader=_LOADER)):
        depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
        if depth > DEPTH or place > _MOST_EVENTS or isinstance(event, yaml.AliasEvent):
            raise _no_fields(path)


def _xml(text: str, path: Path) -> Mapping[str, Any]:
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise InputError(Message("file.xml_entities", "it declares entities, which no calibration needs"), where=path)
    try:
        root = ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError) as error:
        raise _no_fields(path) from error
    return {one.tag: {"data": one.findtext("data", "")} if len(one) else one.text or "" for one in root}


def _no_fields(path: Path) -> InputError:
    return InputError(Message("file.no_calibration", "this is no calibration in YAML, JSON or XML"), where=path)
