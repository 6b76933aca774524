"""Binary PGM: grey levels as they are behind a line of text. No coding, so disks are the only limit."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

MAGIC = b"P5"

_WHITE = {np.dtype(np.uint8): 255, np.dtype(np.uint16): 65535}


def pgm_parts(picture: NDArray[np.uint8] | NDArray[np.uint16]) -> tuple[bytes, memoryview]:
    """Head and pixels of the file for (height, width) uint8 or uint16 grey levels; ValueError for anything else."""
    if picture.ndim != 2 or picture.dtype not in _WHITE:
        raise ValueError(f"a picture is 2-D uint8 or uint16, not {picture.ndim}-D {picture.dtype}")
    height, width = picture.shape
    levels = picture if picture.dtype == np.uint8 else picture.astype(">u2")
    return f"P5\n{width} {height}\n{_WHITE[picture.dtype]}\n".encode(), np.ascontiguousarray(levels).data


def read_pgm(data: bytes) -> NDArray[np.uint8] | NDArray[np.uint16] | None:
    """The grey levels of an undamaged file, or None if its white is neither 255 nor 65535."""
    width, height, white, begin = _head(data)
    if white == 255:
        return np.frombuffer(data, np.uint8, width * height, begin).reshape(height, width).copy()
    if white == 65535:
        return np.frombuffer(data, ">u2", width * height, begin).reshape(height, width).astype(np.uint16)
    return None


def pgm_damage(data: bytes) -> str:
    """What is wrong with the bytes of a file, as the end of a sentence, or "": as long as its head says."""
    try:
        width, height, white, begin = _head(data)
    except ValueError as damage:
        return str(damage)
    return "" if len(data) >= begin + width * height * (2 if white > 255 else 1) else "ends early"


def _head(data: bytes) -> tuple[int, int, int, int]:
    """Width, height, white, and where the pixels begin; ValueError with the end of a sentence."""
    fields: list[int] = []
    at = len(MAGIC)
    while len(fields) < 3:
        while at < len(data) and data[at : at + 1].isspace():
            at += 1
        if data[at : at + 1] == b"#":
            at = data.find(b"\n", at) + 1
            if at == 0:
                raise ValueError("ends early")
            continue
        start = at
        while at < len(data) and data[at : at + 1].isdigit():
            at += 1
        if start == at:
            raise ValueError("ends early" if at >= len(data) else "is damaged (its header is no PGM header)")
        fields.append(int(data[start:at]))
    width, height, white = fields
    return width, height, white, at + 1
