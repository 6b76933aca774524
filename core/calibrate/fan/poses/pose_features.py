"""What the pictures of one pose of the plane target show. Light to import: a window holds these."""

from __future__ import annotations

from dataclasses import dataclass

from core.image.stripes.centreline import Centreline
from core.image.targets.target_view import TargetView
from core.messages import Message


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
