"""Watch of the fan's light over a scan: what moved, in which frame, and how far.

The fan and the object stand still, and every frame shows the fan's light. A stretch of it that lies elsewhere than in
the reference says that the surface under it, the camera or the fan has moved; hundreds of stretches over tens of frames
see a hundredth of a pixel, long before crossings between sweeps disagree. The frames are split where the sum of the
absolute deviations from the medians before and after is least, again and again while both sides differ by more than
chance and by more than MOVED_PX.

A rig that warms moves evenly, not at once: where straight lines through the shifts leave less than the parts do, it is
a drift, and no frame is better than another.

References
----------
Scott, A. J., Knott, M., A cluster analysis method for grouping means in the analysis of variance, Biometrics 30 (1974),
doi:10.2307/2529204 (binary segmentation).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.findings.table import note_of
from core.messages import Message
from core.model import Camera, Fan
from core.model.arrays import Array
from core.model.robust import mad_sd
from core.scan.between_frames import Between, between
from core.scan.features.crossings import Index
from core.scan.features.extraction import ScanFeatures
from core.scan.features.reference import fan_stretches
from core.scan.sweeps.fan_lines import UNASSIGNED, FanLines

# What counts as a movement. Held by tests/scan/test_fan_watch.py on scans in which nothing moved and in which something
# did.
MOVED_PX = 0.02
"""RMS shift of the stretches that moved, in px, from which on it matters: a tenth of a centreline's noise."""
LEAST_FRAMES = 3
"""Frames on either side of a movement: a hand in the light for a moment is none."""
LEAST_STRETCHES = 3
"""Stretches that must have moved, each by SURELY of its own noise."""
SURELY = 5.0
"""Standard deviations by which a stretch has surely moved."""
LEAST_NOISE_PX = 2e-3
"""No median of a stretch over frames is known better."""
_PLACES = 60
"""Places tried, about, in a long scan; then those about the best. Chosen by the time it takes."""
NEARLY_ALL = 0.8
"""Share of the stretches that moved from which on it was not the part alone: table, camera or fan."""

MOVED_SHARE = 0.2
"""Share of the stretches that must have moved by MOVED_PX for it to matter, where single ones are too noisy to tell."""

PART_WORDS = Message("scan.the_part", "the part")
EVERYTHING_WORDS = Message("scan.everything", "the camera, the fan, or the table with the part")


WARM_UP = Message("scan.advice_warm_up", "let camera and lasers warm up, then scan again")


@dataclass(frozen=True, eq=False, slots=True)
class FanRest:
    """Movements of the part and of the rig during a scan, as the fan's light shows them.

    Parameters
    ----------
    at_rest
        (F,) the frames that agree with the reference; all where nothing moved.
    movements
        Between which frames that see the fan's light it moved, in order.
    shift_px, shift_mm, share
        Of the stretches that moved: median shift in the picture and in depth, and how many of all they are.
    drifts
        Whether all of it lies evenly farther aside from frame to frame, from the first to the last: nothing moved at
        once, and all frames are used.
    frames, stretches
        In how many frames how many of its stretches are watched.
    shifts
        What was watched, as of `fan_shifts`; None where that is not kept.
    """

    at_rest: NDArray[np.bool_]
    movements: tuple[Between, ...] = ()
    shift_px: float = 0.0
    shift_mm: float = 0.0
    share: float = 0.0
    drifts: bool = False
    frames: int = 0
    stretches: int = 0
    shifts: tuple[Index, Array, Array] | None = None

    @property
    def known(self) -> bool:
        """Whether the fan's light is watched in enough frames, and enough places, to show a movement or a drift."""
        return self.frames >= 2 * LEAST_FRAMES and self.stretches >= LEAST_STRETCHES

    @property
    def unsteady(self) -> bool:
        """Whether part or rig has moved, at once or gradually."""
        return bool(self.movements) or self.drifts

    @property
    def what_moved(self) -> Message:
        """Name of what has moved: the part or, if nearly all of the fan's light has shifted, camera, fan or table."""
        return EVERYTHING_WORDS if self.share > NEARLY_ALL else PART_WORDS

    def possible(self, movements: Sequence[Between]) -> tuple[Between, ...]:
        """Select those of the `movements`, in order, that the watched light does not surely deny."""
        if self.shifts is None:
            return tuple(movements)
        seen, shifts, noise_px = self.shifts
        return possible_movements(movements, seen, shifts, np.maximum(noise_px, LEAST_NOISE_PX))

    def note(self, names: Sequence[str], frames: int) -> tuple[Message, ...]:
        """Make a note for the technician if part or rig moved, or if too little light was watched to know; else ().

        `names` are those of all frames, `frames` is how many of them are used.
        """
        if not self.known:
            return (note_of("scan.rest_not_judged", n=self.frames, stretches=self.stretches, least=2 * LEAST_FRAMES),)
        if self.drifts:
            return (note_of("scan.drifted", shift_px=self.shift_px, shift_mm=self.shift_mm),)
        if not self.movements:
            return ()
        return (
            note_of(
                "scan.fan_shifted",
                what=self.what_moved,
                when=between(names, self.movements),
                percent=100 * self.share,
                shift_px=self.shift_px,
                shift_mm=self.shift_mm,
                n=frames,
            ),
        )


