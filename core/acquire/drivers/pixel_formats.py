"""GenICam's pixel formats: which can be read, and their grey levels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.acquire.channel import Channel
from core.acquire.grey import to_grey
from core.acquire.source import Picture
from core.errors import WrongValue
from core.messages import Message


@dataclass(frozen=True, slots=True)
class _Layout:
    bits: int
    channels: int = 1
    reds_first: bool = False


_LAYOUTS = {
    "Mono8": _Layout(8),
    "Mono10": _Layout(10),
    "Mono12": _Layout(12),
    "Mono14": _Layout(14),
    "Mono16": _Layout(16),
    "BGR8": _Layout(8, 3),
    "RGB8": _Layout(8, 3, reds_first=True),
    "BGRa8": _Layout(8, 4),
    "RGBa8": _Layout(8, 4, reds_first=True),
}
"""Unpacked formats, grey first. Bayer patterns are no grey levels, packed ones differ from maker to maker."""


def readable(formats: Sequence[str]) -> tuple[str, ...]:
    """Select from `formats` the names that `decode` can read, grey ones first, and of these fewer bits first."""
    return tuple(name for name in _LAYOUTS if name in formats)


def is_grey(name: str) -> bool:
    """Whether a pixel format of this name is grey and can be read."""
    return name in _LAYOUTS and _LAYOUTS[name].channels == 1


def decode(data: NDArray[Any], name: str, width: int, height: int, channel: Channel | None = None) -> Picture:
    """Decode a camera's buffer in the pixel format `name` to grey levels (height, width).

    Grey of 8 or 16 bits is the buffer itself.

    Parameters
    ----------
    data
        The buffer, flat: bytes, or uint16 where the format has more than 8 bits.
    channel
        As in :func:`core.acquire.grey.to_grey`.

    Raises
    ------
    WrongValue
        If the format cannot be read, or the buffer is too short.
    """
    layout = _LAYOUTS.get(name)
    if layout is None:
        raise WrongValue(Message("camera.pixel_format", "{name} cannot be read", name=name))
    values = data.view(np.uint8 if layout.bits == 8 else np.dtype("<u2")).ravel()
    count = width * height * layout.channels
    if len(values) < count:
        raise WrongValue(
            Message(
                "camera.picture_short",
                "{values} values are no {width} × {height} pixels of {name}",
                values=len(values),
                width=width,
                height=height,
                name=name,
            )
        )
    if layout.channels == 1:
        return full_range(values[:count].reshape(height, width), layout.bits)
    colour = values[:count].reshape(height, width, layout.channels)[:, :, :3]
    return to_grey(np.ascontiguousarray(colour[:, :, ::-1] if layout.reds_first else colour), channel)


def full_range(grey: NDArray[Any], bits: int) -> Picture:
    """Scale grey levels of `bits` bits to 16 bits, white to white; those of 8 or 16 bits stay as they are."""
    if bits in (8, 16):
        return grey
    wide = grey.astype(np.uint16)
    spread: Picture = (wide << np.uint16(16 - bits)) | (wide >> np.uint16(2 * bits - 16))
    return spread
