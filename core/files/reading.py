"""Files read whole: bytes, text, JSON, TOML. What keeps one from being read is told as one sentence that names it."""

from __future__ import annotations

import csv
import errno
import hashlib
import json
import os
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from core.errors import InputError
from core.files.limits import DATA_BYTES, TEXT_BYTES, TOML_BYTES, check_file, check_json, check_toml
from core.files_read import report_read
from core.messages import Message

_REFUSED = (errno.ENAMETOOLONG, errno.ELOOP, errno.EACCES, errno.EPERM)
"""What the system says of a path that cannot be used: too long a name, links in a circle, no right to it."""

MISSING = Message("file.missing", "the file is missing")


def read_bytes(path: Path, *, most: int = DATA_BYTES) -> bytes:
    """Read the bytes of a file; InputError if it cannot be read, is no file, or has more than `most` bytes."""
    check_file(path, most)
    try:
        content = path.read_bytes()
    except (OSError, ValueError) as error:  # ValueError: a path with a NUL
        raise _no_content(path, error) from error
    report_read(path)
    return content


def resolved(path: Path) -> Path:
    """Make a path absolute, links followed as far as they lead; a circle of links is no error."""
    return Path(os.path.realpath(path))


def file_hash(path: Path) -> str:
    """Compute SHA-256 in hex of a file's bytes; InputError if it cannot be read or is too large."""
    return hashlib.sha256(read_bytes(path)).hexdigest()


def read_text(path: Path, *, missing: Message = MISSING, todo: Message | None = None, most: int = TEXT_BYTES) -> str:
    """Read the text of a UTF-8 file, without a byte order mark; InputError if it cannot be read.

    Parameters
    ----------
    path
        Of the file.
    missing, todo
        What to tell if it is not there, and how to come by it.
    most
        Bytes it may have.

    Raises
    ------
    InputError
        If it is missing, cannot be read, is no file, too large, or no UTF-8.
    """
    check_file(path, most)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError as error:
        raise InputError(missing, where=path, todo=todo or "") from error
    except UnicodeDecodeError as error:
        raise InputError(
            Message("file.no_text", "this is no UTF-8 text: byte {number} is in no letter", number=error.start + 1),
            where=path,
            todo=Message("advice.save_utf8", "save it as UTF-8 in an editor"),
        ) from error
    except (OSError, ValueError) as error:
        raise _no_content(path, error) from error
    report_read(path)
    return text


def read_json(path: Path, *, todo: Message | None = None) -> Any:
    """Read and parse a JSON file; InputError if it cannot be read or is no JSON."""
    return json_of(read_text(path, todo=todo), path, todo=todo)


def json_of(text: str, where: Path | str, *, todo: Message | None = None) -> Any:
    """Parse a text of JSON; InputError that names `where` if it is none, or is nested too deep."""
    check_json(text, where)
    try:
        value = json.loads(text)
        if "\\u" in text:
            json.dumps(value, ensure_ascii=False).encode()  # half of a pair stands for no character
    except UnicodeEncodeError as error:
        raise InputError(Message("file.half_character", "it holds half a character"), where=where) from error
    except ValueError as error:
        what = Message("file.no_json", "this is no valid JSON: {reason}", reason=str(error))
        raise InputError(what, where=where, todo=todo or "") from error
    return value


def read_toml(path: Path, *, missing: Message = MISSING, todo: Message | None = None) -> dict[str, Any]:
    """Read and parse a TOML file; InputError if it cannot be read or is no TOML."""
    return toml_of(read_text(path, missing=missing, todo=todo, most=TOML_BYTES), path)


def toml_of(text: str, where: Path | str) -> dict[str, Any]:
    """Parse a text of TOML; InputError that names `where` if it is none, or is nested too deep."""
    check_toml(text, where)
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        what = Message("file.no_toml", "this is no valid TOML: {reason}", reason=str(error))
        raise InputError(what, where=where) from error


def csv_rows(lines: Iterable[str], path: Path, separator: str = ",") -> list[list[str]]:
    """Parse the lines of a CSV file into rows of cells; InputError that names `path` if they are no table."""
    try:
        return list(csv.reader(lines, delimiter=separator))
    except csv.Error as error:
        what = Message("file.no_csv", "this is no table ({reason})", reason=str(error))
        raise InputError(what, where=path) from error


def refused_path(error: Exception) -> InputError | None:
    """Make the InputError for a system error that is due to a path; None for any other error."""
    if not isinstance(error, OSError) or error.errno not in _REFUSED or not isinstance(error.filename, str):
        return None
    return cannot_read(Path(error.filename), error)


def cannot_read(path: Path, error: OSError | ValueError) -> InputError:
    """Make the error that a file or folder is there but cannot be read, with the system's reason."""
    reason = str(getattr(error, "strerror", "") or error)
    return InputError(Message("file.cannot_be_read", "cannot be read ({reason})", reason=reason), where=path)


def _no_content(path: Path, error: OSError | ValueError) -> InputError:
    """Make the error for a file that cannot be read; systems complain differently of a folder in its place."""
    if not path.is_dir():
        return cannot_read(path, error)
    todo = Message("advice.file_in_its_place", "put a file there")
    return InputError(Message("file.is_folder", "this is a folder"), where=path, todo=todo)
