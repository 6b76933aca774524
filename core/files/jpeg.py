"""JPEG files: whether one is whole, and how far its compression leaves grey values off.

References
----------
ITU-T T.81, Digital compression and coding of continuous-tone still images (1992), annexes A.3.4, B.2.2 and B.2.4.1.
ITU-T T.871, JPEG File Interchange Format (2011), section 7: brightness and two colours of red, green and blue.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TypeAlias

import numpy as np

from core.acquire.channel import Channel, is_difference
from core.image.stripes.noise import Compression
from core.messages import Message

START = b"\xff\xd8"
_QUANTISATION, _SCAN = 0xDB, 0xDA
"""Second bytes of the markers of a table of quantisation and of a scan's head (ITU-T T.81, table B.1)."""
_FRAMES = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
"""Markers of a frame's head; the three between them are tables and an extension."""
_COARSE_TERMS = 10
"""Terms of a block's cosine series, in the order of the file, that make up a stripe: those of the 4 lowest orders."""

_TERMS = 64
"""Terms of a block's cosine series: 8 × 8."""
_BLOCK_PX = 8.0
"""Side of a block."""
_BEFORE_COMPONENTS = 6
"""Bytes of a frame's head before its components: precision, height, width and how many they are."""
_COLOUR = {"red": (1.0, 0.0, 1.402), "green": (1.0, -0.344136, -0.714136), "blue": (1.0, 1.772, 0.0)}
"""Of brightness, blueness and redness."""

_ENDS_EARLY = Message("picture.ends_early", "ends early")


def jpeg_damage(data: bytes) -> Message | None:
    """Find damage in the bytes of a JPEG file and tell it as the end of a sentence; None if there is none.

    Walks the segments up to the scan, then looks for the end marker; a thumbnail may hold another.
    """
    try:
        for marker, _, end in _segments(data):
            if marker == _SCAN:
                return None if data.find(b"\xff\xd9", end) >= 0 else _ENDS_EARLY
    except ValueError:
        return Message("picture.marker_missing", "is damaged (a marker is missing)")
    return _ENDS_EARLY


Component: TypeAlias = tuple[float, float]
"""Of brightness or a colour: the step in grey levels to which the terms that make up a stripe are rounded (RMS), and
how many times more pixels of the picture each of its own takes."""


def components_of(data: bytes) -> tuple[Component, ...]:
    """List the components of a JPEG from its tables; () if they are damaged or missing. `data` may end behind them."""
    steps: dict[int, float] = {}
    components: list[tuple[int, int, int]] = []
    try:
        for marker, start, end in _segments(data):
            if end > len(data):
                break
            if marker == _QUANTISATION:
                steps.update(_steps(data[start:end]))
            elif marker in _FRAMES:
                components = _components(data[start:end])
    except ValueError:
        return ()
    components = components or [(1, 1, 0)]
    across, down = (max(samples[way] for samples in components) for way in (0, 1))
    return tuple((steps.get(table, 0.0), max(across / columns, down / rows)) for columns, rows, table in components)


def compression_by(
    components: Sequence[Component], channel: Channel | None = None, *, assumed: bool = False
) -> Compression:
    """Estimate the errors in grey levels that rounding its components makes in a channel of a picture.

    A term in steps of q is off by q/√12, on the average of the terms that make up a stripe. There are brightness and
    two colours, each with its step, and the colours mostly in fewer pixels: a stripe in one of them is off by as many
    times more pixels of the picture. Grey is brightness alone, a difference of channels colour alone, a channel of
    both. `assumed` says that the steps are not known.
    """
    squares, block = 0.0, _BLOCK_PX
    for share, (step, coarser) in zip(_shares(channel, len(components)), components, strict=False):
        if share and step:
            squares += (share * coarser * step) ** 2 / 12
            block = max(block, _BLOCK_PX * coarser)
    return Compression(float(np.sqrt(squares)), block, assumed)


def _shares(channel: Channel | None, components: int) -> tuple[float, ...]:
    """How much of brightness and of both colours is in a channel."""
    if channel is None or components < len(_COLOUR):
        return (1.0,)
    if not is_difference(channel):
        return _COLOUR[channel]
    first, second = (_COLOUR[name] for name in channel.split("-"))
    return tuple(a - b for a, b in zip(first, second, strict=True))


def _steps(segment: bytes) -> Iterator[tuple[int, float]]:
    """Number of each table in a segment, and the RMS of its steps for the coarse terms."""
    at = 0
    while at < len(segment):
        number, size = segment[at] & 0x0F, 2 if segment[at] >> 4 else 1
        table = np.frombuffer(segment[at + 1 : at + 1 + _COARSE_TERMS * size], ">u2" if size == 2 else np.uint8)
        if len(table) == _COARSE_TERMS:
            yield number, float(np.sqrt(np.mean(table.astype(np.float64) ** 2)))
        at += 1 + _TERMS * size


def _components(head: bytes) -> list[tuple[int, int, int]]:
    """Samples a unit, across and down, and number of the table of each component in a frame's head."""
    places = range(_BEFORE_COMPONENTS, len(head) - 2, 3)
    return [(max(1, head[at + 1] >> 4), max(1, head[at + 1] & 0x0F), head[at + 2]) for at in places]


def frame_sizes(data: bytes) -> Iterator[tuple[int, int]]:
    """Yield (width, height) in px of each frame that a JPEG file declares; ValueError if it is damaged before that."""
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
