"""Hot pixels: those that shine by themselves, in every picture a camera takes."""

from __future__ import annotations

import math
from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from core.image.targets.picture import Picture
from core.model.robust import MAD_TO_SD

# Held by tests/image/test_hot_pixels.py, on plates in front of a background with points of light.
_FEWEST_PICTURES = 4  # of different scenes: what stands out in fewer may be something that was seen twice
_MOST_PICTURES_SHARE = 0.75  # of the pictures; in the others it may lie on white, where nothing shines
_STANDS_OUT = 6.0  # standard deviations of a pixel about its neighbours' median, in the picture and around it
_AROUND_PX = 15  # width of what is around it: cloth and grain have pixels that stand out everywhere
_MEAN_TO_SD = 1.2533  # standard deviation over mean deviation of a Gaussian
_QUANTISED = 0.5  # 8-bit grey levels: the scatter of a picture that hardly has any
_LEAST_GREY = 4.0  # 8-bit grey levels: less disturbs nothing
_SPREAD = 0.1
"""Of what a pixel stands out, the most that the four beside it do in the mean: a point of light that a lens blurs by a
Gaussian σ of 0.5 px gives them 0.23."""


def standing_out(picture: Picture) -> NDArray[np.int64]:
    """Find pixels of a picture (H, W) too much brighter than their neighbours for blurred light: (K,) flat indices.

    Raises
    ------
    ValueError
        If it is not uint8 or uint16.
    """
    grey = 1.0 if picture.dtype == np.uint8 else 257.0
    if picture.dtype not in (np.uint8, np.uint16):
        raise ValueError(f"a picture must be uint8 or uint16, not {picture.dtype}")
    above = cv2.subtract(picture, cv2.medianBlur(picture, 5), dtype=cv2.CV_32F)
    rough = np.abs(above)
    spread = max(MAD_TO_SD * float(np.median(rough[::4, ::4])), _QUANTISED * grey)
    around = _MEAN_TO_SD * cv2.blur(np.minimum(rough, 4 * spread), (_AROUND_PX, _AROUND_PX))
    places = np.flatnonzero(above > np.maximum(_STANDS_OUT * np.maximum(around, spread), _LEAST_GREY * grey))
    height, width = picture.shape
    v, u = np.divmod(places, width)
    inside = (u > 0) & (u < width - 1) & (v > 0) & (v < height - 1)
    places, u, v = places[inside], u[inside], v[inside]
    beside = (above[v, u - 1] + above[v, u + 1] + above[v - 1, u] + above[v + 1, u]) / 4
    return np.asarray(places[beside < _SPREAD * above[v, u]], dtype=np.int64)


def hot_pixels(pictures: Sequence[NDArray[np.int64]]) -> NDArray[np.int64]:
    """Find the hot pixels, (K,) flat indices: those in nearly all of `pictures`, each a list of what stands out.

    None are found in too few pictures.
    """
    if len(pictures) < _FEWEST_PICTURES:
        return np.zeros(0, dtype=np.int64)
    places, times = np.unique(np.concatenate(pictures), return_counts=True)
    return places[times >= math.ceil(_MOST_PICTURES_SHARE * len(pictures))]
