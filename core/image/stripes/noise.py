"""Noise of a pixel's grey value: read noise and shot noise.

variance(level) = read² + k·level, with k in grey levels per electron: the photon transfer line.

Structure in a picture adds to what is measured. Most of it is kept out by a mask that sees no edges along the axes and
by believing the quieter tiles. Small squares leave no tile quiet, but some places of 3 × 3 px are flat: what a plane
leaves of these is χ² with six degrees of freedom about σ², and the lowest peak of it is at σ².

References
----------
Immerkær, J., Fast noise variance estimation, CVIU 64 (1996), doi:10.1006/cviu.1996.0060: the mask that sees neither
constant, slope nor straight edges along the axes.
EMVA 1288, release 4.0: photon transfer from pairs of pictures.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray

from core.model.arrays import Array

_MASK = np.array([[1, -2, 1], [-2, 4, -2], [1, -2, 1]], dtype=np.float32) / 6
"""Immerkær's mask over its norm 6: white noise keeps its variance."""
ROUNDING_VARIANCE = 1 / 12
"""Variance in grey levels² of rounding to whole ones: no digital picture is better."""

# Held by tests/image/stripes/test_extraction.py (noise is estimated) on pictures of known noise.
_TILE = 16  # px: side of a tile
_MOST_TILES = 4000  # tiles looked at, about; more take time and tell nothing new
_LEAST_PER_LEVEL, _MOST_LEVELS = 20, 16  # tiles of one grey level; levels of the photon transfer line
_QUIET_QUANTILE = 0.4  # of the variances at one level: texture can only add to them
_QUARTER = 0.3186  # standard deviations that the quieter quarter of Gaussian noise is within
_STRUCTURED = 1.5  # times another estimate's variance: noise alone never reaches 1.2 over a picture's tiles
_LEAST_CONTRAST = 20.0  # times the noise between darkest and brightest level; with less no slope is fitted
_LEAST_APART = 0.05  # share of that range between two levels that give a slope
_MOST_PLACES = 300_000  # of 3 × 3 px looked at, about
_COARSER = 3  # times as far apart each way are the few places that show whether all are to be looked at
_PERHAPS_STRUCTURED = 1.2  # times the variance of a few flat places: with less structure cannot be what rules
_GROUPS, _LEAST_PER_GROUP = 32, 200  # of places by their grey level: few of them are flat, and these are alike
_BIN, _SMOOTH = 0.05, 0.2  # of the logarithm of a variance: χ² of six degrees of freedom is 0.6 wide
_PEAK = 0.05  # of the highest peak's height: a lower one is chance
_LOWER = 0.06  # share of the groups below the line of the flat ones
_SAME_LINE = 1.7  # times its variance: a group of more is no flat one
_BACKGROUND_PX = 15  # side of the mean that a difference of two pictures is freed of


@dataclass(frozen=True, slots=True)
class Compression:
    """Errors of the grey values of a picture by compression, all alike along a block, so that no scatter shows them.

    Parameters
    ----------
    grey
        Standard deviation of each term of a block in grey levels, per px of a grid as fine as the picture's; 0 for
        none.
    block_px
        Side of a block in px of the picture.
    assumed
        What the compression loses is not known: `grey` is what is usual.
    """

    grey: float = 0.0
    block_px: float = 8.0
    assumed: bool = False

    def __post_init__(self) -> None:
        if not (np.isfinite(self.grey) and self.grey >= 0):
            raise ValueError(f"compression leaves {self.grey} grey levels, not zero or positive")
        if not (np.isfinite(self.block_px) and self.block_px > 0):
            raise ValueError(f"blocks of {self.block_px} px are not positive")


UNCOMPRESSED: Final = Compression()


@dataclass(frozen=True, slots=True)
class NoiseModel:
    """Noise of one pixel, in grey levels of the picture it is used for.

    Parameters
    ----------
    read_grey
        Standard deviation where the picture is dark (grey value 0): read noise, rounding, and in a difference of two
        pictures also the shot noise of whatever light both have in common.
    grey_per_electron
        Shot noise: variance per grey level of signal. 0 when it is not known.
    compression
        What compression leaves the picture off. It takes noise away and shifts what is left.
    """

    read_grey: float
    grey_per_electron: float = 0.0
    compression: Compression = UNCOMPRESSED

    def __post_init__(self) -> None:
        if not (np.isfinite(self.read_grey) and self.read_grey > 0):
            raise ValueError(f"read_grey is {self.read_grey}, not positive")
        if not (np.isfinite(self.grey_per_electron) and self.grey_per_electron >= 0):
            raise ValueError(f"grey_per_electron is {self.grey_per_electron}, not zero or positive")

    def variance(self, level: Array) -> Array:
        """Compute the variance in grey levels² at grey values `level` (any shape)."""
        variance: Array = self.read_grey**2 + self.grey_per_electron * np.maximum(level, 0)
        return variance

    def of_difference(self, common_grey: float = 0.0) -> NoiseModel:
        """Compute the noise of picture − reference, both with this noise and `common_grey` of light."""
        return NoiseModel(
            float(np.sqrt(2 * self.read_grey**2 + 2 * self.grey_per_electron * max(common_grey, 0.0))),
            self.grey_per_electron,
            replace(self.compression, grey=float(np.sqrt(2)) * self.compression.grey),
        )


