"""What the pictures of one pose of the plane target show. Light to import: a window holds these."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from core.image.exclusion import Excludable, Reason
from core.image.stripes.centreline import Centreline
from core.image.stripes.stripe import CONTRAST_QUANTILE, WIDTH_IN_SIGMA, StripeSettings
from core.image.targets.target_view import TargetView
from core.messages import Message

MOVED_PX = 0.5
"""A target that moved so far between the two pictures of a pair spoils its pose."""


@dataclass(frozen=True, eq=False, slots=True)
class PoseFeatures(Excludable):
    """Target and stripes found in the pictures of one pose.

    Parameters
    ----------
    name
        The pose's name, for messages.
    view
        The target's points; None if it was not found.
    centrelines
        The stripes on the plate around the target.
    exclusion
        Why the pose cannot be used; None if it can.
    notes
        For the technician.
    moved_px
        How far the target moved between the pictures with the fan on and off; NaN: not known.
    gain
        Factor of the plate's light with the fan on over that with the fan off, which was taken off; 1: the same, or not
        known.
    others
        The stripes in other channels of colour pictures that show them about as well, by the channel's name: they are
        compared with those in use.
    """

    name: str
    view: TargetView | None
    centrelines: tuple[Centreline, ...]
    exclusion: Reason | None = None
    notes: tuple[Message, ...] = ()
    moved_px: float = math.nan
    gain: float = 1.0
    others: Mapping[str, tuple[Centreline, ...]] = field(default_factory=dict)

    @property
    def used(self) -> bool:
        """Whether the pose's pictures can be used: nothing excludes them."""
        return self.exclusion is None

    @property
    def target_moved(self) -> bool:
        """Whether the target is known to have moved too far between its pictures."""
        return self.moved_px >= MOVED_PX


def usual_stripe(poses: Iterable[PoseFeatures]) -> StripeSettings | None:
    """Compute the typical width and contrast of the stripes in some poses; None where there are none."""
    return usual_of([line for pose in poses for line in pose.centrelines])


def usual_of(lines: Sequence[Centreline]) -> StripeSettings | None:
    """Compute the typical width and contrast of some centrelines; None where there are none."""
    if not lines:
        return None
    width = float(np.median(np.concatenate([line.width for line in lines])))
    height = float(np.quantile(np.concatenate([line.strength for line in lines]), CONTRAST_QUANTILE))
    return StripeSettings(WIDTH_IN_SIGMA * width, height) if width > 0 and height > 0 else None
