"""Seeds: places where a stripe may be, from a coarse search of a picture.

A stripe that stands out of the noise pixel by pixel shows in a few rows and columns, so only those are read
(`sparse_crests`): the cost is that of a tenth of the picture. A fainter one shows in the picture averaged over blocks
(`coarse_crests`), which reads all of it. Neither says more than that a place is worth tracing from.
"""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled
from core.image.stripes.tracing.ridge import ridge_response
from core.model.arrays import Array
from core.model.small_arrays import new_single_table, new_table

Picture = NDArray[np.float32] | NDArray[np.int16]

# The coarse search, which reads the whole picture.
_COARSE_BLUR = 1.0  # blocks: σ of the blur
_COARSE_SHARE = 0.55  # of its response that a crest between two blocks keeps at least

# The sparse search, which reads a few rows and columns. Chosen for speed with no stripe lost: tests/image/stripes/
# test_extraction.py and the recall of `make bench` hold them.
_BOX, _ROW_STEP, _BACKGROUND_DISTANCE = 1.5, 1.5, 3.5  # stripe σ: width of the mean, step of rows, background beside it
_SPACING = 7.0  # filter σ between rows (columns): the shortest run that counts, 12 of them with its ends, crosses one
_SPARSE_SHARE = 0.4  # of its height that a stripe between two rows, blurred by the box, keeps at least
_SPARSE_NOISE = 5.0  # times the noise of a second difference of single pixels' means

_SEGMENT = 32  # numbers whose largest is looked for at once; chosen by speed


def seeds(picture: Picture, stripe_px: float, filter_px: float, high: float, noise_grey: float) -> Array:
    """Find places (K, 2) u, v in px from which stripes may be traced, those of the strongest light first.

    Stripes of σ `stripe_px` and at least `high` grey levels are among them; `noise_grey` is the scatter of a pixel.
    """
    box = max(1, round(_BOX * stripe_px))
    if _SPARSE_SHARE * high >= _SPARSE_NOISE * noise_grey / math.sqrt(box):
        found = sparse_crests(picture, stripe_px, filter_px, _SPARSE_SHARE * high)
    else:
        block = max(1, round(stripe_px))
        expected = ridge_response(high, stripe_px / block, math.hypot(_COARSE_BLUR, 12**-0.5))
        found = coarse_crests(picture, block, _COARSE_SHARE * expected)
        found[:, :2] = (found[:, :2] + 0.5) * block - 0.5
    order = np.argsort(-found[:, 2], kind="stable")
    return np.asarray(found[order, :2])


def sparse_crests(picture: Picture, stripe_px: float, filter_px: float, threshold: float) -> Array:
    """Find crests above `threshold` grey levels on a few rows and columns: (K, 3) u, v in pixels, height."""
    box, apart = max(1, round(_BOX * stripe_px)), math.ceil(_BACKGROUND_DISTANCE * stripe_px)
    every = max(box, int(_SPACING * filter_px))
    step = max(1, round(_ROW_STEP * stripe_px))
    limit = np.float32(2 * box * threshold)
    upright = _maxima(_crest_of_rows(picture, every, box, apart), limit)
    flat = _maxima(_crest_of_columns(picture, every, box, step, math.ceil(apart / step)), limit)
    middle = 0.5 * (box - 1)
    return np.concatenate(
        [
            np.column_stack([upright[:, 1] + middle, upright[:, 0] * every, upright[:, 2]]),
            np.column_stack([flat[:, 0] * every + middle, flat[:, 1] * step, flat[:, 2]]),
        ]
    )


