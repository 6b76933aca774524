"""STL, binary and as text: the corners of triangles, without a unit; here they are taken as mm."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from core.errors import WrongValue
from core.files.limits import STL_BYTES, check_file
from core.files_read import report_read
from core.messages import Message
from core.model.arrays import Array

HEAD = 80
"""Bytes in front of the number of triangles in a binary file."""
TRIANGLE = np.dtype([("normal", "<f4", (3,)), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
"""One triangle of a binary file."""

_START = HEAD + 4
_VERTEX = re.compile(rb"^[ \t]*vertex[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)", re.MULTILINE | re.IGNORECASE)


def read_corners(path: Path) -> Array:
    """Read the corners (N, 3, 3) of the triangles in an STL file, binary or text.

    Binary files are told by their length, for many begin with "solid" as those of text do.

    Raises
    ------
    InputError
        If it is too large, or no file.
    OSError
        If it cannot be read.
    ValueError
        If a number is none, or a triangle has not three corners.
    """
    check_file(path, most=STL_BYTES)
    report_read(path)
    data = path.read_bytes()
    if len(data) == _START + TRIANGLE.itemsize * int.from_bytes(data[HEAD:_START], "little"):
        with np.errstate(invalid="ignore"):  # numbers that are none stay so
            return np.asarray(np.frombuffer(data, TRIANGLE, offset=_START)["corners"], dtype=np.float64)
    numbers = np.fromiter((float(number) for found in _VERTEX.finditer(data) for number in found.groups()), np.float64)
    if len(numbers) % 9:
        raise WrongValue(Message("file.stl_triangle", "a triangle has not three corners"))
    return numbers.reshape(-1, 3, 3)
