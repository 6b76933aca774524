"""What is checked before a file is read or believed: what kind it is, how large, how deep, what sizes it declares.

Each limit is far above what any file of ours or of a camera holds, and low enough that what is within it is read in
seconds and in less than 2 GB. What is beyond one is told in one sentence.
"""

from __future__ import annotations

import re
import stat
from pathlib import Path

import numpy as np

from core.errors import InputError
from core.messages import Message

DATA_BYTES = 4_000_000_000
"""Of pictures, clouds and arrays: a cloud of 50 million points has 3 GB."""
FILM_BYTES = 100_000_000_000
"""Of a film: it is read frame by frame."""
FILM_FRAMES = 20_000
"""Of one film: eleven minutes of 30 frames a second."""
FILM_PIXELS = 50_000_000
"""Of one of its frames: those of 8K have 33 million."""
FILM_SIDE_PX = 20_000
"""Of a side of one."""
TEXT_BYTES = 30_000_000
"""Of JSON and CSV: a camera.json of 100 views of 2,000 corners has 4 MB."""
STL_BYTES = 300_000_000
"""Of a surface: 6 million triangles in binary, of which several times as much is made."""
STEP_BYTES = 300_000_000
"""Of a CAD part: an engine with all its screws has 200 MB."""
TOML_BYTES = 1_000_000
"""Of what people write."""
CAMERA_BYTES = 1_000_000
"""Of a calibration of another program: a camera of OpenCV has 2 kB."""
DEPTH = 60
"""Of lists and tables within each other, and of a key's parts: ours have 8."""
DIGITS = 100
"""Of one number: 17 say all of a double."""
LARGEST = 1e60
"""Of any number in a file: what is computed of it, up to the fifth power, stays finite."""
PIXELS = 160_000_000
"""Of one picture: the largest area sensors have 151 million."""

_JSON_STRINGS = re.compile(r'"(?:[^"\\]|\\.)*+"')
_TOML_STRINGS = re.compile(
    r'"""(?:[^\\]|\\.)*?"""|\'\'\'.*?\'\'\'|"(?:[^"\\\n]|\\.)*+"|\'[^\'\n]*+\'|#[^\n]*+', re.DOTALL
)
_LONG_NUMBER = re.compile(rf"(?<![0-9A-Za-z_])[-+]?[0-9][0-9A-Fa-f_x]{{{DIGITS},}}")
_LONG_KEY = re.compile(rf"(?<![\w\-.])(?:[\w\-]++[ \t]*+\.[ \t]*+){{{DEPTH},}}")


def check_file(path: Path, most: int = DATA_BYTES) -> None:
    """Raise InputError if `path` is there and is no regular file, or has more than `most` bytes.

    One that is missing, a folder, or behind a closed door is left to whoever opens it.
    """
    try:
        found = path.stat()
    except (OSError, ValueError):
        return
    if stat.S_ISREG(found.st_mode):
        check_bytes(found.st_size, path, most)
    elif not stat.S_ISDIR(found.st_mode):
        raise InputError(
            Message("limits.no_regular_file", "this is a pipe, a socket or a device, not a file"),
            where=path,
            todo=Message("advice.name_a_file", "name a file"),
        )


def check_bytes(size: int, path: Path, most: int) -> None:
    """Raise InputError if the `size` of a file in bytes is more than `most`; `path` names it."""
    if size > most:
        raise InputError(
            Message(
                "limits.too_large",
                "the file has {size_mb:.1f} MB, and no such file has more than {most_mb:.0f}",
                size_mb=size / 1e6,
                most_mb=most / 1e6,
            ),
            where=path,
        )


def check_json(text: str, path: Path | str) -> None:
    """Raise InputError if lists and tables of a JSON text are nested too deep, or a number is too long."""
    _check_text(_JSON_STRINGS.sub("", text), path)


def check_toml(text: str, path: Path | str) -> None:
    """Raise InputError if a TOML text is nested too deep, keys of many parts included, or a number is too long."""
    if len(text) > TOML_BYTES:
        check_bytes(len(text), Path(path), TOML_BYTES)
    bare = _TOML_STRINGS.sub("s", text)
    if _LONG_KEY.search(bare):
        raise _too_deep(path)
    _check_text(bare, path)


def check_pixels(width: int, height: int, path: Path, most: int = PIXELS) -> None:
    """Raise InputError if a picture of `width` × `height` px has no pixels, or more than `most`."""
    if width < 1 or height < 1:
        raise InputError(Message("limits.no_pixels", "the picture has no pixels"), where=path)
    if width * height > most:
        raise InputError(
            Message(
                "limits.too_many_pixels",
                "the picture is said to have {width} × {height} pixels, and at most {most} million are read",
                width=min(width, 10**9),
                height=min(height, 10**9),
                most=most // 1_000_000,
            ),
            where=path,
        )


def _check_text(bare: str, path: Path | str) -> None:
    marks = np.frombuffer(bare.encode("ascii", "replace"), dtype=np.uint8)
    opened = np.isin(marks, np.frombuffer(b"[{", np.uint8)).astype(np.int8)
    closed = np.isin(marks, np.frombuffer(b"]}", np.uint8)).astype(np.int8)
    if len(marks) and int(np.cumsum(opened - closed, dtype=np.int32).max()) > DEPTH:
        raise _too_deep(path)
    if _LONG_NUMBER.search(bare):
        raise InputError(
            Message("limits.long_number", "a number has more than {digits} digits", digits=DIGITS), where=path
        )


def _too_deep(path: Path | str) -> InputError:
    return InputError(
        Message("limits.too_deep", "lists or tables lie more than {depth} deep in each other", depth=DEPTH), where=path
    )
