"""One grey level per pixel from whatever a camera or a file gives."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from core.acquire.channel import PLAIN_CHANNELS, Channel, is_difference

_BGR: dict[str, int] = {"blue": 0, "green": 1, "red": 2}
_NONE_SHARE = 4
"""A difference of nothing is this part of the largest grey value: noise below it is not cut off."""


def has_colours(picture: NDArray[Any]) -> bool:
    """Whether a picture array has colour channels: neither (height, width), nor grey with or without alpha."""
    return picture.ndim == 3 and picture.shape[2] >= 3


def saturated_in(picture: NDArray[Any], channel: Channel | None) -> NDArray[np.bool_]:
    """Flag the pixels (height, width) of a colour picture saturated in one of the colours that `channel` is made of."""
    names = PLAIN_CHANNELS if channel is None else channel.split("-")
    return np.asarray((picture[:, :, [_BGR[name] for name in names]] == np.iinfo(picture.dtype).max).any(axis=2))


def to_grey(picture: NDArray[Any], channel: Channel | None = None) -> NDArray[Any]:
    """Compute grey levels (height, width) of a picture in OpenCV's order of colours: its `channel`, or all weighted.

    Parameters
    ----------
    picture
        (height, width), or (height, width, 1 … 4): grey, grey with alpha, BGR, BGR with alpha.
    channel
        The channel of a colour picture to take; without it, colour is reduced to 0.299 R + 0.587 G + 0.114 B. A
        difference has a quarter of the largest grey value added, and that largest value where either is saturated.
    """
    if picture.ndim == 2:
        return picture
    if picture.shape[2] == 1:
        return picture[:, :, 0]
    if picture.shape[2] == 2:
        return np.ascontiguousarray(picture[:, :, 0])
    if channel is not None and is_difference(channel):
        return _difference(picture, *channel.split("-"))
    if channel is not None:
        return np.ascontiguousarray(picture[:, :, _BGR[channel]])
    grey: NDArray[Any] = cv2.cvtColor(picture[:, :, :3], cv2.COLOR_BGR2GRAY)
    return grey


def _difference(picture: NDArray[Any], first: str, second: str) -> NDArray[Any]:
    white = int(np.iinfo(picture.dtype).max)
    more, less = (np.ascontiguousarray(picture[:, :, _BGR[name]]) for name in (first, second))
    shifted = np.clip(more.astype(np.int32) - less + white // _NONE_SHARE, 0, white)
    difference: NDArray[Any] = shifted.astype(picture.dtype)
    difference[(more == white) | (less == white)] = white
    return difference
