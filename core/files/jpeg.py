"""JPEG files: whether one is whole, and how far its compression leaves grey values off.

References
----------
ITU-T T.81, Digital compression and coding of continuous-tone still images (1992), annexes A.3.4 and B.2.4.1.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from core.messages import Message

START = b"\xff\xd8"
_QUANTISATION, _SCAN = 0xDB, 0xDA
_FRAMES = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
"""Markers of a frame's head; the three between them are tables and an extension."""
_COARSE_TERMS = 10
"""Terms of a block's cosine series, in the order of the file, that make up a stripe: those of the 4 lowest orders."""

_ENDS_EARLY = Message("picture.ends_early", "ends early")


def jpeg_damage(data: bytes) -> Message | None:
    """What is wrong with the bytes of a JPEG file, as the end of a sentence; None if nothing is.

    Walks the segments up to the scan, then looks for the end marker; a thumbnail may hold another.
    """
    try:
        for marker, _, end in _segments(data):
            if marker == _SCAN:
                return None if data.find(b"\xff\xd9", end) >= 0 else _ENDS_EARLY
    except ValueError:
        return Message("picture.marker_missing", "is damaged (a marker is missing)")
    return _ENDS_EARLY


def compression_grey(data: bytes) -> float:
    """Standard deviation in grey levels of what rounding the terms of a block leaves of each; 0 for any other file.

    From the file's own quantisation table of brightness: a term in steps of q is off by q/√12, on the average of the
    terms that make up a stripe. `data` may end behind the tables.
    """
    if not data.startswith(START):
        return 0.0
    try:
        for marker, start, end in _segments(data):
            if marker == _SCAN:
                break
            if marker == _QUANTISATION and end <= len(data) and data[start] & 0x0F == 0:
                size = 2 if data[start] >> 4 else 1
                table = data[start + 1 : start + 1 + _COARSE_TERMS * size]
                steps = np.frombuffer(table, ">u2" if size == 2 else np.uint8).astype(np.float64)
                return float(np.sqrt(np.mean(steps**2) / 12)) if len(steps) == _COARSE_TERMS else 0.0
    except ValueError:
        pass
    return 0.0


def frame_sizes(data: bytes) -> Iterator[tuple[int, int]]:
    """(width, height) of each frame that is declared; ValueError where no marker is."""
    for marker, start, _ in _segments(data):
        if marker in _FRAMES and start + 5 <= len(data):
            height, width = (int.from_bytes(data[at : at + 2], "big") for at in (start + 1, start + 3))
            yield width, height


def _segments(data: bytes) -> Iterator[tuple[int, int, int]]:
    """Marker, first byte and past-the-last byte of each segment up to the scan; ValueError where no marker is."""
    at = 2
    while at + 4 <= len(data):
        if data[at] != 0xFF:
            raise ValueError("no marker")
        marker = data[at + 1]
        if marker == 0xFF:  # a fill byte
            at += 1
            continue
        end = at + 2 + max(2, int.from_bytes(data[at + 2 : at + 4], "big"))
        yield marker, at + 4, end
        if marker == _SCAN:
            return
        at = end
