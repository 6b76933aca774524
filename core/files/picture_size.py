"""How large a picture says it is, from the head of its file, before anything is made of that size.

References
----------
PNG 3 (W3C, 2025), 11.2.1; BMP: BITMAPINFOHEADER and BITMAPCOREHEADER; TIFF 6.0 (1992), section 2; JPEG: ITU-T T.81.
"""

from __future__ import annotations

import struct
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from PIL import Image

from core.files import jpeg

_TIFF = {b"II*\0": "<", b"MM\0*": ">"}
_WIDTH, _LENGTH = 256, 257
"""Tags of a TIFF: columns and rows of its picture (TIFF 6.0, section 8)."""
_SHORT, _LONG = 3, 4
"""Types of a TIFF's values: 16 and 32 bits without sign (TIFF 6.0, section 2)."""
_CORE_HEAD = 12
"""Bytes of the oldest head of a BMP, whose sides have two bytes."""
_TABLES = 1000
"""More pictures than any TIFF of a camera has."""


@contextmanager
def opened_head(path: Path) -> Iterator[Image.Image]:
    """Open a picture for reading its head alone, whatever number of pixels it declares; raises Pillow's errors."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", Image.DecompressionBombWarning)  # cameras have more pixels than it allows
        with Image.open(path) as picture:
            yield picture


def declared_sizes(data: bytes) -> Iterator[tuple[int, int]]:
    """Yield (width, height) in px of each picture declared in the bytes of a PNG, BMP, JPEG or TIFF file.

    Nothing of other files or a truncated head.
    """
    try:
        if data.startswith(b"\x89PNG"):
            yield struct.unpack_from(">II", data, 16)
        elif data.startswith(b"BM"):
            core = struct.unpack_from("<I", data, 14)[0] == _CORE_HEAD
            width, height = struct.unpack_from("<HH" if core else "<ii", data, 18)
            yield abs(width), abs(height)
        elif data.startswith(jpeg.START):
            yield from jpeg.frame_sizes(data)
        elif data[:4] in _TIFF:
            yield from _tiff_sizes(data, _TIFF[data[:4]])
    except (struct.error, ValueError):
        return


def _tiff_sizes(data: bytes, order: str) -> Iterator[tuple[int, int]]:
    """One for each table of tags, as far as there are tables."""
    (at,) = struct.unpack_from(f"{order}I", data, 4)
    for _ in range(_TABLES):
        if not at:
            return
        (count,) = struct.unpack_from(f"{order}H", data, at)
        sides = {}
        for place in range(at + 2, at + 2 + 12 * count, 12):
            tag, kind = struct.unpack_from(f"{order}HH", data, place)
            if tag in (_WIDTH, _LENGTH) and kind in (_SHORT, _LONG):
                (sides[tag],) = struct.unpack_from(order + ("H" if kind == _SHORT else "I"), data, place + 8)
        if len(sides) == 2:
            yield sides[_WIDTH], sides[_LENGTH]
        (at,) = struct.unpack_from(f"{order}I", data, at + 2 + 12 * count)
