"""What is wrong with the pictures of a scan themselves: compression, a colour mosaic, speckle, gloss, changing light.

Each leaves stripes off, or less sure than what else is told of them; the sweeps then disagree as if something had
moved. So a scan that is refused is told first what its pictures show.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from core.findings.table import note_of
from core.image.mosaic import PERIOD_PX, is_interpolated
from core.image.stripes.centreline import Centreline
from core.image.stripes.noise import NoiseModel
from core.image.stripes.precision import response_noise
from core.image.stripes.stripe import filter_for
from core.messages import Message
from core.scan.features.reference import Picture, ReferenceFeatures
from core.scan.first_cause import Reason, Suspect

SPECKLED_SHARE = 0.08
"""Scatter of the brightness along the fan's lines, as a share of it, from which on it is told: between what fine
stripes (σ 1.1 px) have at a contrast of 0.18 (0.054, ± 0.004 between seeds) and of 0.35 (0.108 ± 0.006)."""
FINEST_PX = 1.6
"""σ of a stripe from which on pictures interpolated from a colour mosaic show it as sure as it says: within 1° of the
rows it is off by 13 times its σ at 1.0 px, by 3.2 times at 1.3 px, and by 1.2 times from here on, at any angle."""
_UNEVEN = 2.5
"""Times the laser's light at one place of a mosaic's tile over another's from which on it is one. Sites of another
colour see less than a sixth of a laser's light; a stripe of σ 0.5 px, half a px aside, gives 1.6 at most."""
_ENOUGH = 30
"""Points at each place of the tile that are wanted for that."""
_OUTLYING = 0.02
"""Share of the largest differences that are passed by: edges, marks, where another stripe crosses."""
_CLEAR = 10.0
"""Heights of a stripe's points over their noise from which on they count."""


class Mosaic(NamedTuple):
    """Trace that a camera's colour mosaic leaves in the fan's stripes, in an interpolated picture or in a raw one.

    `width_px` is their width if they are below FINEST_PX and it is interpolated, `uneven` the least and most light of
    the fan by its sites' place in the tiles if it is raw; None if not.
    """

    width_px: float | None
    uneven: tuple[float, float] | None

    @property
    def too_fine(self) -> bool:
        """Whether the fan's stripes are too fine for the tiles of the camera's colour mosaic."""
        return self.width_px is not None or self.uneven is not None


def mosaic_of(fan: Sequence[Centreline], base: Picture) -> Mosaic:
    """Look for the trace of a colour mosaic along the fan's stripes in the picture `base` (H, W)."""
    if not fan:
        return Mosaic(None, None)
    return Mosaic(_width_if_interpolated(fan, base), _unevenness(fan, base))


def faults_of(reference: ReferenceFeatures, mosaic: Mosaic) -> tuple[Message, ...]:
    """Make notes on compression, `mosaic` and speckle that are faults of the picture with the fan alone; else ()."""
    noise = reference.noise
    return (*notes_on_compression(noise), *_notes_on_mosaic(mosaic, noise), *_notes_on_speckle(reference))


def notes_on_compression(noise: NoiseModel) -> tuple[Message, ...]:
    """Make a note if the errors of the frames' compression are larger than their noise, or not known; () if not."""
    if noise.compression.assumed:
        return (note_of("scan.compression_assumed", grey=noise.compression.grey, noise=noise.read_grey),)
    if noise.compression.grey <= noise.read_grey:
        return ()
    return (note_of("scan.compressed", grey=noise.compression.grey, noise=noise.read_grey),)


def _notes_on_mosaic(mosaic: Mosaic, noise: NoiseModel) -> Iterator[Message]:
    """Notes on pictures interpolated from a colour mosaic that is too coarse for the stripes, and on raw ones."""
    if mosaic.width_px is not None:
        yield note_of("scan.colour_mosaic", width_px=mosaic.width_px, least_px=FINEST_PX)
    if mosaic.uneven is not None:
        least, most = mosaic.uneven
        yield note_of("scan.raw_mosaic", times=most / max(least, noise.read_grey))


def _width_if_interpolated(fan: Sequence[Centreline], base: Picture) -> float | None:
    """Width in px of stripes too fine for the colour mosaic that a picture is interpolated from; else None."""
    width = float(np.median(np.concatenate([piece.width for piece in fan])))
    return None if width >= FINEST_PX or not is_interpolated(base) else width


def _unevenness(fan: Sequence[Centreline], base: Picture) -> tuple[float, float] | None:
    """Least and most light of the fan by its sites' place in tiles of 2 × 2, if it differs as behind a mosaic."""
    uv = np.vstack([piece.uv[~piece.saturated] for piece in fan])
    u, v = np.rint(uv).astype(int).T
    height, width = base.shape
    u, v = np.clip(u, 0, width - 1), np.clip(v, 0, height - 1)
    light = base[v, u].astype(np.float64) - float(np.median(base[::16, ::16]))
    place = PERIOD_PX * (v % PERIOD_PX) + u % PERIOD_PX
    seen = [light[place == at] for at in range(PERIOD_PX**2)]
    if min(map(len, seen)) < _ENOUGH:
        return None
    medians = [float(np.median(each)) for each in seen]
    return None if max(medians) <= _UNEVEN * max(min(medians), 0.0) else (min(medians), max(medians))


def _notes_on_speckle(reference: ReferenceFeatures) -> tuple[Message, ...]:
    """A note on brightness that scatters along the fan's lines more than their noise explains."""
    share = _scatter(reference.fan, reference.noise)
    if share <= SPECKLED_SHARE:
        return ()
    return (note_of("scan.speckled", percent=100 * share),)


def _scatter(pieces: Sequence[Centreline], noise: NoiseModel) -> float:
    """Standard deviation of the lines' brightness beyond noise, as a share of it; 0 where nothing is bright enough.

    By how much points differ that lie one correlation length apart: not by what changes along a line.
    """
    squares, by_noise = [np.zeros(0)], [np.zeros(0)]
    for piece in pieces:
        width = float(np.median(piece.width))
        grey = response_noise(noise.read_grey, width, filter_for(width))
        lag = max(1, round(piece.correlation_px))
        clear = ~piece.saturated & (piece.strength > _CLEAR * grey)
        both = clear[lag:] & clear[:-lag]
        a, b = piece.strength[:-lag][both], piece.strength[lag:][both]
        squares.append(np.log(b / a) ** 2 / 2)
        by_noise.append(grey**2 * (1 / a**2 + 1 / b**2) / 2)
    seen = np.sort(np.concatenate(squares))
    seen = seen[: len(seen) - int(_OUTLYING * len(seen))]
    return float(np.sqrt(max(seen.mean() - np.concatenate(by_noise).mean(), 0.0))) if len(seen) else 0.0


def at_fault(faults: Sequence[Message]) -> Iterator[Reason]:
    """Yield the `faults` of a scan's pictures as one reason for a complaint about its results; nothing for none."""
    if faults:
        yield Reason(
            Suspect.PICTURES,
            lambda reason: Message(
                "scan.pictures_at_fault",
                "{faults:;} That may be why {reason}",
                faults=faults,
                reason=reason,
            ),
            Message("scan.advice_better_pictures", "mend that first, then scan again"),
        )
