"""Whether the fan's stripes are skewed otherwise in a scan than in its calibration, and what that may do.

The centre fitted to a cross-section that reaches further to one side lies on that side of where the light was before.
In calibration and scan alike that does no harm: the calibrated planes are those of such centres. A lens that was
knocked or smeared since, or a laser that went over to another mode, moves all lines of the fan one way, as if it had
turned, and nothing else in a scan shows it. So the mean skewness of the scan's stripes is compared with that of the
calibration's. What the poses scatter among themselves, by depth and place, counts as chance.

Light whose third cumulant has changed by Δκ s³ has moved by at most 0.8·∛Δκ·s, the law of
`core.inspect.uncertainty.skewed_light`; a shoulder of 10 % beside a Gaussian moves the fitted centre by 0.28 of that,
one of 30 % by 0.55. Not face by face: light from below the surface shows in the cube of its depth over the section's,
and the fan's lines, at their smaller angle, are twice as deep as the sweeps', which tell that eight times as well. How
wide stripes are says nothing of where they are. Held by tests/accuracy/test_changed_section.py.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum, auto
from typing import NamedTuple

import numpy as np

from core.calibrate.deviations import Deviation, moved_fan
from core.findings.table import note_of
from core.image.stripes.centreline import Centreline
from core.messages import Message
from core.model import Camera, Fan
from core.model.arrays import Array

FARTHEST = 0.8
"""How far skewed light has moved at most, over the cube root of its third cumulant."""
SURELY = 4.0
"""Standard errors from which on stripes are surely skewed otherwise."""
LEAST = 0.03
"""Change of skewness from which on it counts: of ideal rigs at a quarter of the full size it is up to 0.03."""
_BLOCK = 50.0
"""Stripe σ, the length of a stretch whose mean skewness is one observation: it is averaged over 20 along the line."""
_FEWEST_POSES, _FEWEST_BLOCKS = 3, 6
"""Poses, and stretches of calibration and scan each, whose scatter tells how sure their mean is."""


class Section(Enum):
    """Result of comparing the skewness of the fan's stripes with the calibration's: no sure change, or not known."""

    SAME = auto()
    NOT_KNOWN = auto()


@dataclass(frozen=True, slots=True)
class ChangedSection:
    """Sure change of the mean skewness of the fan's stripes: `skewness` in the scan, `then` in the calibration.

    Both are positive away from the camera. `error` is the standard error of their difference, `shift_px` how far
    stripes lie aside by it at most.
    """

    skewness: float
    then: float
    error: float
    shift_px: float

    @property
    def note(self) -> Message:
        """Note on how much the cross-section (skewness) of the fan's stripes has changed since the calibration."""
        return note_of(
            "scan.section_changed", now=self.skewness, then=self.then, error=self.error, shift_px=self.shift_px
        )

    def deviation(self, fan: Sequence[Centreline], camera: Camera, calibrated: Fan) -> Deviation:
        """Make the deviation in which all stripes of the fan lie half of `shift_px` aside; the camera stays.

        U then contains twice as much, all that the change of section may amount to. `fan` are the scan's centrelines.
        """
        slopes = np.array([np.mean(np.abs(_slopes(fan, camera, pi))) for pi in calibrated.pis])
        step = np.zeros((calibrated.lines, 3))
        step[:, 2] = slopes * self.shift_px / 2
        return Deviation("skewed fan", camera, moved_fan(calibrated, step.ravel()))


def changed_section(
    poses: Sequence[Sequence[Centreline]], fan: Sequence[Centreline], camera: Camera, calibrated: Fan
) -> ChangedSection | Section:
    """Find whether the skewness of the `fan`'s stripes in a scan surely differs from that in its calibration's `poses`.

    `Section.SAME` where it does not; `Section.NOT_KNOWN` where there are too few poses, or the stripes are too short,
    to tell how sure their mean is.
    """
    pi = calibrated.pis[calibrated.lines // 2]
    now = _mean(_blocks(fan, camera, pi))
    then = [one for pose in poses if (one := _mean(_blocks(pose, camera, pi))).blocks >= 1]
    if now.blocks < _FEWEST_BLOCKS or len(then) < _FEWEST_POSES or sum(one.blocks for one in then) < _FEWEST_BLOCKS:
        return Section.NOT_KNOWN
    means, variances, counts = (np.array(column) for column in zip(*then, strict=True))
    own = float(np.average(variances * counts, weights=counts))  # of a single block
    mean = float(np.average(means, weights=counts))
    between = max(float(np.average((means - mean) ** 2, weights=counts)) - own * len(then) / counts.sum(), 0.0)
    error = float(np.sqrt(own / now.blocks + own / counts.sum() + between * (1 + 1 / len(then))))
    change = now.mean - mean
    if abs(change) <= max(SURELY * error, LEAST):
        return Section.SAME
    width = float(np.median(np.concatenate([line.width for line in fan])))
    return ChangedSection(now.mean, mean, error, FARTHEST * float(np.cbrt(abs(change))) * width)


class _Mean(NamedTuple):
    """Mean of blocks, the variance of that, and how many they are."""

    mean: float
    variance: float
    blocks: int


def _mean(blocks: Array) -> _Mean:
    count = len(blocks)
    return _Mean(float(blocks.mean()) if count else 0.0, float(blocks.var(ddof=1)) / count if count > 1 else 0.0, count)


def _blocks(lines: Sequence[Centreline], camera: Camera, pi: Array) -> Array:
    """Mean skewness (K,), counted away from the camera, of stretches of lines near the plane `pi`."""
    found: list[float] = []
    for line in lines:
        seen = line.select(~line.saturated)
        if not len(seen):
            continue
        skewness = -np.sign(_slopes([seen], camera, pi)) * seen.skewness
        count = int(len(seen) / (_BLOCK * float(np.median(seen.width))))
        found.extend(float(part.mean()) for part in (np.array_split(skewness, count) if count else ()))
    return np.array(found)


def _slopes(lines: Sequence[Centreline], camera: Camera, pi: Array) -> Array:
    """∂(1/z)/∂(px along the normal) (N,) of light in the plane `pi`."""
    uv = np.vstack([line.uv for line in lines])
    normal = np.vstack([line.normal for line in lines])
    return camera.inverse_depth_slopes(pi, camera.rays(uv), normal)
