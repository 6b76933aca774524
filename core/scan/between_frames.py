"""When something moved: between which two frames, and how that is said, wherever it was found."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from core.messages import Message


class Between(NamedTuple):
    """Interval in which something moved: after the frame of index `last_before`, before that of index `first_after`.

    Frames that lie between them tell nothing of when.
    """

    last_before: int
    first_after: int


def between(names: Sequence[str], movements: Iterable[Between]) -> tuple[Message, ...]:
    """Make one message "between FRAME and FRAME" of each movement, in order of time; `names` (F,) name the frames.

    Examples
    --------
    >>> [str(one) for one in between(["a", "b", "c", "d"], [Between(2, 3), Between(0, 2)])]
    ['between a and c', 'between c and d']
    """
    return tuple(
        Message(
            "scan.between_frames",
            "between {first} and {second}",
            first=names[one.last_before],
            second=names[one.first_after],
        )
        for one in sorted(movements)
    )


def merged_movements(of_light: Sequence[Between], of_crossings: Sequence[Between]) -> tuple[Between, ...]:
    """Merge movements seen by the fan's light with those seen by crossings, in order; the light decides overlaps.

    Examples
    --------
    >>> [tuple(one) for one in merged_movements([Between(11, 12)], [Between(4, 5), Between(10, 13)])]
    [(4, 5), (11, 12)]
    """
    others = (
        one
        for one in of_crossings
        if not any(one.last_before < of.first_after and of.last_before < one.first_after for of in of_light)
    )
    return tuple(sorted((*of_light, *others)))