def coarse_crests(picture: Picture, block: int, threshold: float) -> Array:
    """Find crests of the picture averaged over blocks of `block` px and blurred: (K, 3) column, row, response."""
    height, width = (size // block for size in picture.shape)
    whole = picture[: height * block, : width * block].astype(np.float32, copy=False)
    blocks = np.asarray(cv2.resize(whole, (width, height), interpolation=cv2.INTER_AREA), dtype=np.float32)
    blocks = np.asarray(cv2.GaussianBlur(blocks, (0, 0), _COARSE_BLUR), dtype=np.float32)
    crests: Array = _crests(blocks, np.float32(threshold))
    return crests


@compiled(fastmath=True)
def _crest_of_rows(picture: Picture, every: int, box: int, apart: int) -> NDArray[np.float32]:
    """Sums over `box` px of every `every`-th row, twice, less those `apart` px to either side; (R, W)."""
    height, width = picture.shape
    inner = max(0, width - box + 1 - 2 * apart)
    sums, crest = np.empty(width, np.float32), np.zeros(((height - 1) // every + 1, width), np.float32)
    left, middle, right = sums[:inner], sums[apart : apart + inner], sums[2 * apart : 2 * apart + inner]
    for j in range(len(crest)):
        line, out = picture[j * every], crest[j, apart : apart + inner]
        for i in range(width):
            sums[i] = line[i]
        for k in range(1, box):
            shifted = line[k:]
            for i in range(width - k):
                sums[i] += np.float32(shifted[i])
        for i in range(inner):
            out[i] = 2 * middle[i] - left[i] - right[i]
    return crest


@compiled(fastmath=True)
def _crest_of_columns(picture: Picture, every: int, box: int, step: int, apart: int) -> NDArray[np.float32]:
    """The same of every `every`-th column, `box` px wide, read every `step` px; `apart` counts such steps. (C, J)."""
    height, width = picture.shape
    rows, columns = (height - 1) // step + 1, max(0, (width - box) // every)
    sums, crest = np.zeros((rows, columns), np.float32), np.zeros((rows, columns), np.float32)
    for j in range(rows):
        here = sums[j]
        for i in range(box):
            line = picture[j * step, i:]
            for k in range(columns):
                here[k] += np.float32(line[k * every])
    for j in range(apart, rows - apart):
        above, here, below, out = sums[j - apart], sums[j], sums[j + apart], crest[j]
        for k in range(columns):
            out[k] = 2 * here[k] - above[k] - below[k]
    turned = new_single_table(columns, rows)
    for k in range(columns):
        for j in range(rows):
            turned[k, j] = crest[j, k]
    return turned


@compiled(fastmath=True)
def _maxima(crest: NDArray[np.float32], limit: np.float32) -> Array:
    """Values above `limit` (≥ 0) that are a maximum along their row: (K, 3) row, place, value."""
    rows, width = crest.shape
    worth = np.zeros((rows, width // _SEGMENT + 1), dtype=np.bool_)
    number = 0
    for j in range(rows):
        for k in range(width // _SEGMENT + 1):
            highest = np.float32(0)
            for i in range(k * _SEGMENT, min((k + 1) * _SEGMENT, width)):
                highest = max(highest, crest[j, i])
            worth[j, k] = highest > limit
            number += bool(highest > limit)
    found, count = np.empty((number * _SEGMENT, 3)), 0
    for j in range(rows):
        line = crest[j]
        for k in range(width // _SEGMENT + 1):
            if not worth[j, k]:
                continue
            for i in range(max(k * _SEGMENT, 1), min((k + 1) * _SEGMENT, width - 1)):
                if line[i] > limit and line[i] >= line[i - 1] and line[i] > line[i + 1]:
                    found[count, 0], found[count, 1], found[count, 2] = j, i, line[i]
                    count += 1
    return found[:count]


@compiled(fastmath=True)
def _crests(blocks: NDArray[np.float32], threshold: np.float32) -> Array:
    """Blocks that are a ridge stronger than `threshold` and a maximum across it: (K, 3) column, row, response."""
    height, width = blocks.shape
    found, count = new_table(1024, 3), 0
    for j in range(1, height - 1):
        for i in range(1, width - 1):
            here = blocks[j, i]
            uu = blocks[j, i - 1] + blocks[j, i + 1] - 2 * here
            vv = blocks[j - 1, i] + blocks[j + 1, i] - 2 * here
            if uu + vv > -threshold:
                continue
            uv = 0.25 * (blocks[j - 1, i - 1] + blocks[j + 1, i + 1] - blocks[j - 1, i + 1] - blocks[j + 1, i - 1])
            half = 0.5 * (uu - vv)
            response = math.sqrt(half * half + uv * uv) - 0.5 * (uu + vv)
            if response < threshold:
                continue
            if uu < vv:  # the line is closer to upright
                if blocks[j, i - 1] > here or blocks[j, i + 1] > here:
                    continue
            elif blocks[j - 1, i] > here or blocks[j + 1, i] > here:
                continue
            if count == len(found):
                more = new_table(2 * count, 3)
                for k in range(count):
                    more[k, 0], more[k, 1], more[k, 2] = found[k, 0], found[k, 1], found[k, 2]
                found = more
            found[count, 0] = i
            found[count, 1] = j
            found[count, 2] = response
            count += 1
    return found[:count]