def estimate_noise(picture: NDArray[np.float32], ignore: NDArray[np.bool_] | None = None) -> NoiseModel:
    """Estimate the noise of one picture (H, W) from those of its tiles that have the least structure.

    Texture can only add to what is measured, so the quieter half of the tiles of each grey level is believed. Where
    structure is in every tile (small squares, edges all over) it still rules their mean squares; then the quieter
    quarter of each tile's pixels or the flat places are believed instead, which are less exact for noise alone.
    Where the picture has too few levels for a slope (a difference picture), the shot noise comes out as zero and
    `read_grey` is the scatter of the background.
    """
    residual = np.asarray(cv2.filter2D(picture, cv2.CV_32F, _MASK), dtype=np.float32)
    level, variance, quiet = _tile_statistics((picture,), residual, ignore)
    middle = float(np.median(level)) if level.size else 0.0
    noise = free_of_structure(_photon_transfer(level, variance), _photon_transfer(level, quiet), middle)
    stride = max(1, int(np.sqrt(picture.size / _MOST_PLACES)))
    few = _flat_places(picture, ignore, _COARSER * stride)  # most pictures have no such structure: a tenth of the time
    if few is not None and _times(noise, few, middle) <= _PERHAPS_STRUCTURED:
        return noise
    flat = _flat_places(picture, ignore, stride)
    return noise if flat is None else free_of_structure(noise, flat, middle)


def free_of_structure(noise: NoiseModel, other: NoiseModel, level: float) -> NoiseModel:
    """Return `other` if it is so much lower at a grey `level` that `noise` holds structure; else `noise`."""
    return other if _times(noise, other, level) > _STRUCTURED else noise


def _times(noise: NoiseModel, other: NoiseModel, level: float) -> float:
    """Variance of one model over that of another one at a grey level."""
    at = np.array([level])
    return float(noise.variance(at)[0] / other.variance(at)[0])


def estimate_noise_of_pair(
    first: NDArray[np.float32], second: NDArray[np.float32], ignore: NDArray[np.bool_] | None = None
) -> NoiseModel:
    """Estimate the noise of one picture (H, W) from its difference to another of the same still scene.

    Raises ValueError if their shapes differ.
    """
    if first.shape != second.shape:
        raise ValueError(f"the pictures of a pair differ in size: {first.shape} and {second.shape}")
    difference = first - second  # one picture of floats at a time: each is as large as four of a camera's
    difference /= np.float32(np.sqrt(2))
    difference -= cv2.blur(difference, (_BACKGROUND_PX, _BACKGROUND_PX))
    level, variance, _ = _tile_statistics((first, second), difference, ignore)
    return _photon_transfer(level, variance)


