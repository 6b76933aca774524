"""Files read whole: bytes, text, JSON, TOML. What keeps one from being read is told as one sentence that names it."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

from core.errors import InputError
from core.messages import Message

MISSING = Message("file.missing", "the file is missing")


def read_bytes(path: Path) -> bytes:
    """The bytes of a file; InputError if it cannot be read."""
    try:
        return path.read_bytes()
    except OSError as error:
        raise cannot_read(path, error) from error


def read_text(path: Path, *, missing: Message = MISSING, todo: Message | None = None) -> str:
    """The text of a UTF-8 file, without the mark some programs begin it with.

    Parameters
    ----------
    path
        Of the file.
    missing, todo
        What to tell if it is not there, and how to come by it.

    Raises
    ------
    InputError
        If it is missing, cannot be read, or is no UTF-8.
    """
    try:
        return path.read_text(encoding="utf-8-sig")
    except FileNotFoundError as error:
        raise InputError(missing, where=path, todo=todo or "") from error
    except (OSError, UnicodeDecodeError) as error:
        what = Message("file.no_text", "cannot be read as UTF-8 text ({reason})", reason=str(error))
        raise InputError(what, where=path) from error


def read_json(path: Path, *, todo: Message | None = None) -> Any:
    """The content of a JSON file; InputError as `read_text`, or if it is no JSON."""
    try:
        return json.loads(read_text(path, todo=todo))
    except json.JSONDecodeError as error:
        what = Message("file.no_json", "this is no valid JSON: {reason}", reason=str(error))
        raise InputError(what, where=path, todo=todo or "") from error


def read_toml(path: Path, *, missing: Message = MISSING, todo: Message | None = None) -> dict[str, Any]:
    """The tables of a TOML file; InputError as `read_text`, or if it is no TOML."""
    try:
        return tomllib.loads(read_text(path, missing=missing, todo=todo))
    except tomllib.TOMLDecodeError as error:
        what = Message("file.no_toml", "this is no valid TOML: {reason}", reason=str(error))
        raise InputError(what, where=path) from error


def cannot_read(path: Path, error: OSError) -> InputError:
    """The sentence for a file or folder that is there and cannot be read."""
    reason = str(error.strerror or error)
    return InputError(Message("file.cannot_be_read", "cannot be read ({reason})", reason=reason), where=path)
