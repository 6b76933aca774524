"""What the pictures of one pose of the plane target show. Light to import: a window holds these."""

from __future__ import annotations

from dataclasses import dataclass

from core.image.centreline import Centreline
from core.image.target_view import TargetView


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
        All stripes in the picture, on the target or not.
    reason
        Why the pose cannot be used; empty if it can.
    notes
        Sentences for the technician.
    """

    name: str
    view: TargetView | None
    centrelines: tuple[Centreline, ...]
    reason: str = ""
    notes: tuple[str, ...] = ()