def watch_fan(
    features: ScanFeatures, lines: FanLines, camera: Camera, fan: Fan, printed: NDArray[np.bool_] | None = None
) -> FanRest:
    """Find when part or rig moved during a scan, by shifts of the fan's light in its frames since the reference.

    Those of its centrelines that are `printed` (P,) on boards are not watched.
    """
    count = len(features.frames)
    known, shifts, noise = fan_shifts(features, printed)
    everything = np.ones(count, dtype=np.bool_)
    at_rest = FanRest(everything, frames=len(known), stretches=shifts.shape[1], shifts=(known, shifts, noise))
    if not at_rest.known:
        return at_rest
    level = np.maximum(noise, LEAST_NOISE_PX)
    splits = sorted(_splits(shifts, level, 0))
    if not splits:
        return at_rest
    parts = np.split(np.arange(len(known)), splits)
    per_px = _depth_per_px(features, lines, camera, fan)[_light(features, printed)]
    drift, left = _drift(shifts, known, level)
    if left < sum(_spread(shifts[part], level) for part in parts):
        aside_px, aside_mm = _median(np.abs(drift)), _median(np.abs(drift * per_px))
        return replace(at_rest, shift_px=aside_px, shift_mm=aside_mm, share=1.0, drifts=True)
    middles = np.array([np.median(shifts[part], axis=0) for part in parts])
    off = np.sqrt(np.mean(middles**2, axis=1))
    rest = int(np.argmin(off))
    same = np.array(
        [not _moved(middles[rest], one, noise, len(part)) for one, part in zip(middles, parts, strict=True)]
    )
    resting = np.ones(count, dtype=np.bool_)
    for part, still in zip(parts, same, strict=True):
        resting[known[part[0]] : known[part[-1]] + 1] = still
    farthest = int(np.argmax(off))
    change = middles[farthest] - middles[rest]
    moved = np.abs(change) > np.maximum(SURELY * noise / np.sqrt(len(parts[farthest])), MOVED_PX)
    in_depth = np.abs(change * per_px)[moved]
    return replace(
        at_rest,
        at_rest=resting,
        movements=tuple(Between(int(known[split - 1]), int(known[split])) for split in splits),
        shift_px=_median(np.abs(change[moved])),
        shift_mm=_median(in_depth),
        share=float(np.mean(moved)),
    )


def fan_shifts(features: ScanFeatures, printed: NDArray[np.bool_] | None = None) -> tuple[Index, Array, Array]:
    """Collect how far in px each of C stretches of the fan's light has shifted sideways in the K frames that tell.

    Returns the indices (K,) of the frames, the shifts (K, C) and the noise (C,) of each stretch, as `fan_stretches`
    cuts them, without those of centrelines that are `printed` (P,) on boards.
    """
    known = np.array([i for i, frame in enumerate(features.frames) if len(frame.fan_shifts_px)], dtype=np.int64)
    if not len(known):
        return known, np.zeros((0, 0)), np.zeros(0)
    shifts = np.array([features.frames[i].fan_shifts_px for i in known])
    if printed is not None and printed.any():
        shifts = shifts[:, _light(features, printed)]
    return known, shifts, np.array([mad_sd(step) for step in np.diff(shifts, axis=0).T]) / np.sqrt(2)


def _light(features: ScanFeatures, printed: NDArray[np.bool_] | None) -> NDArray[np.bool_]:
    """Of each stretch, whether it is of a centreline that is not `printed` (P,)."""
    of_piece = np.array([number for number, _ in fan_stretches(features.fan)], dtype=np.int64)
    return np.ones(len(of_piece), dtype=np.bool_) if printed is None else ~printed[of_piece]


def possible_movements(
    movements: Sequence[Between], seen: Index, shifts: Array, noise_px: Array
) -> tuple[Between, ...]:
    """Select those of the `movements`, in order, that the fan's light does not surely deny.

    It denies none that it shows itself, and none of which it tells too little. `seen` (K,), `shifts` (K, C) and
    `noise_px` (C,) are as of `fan_shifts`, no noise below LEAST_NOISE_PX.
    """
    shown = _splits(shifts, noise_px, 0)
    places = np.searchsorted(seen, [one.first_after for one in movements]).tolist()
    around = zip([0, *places], places, [*places[1:], len(seen)], strict=False)
    return tuple(
        one
        for one, (start, at, end) in zip(movements, around, strict=True)
        if at in shown or not _surely_at_rest(shifts[start:at], shifts[at:end], noise_px)
    )


