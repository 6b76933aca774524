"""Pictures in and out. A damaged picture is always refused, never half decoded."""

from __future__ import annotations

import zlib
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from core.acquire.channel import Channel
from core.acquire.grey import to_grey
from core.errors import InputError
from core.files import compression, jpeg
from core.files.atomic import write_bytes
from core.files.limits import check_file, check_pixels
from core.files.picture_size import declared_sizes
from core.files.reading import read_bytes
from core.image.mosaic import Pattern, colours_of
from core.image.stripes.noise import UNCOMPRESSED, Compression
from core.messages import Message

MAGIC = b"P5"

_WHITE = {np.dtype(np.uint8): 255, np.dtype(np.uint16): 65535}


def pgm_parts(picture: NDArray[np.uint8] | NDArray[np.uint16]) -> tuple[bytes, memoryview]:
    """Make head and pixels of a PGM file of a picture (height, width); ValueError unless it is uint8 or uint16."""
    if picture.ndim != 2 or picture.dtype not in _WHITE:
        raise ValueError(f"a picture is 2-D uint8 or uint16, not {picture.ndim}-D {picture.dtype}")
    height, width = picture.shape
    levels = picture if picture.dtype == np.uint8 else picture.astype(">u2")
    return f"P5\n{width} {height}\n{_WHITE[picture.dtype]}\n".encode(), np.ascontiguousarray(levels).data


def read_pgm(data: bytes) -> NDArray[np.uint8] | NDArray[np.uint16] | None:
    """Decode an undamaged PGM file to grey levels (height, width); None if white is neither 255 nor 65535."""
    width, height, white, begin = _head(data)
    if white == 255:
        return np.frombuffer(data, np.uint8, width * height, begin).reshape(height, width).copy()
    if white == 65535:
        return np.frombuffer(data, ">u2", width * height, begin).reshape(height, width).astype(np.uint16)
    return None


def _pgm_damage(data: bytes) -> Message | None:
    """What is wrong with the bytes of a PGM file; None if they are as many as its head says."""
    try:
        width, height, white, begin = _head(data)
    except EOFError:
        return _ENDS_EARLY
    except ValueError:
        return Message("picture.no_pgm_header", "is damaged (its header is no PGM header)")
    return None if len(data) >= begin + width * height * (2 if white > 255 else 1) else _ENDS_EARLY


def _head(data: bytes) -> tuple[int, int, int, int]:
    """Width, height, white, and where the pixels begin; EOFError if it ends early, ValueError if it is none."""
    fields: list[int] = []
    at = len(MAGIC)
    while len(fields) < 3:
        while at < len(data) and data[at : at + 1].isspace():
            at += 1
        if data[at : at + 1] == b"#":
            at = data.find(b"\n", at) + 1
            if at == 0:
                raise EOFError
            continue
        start = at
        while at < len(data) and data[at : at + 1].isdigit():
            at += 1
        if start == at:
            raise EOFError if at >= len(data) else ValueError("no number")
        if at - start > _PGM_DIGITS:
            raise ValueError("a number is too long")
        fields.append(int(data[start:at]))
    width, height, white = fields
    return width, height, white, at + 1


Picture = NDArray[np.uint8] | NDArray[np.uint16]
_Any = NDArray[Any]

SUFFIXES = frozenset({".png", ".tif", ".tiff", ".bmp", ".jpg", ".jpeg", ".pgm"})
"""Endings (lower case) of the files that count as pictures."""

_PGM_DIGITS = 18
"""As many as a whole number of 64 bits may have."""
_ENDS_EARLY = Message("picture.ends_early", "ends early")
_TABLES_WITHIN = 1 << 17
"""Bytes in which a JPEG's tables are: they may stand behind a thumbnail of up to 64 kB."""
_QUICKLY = [cv2.IMWRITE_PNG_COMPRESSION, 1, cv2.IMWRITE_PNG_STRATEGY, cv2.IMWRITE_PNG_STRATEGY_HUFFMAN_ONLY]
"""Noise has no repeats worth looking for: half the time of run lengths, and no larger."""
if hasattr(cv2, "IMWRITE_PNG_FILTER"):  # since OpenCV 4.11; one filter for all rows halves the time again
    _QUICKLY += [cv2.IMWRITE_PNG_FILTER, cv2.IMWRITE_PNG_FILTER_AVG]


def is_picture(path: Path) -> bool:
    """Whether `path` ends like the name of a picture that can be read, and is not hidden."""
    return path.suffix.lower() in SUFFIXES and not path.name.startswith(".")


def read_picture(path: Path, channel: Channel | None = None, mosaic: Pattern | None = None) -> Picture:
    """Read a picture file as grey levels (height, width), uint8 or uint16; InputError if it is damaged.

    Parameters
    ----------
    path
        png, tif, bmp, jpg or pgm; 8 or 16 bit; grey or colour.
    channel
        The channel of a colour picture to take; without it, colour is reduced to grey (0.299 R + 0.587 G + 0.114 B).
    mosaic
        The colour mosaic of raw pictures.

    Returns
    -------
    Picture
        (height, width) uint8 or uint16.

    Raises
    ------
    InputError
        If the file cannot be read, is no picture, ends early or is damaged, or has an unsupported depth.
    """
    return to_grey(decode_colours(read_bytes(path), path, mosaic), channel)


