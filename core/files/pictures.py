"""Pictures in and out. A damaged picture is always refused, never half decoded."""

from __future__ import annotations

import zlib
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from core.acquire.grey import Channel, to_grey
from core.errors import InputError
from core.files.atomic import write_bytes
from core.files.pgm import MAGIC, pgm_damage, pgm_parts, read_pgm

Picture = NDArray[np.uint8] | NDArray[np.uint16]
_Any = NDArray[Any]

SUFFIXES = frozenset({".png", ".tif", ".tiff", ".bmp", ".jpg", ".jpeg", ".pgm"})
"""Endings (lower case) of the files that count as pictures."""

_PNG = b"\x89PNG\r\n\x1a\n"
_QUICKLY = [cv2.IMWRITE_PNG_COMPRESSION, 1, cv2.IMWRITE_PNG_STRATEGY, cv2.IMWRITE_PNG_STRATEGY_HUFFMAN_ONLY]
"""Noise has no repeats worth looking for: half the time of run lengths, and no larger."""
if hasattr(cv2, "IMWRITE_PNG_FILTER"):  # since OpenCV 4.11; one filter for all rows halves the time again
    _QUICKLY += [cv2.IMWRITE_PNG_FILTER, cv2.IMWRITE_PNG_FILTER_AVG]


def is_picture(path: Path) -> bool:
    """Whether the name of `path` is that of a picture; hidden files are none."""
    return path.suffix.lower() in SUFFIXES and not path.name.startswith(".")


def read_picture(path: Path, channel: Channel | None = None) -> Picture:
    """Read a picture as grey levels.

    Parameters
    ----------
    path
        png, tif, bmp, jpg or pgm; 8 or 16 bit; grey or colour.
    channel
        The channel of a colour picture to take; without it, colour is reduced to grey (0.299 R + 0.587 G + 0.114 B).

    Returns
    -------
    Picture
        (height, width) uint8 or uint16.

    Raises
    ------
    InputError
        If the file cannot be read, is no picture, ends early or is damaged, or has an unsupported depth.
    """
    return decode_picture(read_bytes(path), path, channel)


def read_bytes(path: Path) -> bytes:
    """The bytes of a file; InputError if it cannot be read."""
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror or error})", where=path) from error


def decode_picture(data: bytes, path: Path, channel: Channel | None = None) -> Picture:
    """Decode the bytes of a picture file; `path` names it in messages. Else as :func:`read_picture`."""
    damage = _damage(data)
    if damage:
        raise InputError(f"the picture {damage}", where=path, todo="record or copy it again")
    plain = read_pgm(data) if data.startswith(MAGIC) else None
    if plain is not None:
        return plain
    try:
        picture: _Any | None = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error:
        picture = None
    if picture is None:
        raise InputError("this is no readable picture", where=path, todo="use png, tif, bmp, jpg or pgm")
    if picture.dtype not in (np.uint8, np.uint16):
        raise InputError(f"the picture holds {picture.dtype} values", where=path, todo="save it with 8 or 16 bit")
    return to_grey(picture, channel)


def write_picture(path: Path, picture: Picture) -> None:
    """Write (height, width) uint8 or uint16 grey levels, lossless, quickly, whole or not at all.

    PNG takes half the room, PGM no coding: it is as quick as the disk.

    Raises
    ------
    InputError
        If it cannot be written.
    ValueError
        If the name does not end in .png or .pgm or the array is no picture.
    """
    write_bytes(path, *picture_parts(path, picture), sync=False)


def picture_parts(path: Path, picture: Picture) -> tuple[bytes | memoryview, ...]:
    """What the file `path` of a picture holds, in one piece or several; ValueError as `write_picture`."""
    if path.suffix.lower() == ".pgm":
        return pgm_parts(picture)
    if path.suffix.lower() != ".png":
        raise ValueError(f"{path.name} ends neither in .png nor in .pgm")
    if picture.ndim != 2 or picture.dtype not in (np.uint8, np.uint16):
        raise ValueError(f"a picture is 2-D uint8 or uint16, not {picture.ndim}-D {picture.dtype}")
    done, data = cv2.imencode(".png", picture, _QUICKLY)
    if not done:
        raise ValueError(f"{path.name} could not be encoded")
    return (data.data,)


def _damage(data: bytes) -> str:
    """What is wrong with the bytes of a picture file, as the end of a sentence, or "".

    Decoders fill up what is missing with grey and only mumble about it, so each kind of file is checked for its end
    (and PNG for its checksums) before it is decoded. TIFF needs none of this: its decoder fails on missing strips.
    """
    if not data:
        return "is empty (0 bytes)"
    if data.startswith(_PNG):
        return _png_damage(data)
    if data.startswith(b"\xff\xd8"):
        return _jpeg_damage(data)
    if data.startswith(b"BM") and len(data) >= 6:
        return "" if len(data) >= int.from_bytes(data[2:6], "little") else "ends early"
    if data.startswith(MAGIC):
        return pgm_damage(data)
    return ""


def _png_damage(data: bytes) -> str:
    """Walk the chunks of a PNG up to IEND, checking the checksum of each."""
    at = len(_PNG)
    view = memoryview(data)
    while at + 12 <= len(data):
        end = at + 8 + int.from_bytes(view[at : at + 4], "big")
        if end + 4 > len(data):
            return "ends early"
        if zlib.crc32(view[at + 4 : end]) != int.from_bytes(view[end : end + 4], "big"):
            return "is damaged (a checksum is wrong)"
        if data[at + 4 : at + 8] == b"IEND":
            return ""
        at = end + 4
    return "ends early"


def _jpeg_damage(data: bytes) -> str:
    """Walk the segments of a JPEG up to its scan, then look for the end marker; a thumbnail may hold another."""
    at = 2
    while at + 4 <= len(data):
        if data[at] != 0xFF:
            return "is damaged (a marker is missing)"
        marker = data[at + 1]
        if marker == 0xFF:  # a fill byte
            at += 1
            continue
        at += 2 + int.from_bytes(data[at + 2 : at + 4], "big")
        if marker == 0xDA:
            return "" if data.find(b"\xff\xd9", at) >= 0 else "ends early"
    return "ends early"
