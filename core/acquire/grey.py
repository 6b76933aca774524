"""One grey level per pixel from whatever a camera or a file gives."""

from __future__ import annotations

from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

Channel = Literal["red", "green", "blue"]

_BGR: dict[str, int] = {"blue": 0, "green": 1, "red": 2}


def to_grey(picture: NDArray[Any], channel: Channel | None = None) -> NDArray[Any]:
    """Grey levels (height, width) of a picture in OpenCV's order of colours.

    Parameters
    ----------
    picture
        (height, width), or (height, width, 1 … 4): grey, grey with alpha, BGR, BGR with alpha.
    channel
        The channel of a colour picture to take; without it, colour is reduced to 0.299 R + 0.587 G + 0.114 B.
    """
    if picture.ndim == 2:
        return picture
    if picture.shape[2] == 1:
        return picture[:, :, 0]
    if picture.shape[2] == 2:
        return np.ascontiguousarray(picture[:, :, 0])
    if channel is not None:
        return np.ascontiguousarray(picture[:, :, _BGR[channel]])
    grey: NDArray[Any] = cv2.cvtColor(picture[:, :, :3], cv2.COLOR_BGR2GRAY)
    return grey