def _tile_statistics(
    pictures: Sequence[NDArray[np.float32]], residual: NDArray[np.float32], ignore: NDArray[np.bool_] | None
) -> tuple[Array, Array, Array]:
    """Mean level of one picture or two, variance of the residual, and that by its quieter quarter, one value a tile."""
    rows, columns = (size // _TILE for size in residual.shape)
    if rows == 0 or columns == 0:
        return np.zeros(1), np.array([float(np.var(residual))]), np.array([float(np.var(residual))])

    def tiles(values: NDArray[Any]) -> NDArray[Any]:
        whole = values[: rows * _TILE, : columns * _TILE].reshape(rows, _TILE, columns, _TILE)
        return whole.transpose(0, 2, 1, 3)

    stride = max(1, rows * columns // _MOST_TILES)
    keep = np.ones(rows * columns, dtype=bool) if ignore is None else ~tiles(ignore).any(axis=(2, 3)).ravel()
    keep &= np.arange(keep.size) % stride == 0
    kept = np.nonzero(keep.reshape(rows, columns))

    def of_kept(values: NDArray[np.float32]) -> NDArray[np.float32]:
        return tiles(values)[kept].reshape(-1, _TILE * _TILE)

    mean = sum(map(of_kept, pictures[1:]), of_kept(pictures[0])) / np.float32(len(pictures))
    level = np.asarray(mean, dtype=np.float64).mean(axis=1)
    deviation = of_kept(residual)
    if not len(deviation):
        return level, np.zeros(0), np.zeros(0)
    quarter = deviation.shape[1] // 4
    quiet = np.partition(np.abs(deviation), quarter, axis=1)[:, quarter].astype(np.float64) / _QUARTER
    return level, (deviation.astype(np.float64) ** 2).mean(axis=1), quiet**2


def _photon_transfer(level: Array, variance: Array) -> NoiseModel:
    """The line variance = read² + k·level through the quieter half of the tiles at each level."""
    if level.size == 0:
        return NoiseModel(float(np.sqrt(ROUNDING_VARIANCE)))
    order = np.argsort(level)
    groups = [g for g in np.array_split(order, min(_MOST_LEVELS, max(1, level.size // _LEAST_PER_LEVEL))) if g.size]
    levels = np.array([np.median(level[g]) for g in groups])
    variances = np.array([np.quantile(variance[g], _QUIET_QUANTILE) for g in groups])
    slope = 0.0
    if levels[-1] - levels[0] > _LEAST_CONTRAST * np.sqrt(max(variances[0], ROUNDING_VARIANCE)):
        # Theil–Sen: texture spoils some of the levels upwards
        i, j = np.triu_indices(len(levels), 1)
        apart = levels[j] - levels[i] > _LEAST_APART * (levels[-1] - levels[0])
        slope = max(0.0, float(np.median((variances[j] - variances[i])[apart] / (levels[j] - levels[i])[apart])))
    floor = np.median(variances - slope * np.maximum(levels, 0))
    return NoiseModel(float(np.sqrt(max(float(floor), ROUNDING_VARIANCE))), slope)


def _flat_places(picture: NDArray[np.float32], ignore: NDArray[np.bool_] | None, stride: int) -> NoiseModel | None:
    """The noise of the flat places of a picture, of those `stride` px apart; None if too few are not clipped."""
    level, variance = _places(picture, ignore, stride)
    if level.size < _LEAST_PER_GROUP * _GROUPS:
        return None
    groups = np.array_split(np.argsort(level), _GROUPS)
    levels = np.array([(level[g[(len(g) - 1) // 2]] + level[g[len(g) // 2]]) / 2 for g in groups])  # in order: medians
    variances = np.array([_lowest_peak(np.log(variance[g])) for g in groups]) - ROUNDING_VARIANCE
    return _lower_line(np.maximum(levels, 0.0), np.maximum(variances, ROUNDING_VARIANCE))


def _places(picture: NDArray[np.float32], ignore: NDArray[np.bool_] | None, stride: int) -> tuple[Array, Array]:
    """Mean level of places of 3 × 3 px, each `stride` px from the next, and the variance that a plane leaves of each.

    None of those that touch the darkest or the brightest value, where noise may be clipped, or what is to be ignored;
    none at all where these are half of the places or more.
    """
    from core.image.stripes.flat_places import flatness, unclipped  # compiled: takes time that most never need

    rows, columns = (size - 2 for size in picture.shape)
    if min(rows, columns) < 1:
        return np.zeros(0), np.zeros(0)
    keep = unclipped(picture, stride, float(picture.min()), float(picture.max()))
    if ignore is not None:
        keep &= ~ignore[1 : 1 + rows : stride, 1 : 1 + columns : stride]
    count = np.count_nonzero(keep)
    if count < keep.size / 2:
        return np.zeros(0), np.zeros(0)
    # whole grey levels would give peaks of their own; what this adds is taken off again
    added = np.random.default_rng(0).random((9, count))
    return flatness(picture, stride, keep, added)


def _lowest_peak(logarithms: Array) -> float:
    """Variance at the lowest peak of the density of its logarithms that is one of any height."""
    low, high = float(logarithms.min()) - 1, float(logarithms.max()) + 1
    count, edges = np.histogram(logarithms, int((high - low) / _BIN) + 1, (low, high))
    reach = np.arange(-4 * _SMOOTH, 4 * _SMOOTH + _BIN / 2, _BIN)
    density = np.convolve(count, np.exp(-0.5 * (reach / _SMOOTH) ** 2), "same")
    peak = (density[1:-1] >= density[:-2]) & (density[1:-1] > density[2:]) & (density[1:-1] > _PEAK * density.max())
    first = int(np.argmax(peak)) + 1 if peak.any() else int(np.argmax(density))
    return float(np.exp(0.5 * (edges[first] + edges[first + 1])))


def _lower_line(levels: Array, variances: Array) -> NoiseModel:
    """The photon transfer line along the lower side of groups: most may be of edges, the flat ones are on one line."""
    i, j = np.triu_indices(len(levels), 1)
    apart = levels[j] - levels[i] > _LEAST_CONTRAST * np.sqrt(ROUNDING_VARIANCE)
    i, j = i[apart], j[apart]
    slopes = np.concatenate(
        [np.zeros(len(levels)), np.maximum((variances[j] - variances[i]) / (levels[j] - levels[i]), 0)]
    )
    floors = np.concatenate([variances, variances[i]]) - slopes * np.concatenate([levels, levels[i]])
    slopes, floors = slopes[floors >= ROUNDING_VARIANCE], floors[floors >= ROUNDING_VARIANCE]
    if not len(floors):
        return NoiseModel(float(np.sqrt(ROUNDING_VARIANCE)))
    above = np.log(variances / (floors[:, None] + slopes[:, None] * levels))
    best = int(np.argmin(np.where(above > 0, _LOWER * above, (_LOWER - 1) * above).sum(axis=1)))
    times = np.exp(above[best])
    raised = float(np.median(times[times < _SAME_LINE]))
    return NoiseModel(float(np.sqrt(max(raised * floors[best], ROUNDING_VARIANCE))), raised * float(slopes[best]))