def _surely_at_rest(before: Array, after: Array, noise: Array) -> bool:
    """Whether no stretch (K, C) has surely moved, and all of them together surely less than what matters."""
    if min(len(before), len(after)) < LEAST_FRAMES or len(noise) < LEAST_STRETCHES:
        return False
    change = np.median(after, axis=0) - np.median(before, axis=0)
    variance = np.pi / 2 * (1 / len(before) + 1 / len(after)) * noise**2
    beyond = max(0.0, float(np.sum(change**2 - variance))) + SURELY * np.sqrt(2 * np.sum(variance**2))
    any_moved = np.any(np.abs(change) > np.maximum(SURELY * np.sqrt(variance), MOVED_PX))
    return bool(not any_moved and beyond <= MOVED_SHARE * len(noise) * MOVED_PX**2)


def _splits(shifts: Array, noise: Array, first: int) -> list[int]:
    """Where the frames from `first` on split into parts whose light lies elsewhere."""
    count = len(shifts)
    if count < 2 * LEAST_FRAMES:
        return []

    def spread(k: int) -> float:
        return _spread(shifts[:k], noise) + _spread(shifts[k:], noise)

    last, stride = count - LEAST_FRAMES, max(1, count // _PLACES)
    about = min(range(LEAST_FRAMES, last + 1, stride), key=spread)
    at = min(range(max(LEAST_FRAMES, about - stride + 1), min(last, about + stride - 1) + 1), key=spread)
    before, after = shifts[:at], shifts[at:]
    if not _moved(np.median(before, axis=0), np.median(after, axis=0), noise, min(at, count - at)):
        return [first + edge for edge in _for_a_while(shifts, noise)]
    return [*_splits(before, noise, first), first + at, *_splits(after, noise, first + at)]


def _drift(shifts: Array, frames: Index, noise: Array) -> tuple[Array, float]:
    """What straight lines through the shifts (K, C) of `frames` (K,) come to over the scan (C,), and what they leave.

    The latter as `_spread` counts it.
    """
    third = max(1, len(frames) // 3)
    rise = np.median(shifts[-third:], axis=0) - np.median(shifts[:third], axis=0)
    slope = rise / (np.mean(frames[-third:]) - np.mean(frames[:third]))
    return slope * (frames[-1] - frames[0]), _spread(shifts - np.outer(frames, slope), noise)


def _median(values: Array) -> float:
    """Median of those values that are known; 0 where none is."""
    return float(np.nanmedian(values)) if np.isfinite(values).any() else 0.0


def _for_a_while(shifts: Array, noise: Array) -> list[int]:
    """Where frames begin and end that lie aside for a while within others, which no single split tells."""
    middle = np.median(shifts, axis=0)
    aside = np.array([_moved(middle, one, noise, 1) for one in shifts])
    edges = np.flatnonzero(np.diff(np.concatenate([[False], aside, [False]])))
    runs = [(begin, end) for begin, end in edges.reshape(-1, 2).tolist() if end - begin >= LEAST_FRAMES]
    return [edge for run in runs for edge in run if 0 < edge < len(shifts)]


def _spread(shifts: Array, noise: Array) -> float:
    """Sum of the absolute deviations (frames, stretches) from their medians, in standard deviations at most SURELY."""
    away = np.abs(shifts - np.median(shifts, axis=0)) / noise
    return float(np.sum(np.minimum(away, SURELY)))


def _moved(before: Array, after: Array, noise: Array, frames: int) -> bool:
    """Whether medians (C,) differ by more than chance, and by enough to matter; of so many `frames`."""
    change = np.abs(after - before)
    sure = change > np.maximum(SURELY * np.sqrt(np.pi / frames) * noise, MOVED_PX)
    return bool(np.count_nonzero(sure) >= LEAST_STRETCHES)


def _depth_per_px(features: ScanFeatures, lines: FanLines, camera: Camera, fan: Fan) -> Array:
    """Change (C,) of depth in mm by a shift of 1 px across the light; NaN where the fan's line is not known."""
    per_px = []
    for number, points in fan_stretches(features.fan):
        line = lines.line[number]
        if line == UNASSIGNED:
            per_px.append(float("nan"))
            continue
        piece, pi = features.fan[number].select(np.arange(points.start, points.stop)), fan.planes[line].pi
        rays = camera.rays(piece.uv)
        slope = camera.inverse_depth_slopes(pi, rays, piece.normal)
        per_px.append(float(np.median(slope / (rays @ pi) ** 2)))
    return np.array(per_px)
