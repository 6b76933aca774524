"""What the pictures of one pose of the plane target show. Light to import: a window holds these."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from core.image.stripes.centreline import Centreline
from core.image.stripes.stripe import CONTRAST_QUANTILE, WIDTH_IN_SIGMA, StripeSettings
from core.image.targets.target_view import TargetView
from core.messages import Message

NO_STRIPE, OTHER_STRIPES = "fan.no_stripe", "fan.other_stripes"
"""Codes of the reasons that no stripe was found, and none as they were said to be."""


@dataclass(frozen=True, eq=False, slots=True)
class PoseFeatures:
    """What the pictures of one pose show.

    Parameters
    ----------
    name
        The pose's name, for messages.
    view
        The target's points; None if it was not found.
    centrelines
        The stripes on the plate around the target.
    reason
        Why the pose cannot be used; None if it can.
    notes
        For the technician.
    """

    name: str
    view: TargetView | None
    centrelines: tuple[Centreline, ...]
    reason: Message | None = None
    notes: tuple[Message, ...] = ()


def usual_stripe(poses: Iterable[PoseFeatures]) -> StripeSettings | None:
    """Width and contrast of most stripes of some poses; None where none was found."""
    return usual_of([line for pose in poses for line in pose.centrelines])


def usual_of(lines: Sequence[Centreline]) -> StripeSettings | None:
    """Width and contrast of most of some stripes; None for none."""
    if not lines:
        return None
    width = float(np.median(np.concatenate([line.width for line in lines])))
    height = float(np.quantile(np.concatenate([line.strength for line in lines]), CONTRAST_QUANTILE))
    return StripeSettings(WIDTH_IN_SIGMA * width, height) if width > 0 and height > 0 else None