def decode_colours(data: bytes, path: Path, mosaic: Pattern | None = None) -> NDArray[Any]:
    """Decode a picture file's bytes with all channels: (height, width) or (height, width, 1 … 4) in OpenCV's order.

    `path` names the file in messages. A raw picture of a `mosaic` has the colours of its mosaic interpolated.

    (height, width), or (height, width, 1 … 4) in OpenCV's order.
    A raw picture of a `mosaic` has the colours of its sites, between them their means.
    """
    picture = _decoded(data, path)
    return picture if mosaic is None or picture.ndim > 2 else colours_of(picture, mosaic)


def _decoded(data: bytes, path: Path) -> NDArray[Any]:
    """The picture as its file has it."""
    damage = _damage(data)
    if damage is not None:
        raise InputError(
            Message("picture.damaged", "the picture {reason}", reason=damage),
            where=path,
            todo=Message("advice.record_or_copy_again", "record or copy it again"),
        )
    for width, height in declared_sizes(data):
        check_pixels(width, height, path)
    if data.startswith(MAGIC):
        check_pixels(*_head(data)[:2], path)
        plain = read_pgm(data)
        if plain is not None:
            return plain
    try:
        picture: _Any | None = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error:
        picture = None
    if picture is None or picture.ndim not in (2, 3) or not picture.size:
        raise InputError(
            Message("picture.unreadable", "this is no readable picture"),
            where=path,
            todo=Message("advice.use_picture_format", "use png, tif, bmp, jpg or pgm"),
        )
    if picture.dtype not in (np.uint8, np.uint16):
        raise InputError(
            Message("picture.depth_not_supported", "the picture holds {dtype} values", dtype=str(picture.dtype)),
            where=path,
            todo=Message("advice.save_with_8_or_16_bit", "save it with 8 or 16 bit"),
        )
    return picture


def compression_of(path: Path, channel: Channel | None = None) -> Compression:
    """Estimate the errors by compression of a channel of a picture file; none for one lossless or unreadable."""
    check_file(path)
    try:
        with path.open("rb") as file:
            return compression.compression_of(file.read(_TABLES_WITHIN), channel)
    except OSError:
        return UNCOMPRESSED


def write_picture(path: Path, picture: Picture) -> None:
    """Write grey levels (height, width), uint8 or uint16, as PNG or PGM by the ending of `path`, whole or not at all.

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
    """Encode a picture as PNG or PGM, by the ending of `path`, in one piece or several; ValueError if it cannot be."""
    if path.suffix.lower() == ".pgm":
        return pgm_parts(picture)
    if path.suffix.lower() != ".png":
        raise ValueError(f"{path.name} ends neither in .png nor in .pgm")
    if picture.ndim != 2 or picture.dtype not in (np.uint8, np.uint16):
        raise ValueError(f"a picture is 2-D uint8 or uint16, not {picture.ndim}-D {picture.dtype}")
    return (encode_png(picture),)


def encode_png(picture: NDArray[np.uint8] | NDArray[np.uint16]) -> memoryview:
    """Encode a picture (height, width), or with colours (height, width, 3) in OpenCV's order, as the bytes of a PNG."""
    done, data = cv2.imencode(".png", picture, _QUICKLY)
    if not done:
        raise ValueError(f"a picture of {picture.shape} could not be encoded")
    return data.data


def _damage(data: bytes) -> Message | None:
    """What is wrong with the bytes of a picture file, as the end of a sentence; None if nothing is.

    Decoders fill up what is missing with grey and only mumble about it, so each kind of file is checked for its end
    (and PNG for its checksums) before it is decoded. TIFF needs none of this: its decoder fails on missing strips.
    """
    if not data:
        return Message("picture.empty", "is empty (0 bytes)")
    if data.startswith(compression.PNG):
        return _png_damage(data)
    if data.startswith(jpeg.START):
        return jpeg.jpeg_damage(data)
    if data.startswith(b"BM") and len(data) >= 6:
        return None if len(data) >= int.from_bytes(data[2:6], "little") else _ENDS_EARLY
    if data.startswith(MAGIC):
        return _pgm_damage(data)
    return None


def _png_damage(data: bytes) -> Message | None:
    """Walk the chunks of a PNG up to IEND, checking the checksum of each."""
    at = len(compression.PNG)
    view = memoryview(data)
    while at + 12 <= len(data):
        end = at + 8 + int.from_bytes(view[at : at + 4], "big")
        if end + 4 > len(data):
            return _ENDS_EARLY
        if zlib.crc32(view[at + 4 : end]) != int.from_bytes(view[end : end + 4], "big"):
            return Message("picture.wrong_checksum", "is damaged (a checksum is wrong)")
        if data[at + 4 : at + 8] == b"IEND":
            return None
        at = end + 4
    return _ENDS_EARLY
