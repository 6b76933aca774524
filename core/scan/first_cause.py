"""The one place where causes are compared: what explains most of what is too large, and what is said first.

A cause is *measured* where it can be added to the model of a scan (`core.scan.causes`): then it explains a share of
what is too large in the squares of the crossings, spends as many numbers as it has, and may do so by chance. Others
cannot be put in that measure, and a fact decides of each by the rank or count that fails: frames that are too few,
points that are too unsure, stripes that are saturated, pictures that are compressed. Of them `share` is None.

What is made good before the sweeps are located leaves no crossing off, so there is nothing of it to compare: a picture
that is another one again counts once (`core.image.repeated`), light that changed with the exposure is taken off
(`core.scan.features.fan_light`), saturated pixels have no weight. A sheet that meets its surface obliquely displaces no
crossing either, it makes sections wider, and σ with them; where widths are compared it is part of their model
(`core.scan.footprint`). Nor is an angle between faces compared with any cause: it is named where it explains most of
the faces' form (`core.inspect.fit.judged_form`), unless a fact of the scan says that light, camera or part were
displaced.

Measured causes are said first, what explains more before what explains less. The others come in the order of
`Suspect`: each is a fact that leaves a result unsure, whatever else there is.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from enum import StrEnum

from core.errors import InputError, OwnCause
from core.messages import Message

BY_CHANCE = 0.01
"""A cause is named where chance alone would explain as much with a smaller probability, over all that were tried."""


class Suspect(StrEnum):
    """Candidate cause of a bad scan, by its name in files, in the order in which causes are reported."""

    BENT_LINES = "bent_lines"
    MOVED = "moved"
    DRIFTED = "drifted"
    RIG_CHANGED = "rig_changed"
    SECOND_BOUNCES = "second_bounces"
    HAND_MOVED = "hand_moved"
    PICTURES = "pictures"
    OVEREXPOSED = "overexposed"
    FEW_FRAMES = "few_frames"
    UNSURE_POINTS = "unsure_points"


@dataclass(frozen=True, slots=True)
class Cause:
    """Candidate cause of a bad scan, with the share of the misfit that it explains.

    Parameters
    ----------
    suspect
        What it is.
    share
        Share of what is too large that it explains, of what those before it leave; None where it has no such measure.
    freedom
        Numbers that it spends.
    p
        Probability that it explains as much by chance, times the number of causes that were tried; at most 1.
    """

    suspect: Suspect
    share: float | None = None
    freedom: int = 0
    p: float = 0.0


Causes = tuple[Cause, ...]
"""Causes beyond chance, the likeliest first; each explains some of what those before it leave."""


@dataclass(frozen=True, slots=True)
class Reason:
    """Reason why a scan gave no result, worded to stand before the complaint that there is none.

    Parameters
    ----------
    suspect
        The cause.
    begun
        Makes of the complaint the sentence that begins with the cause.
    todo
        What to do about it.
    of_own
        Whether it is the cause even of what names a cause of its own (`OwnCause`).
    kind
        Kind of the error that tells it.
    """

    suspect: Suspect
    begun: Callable[[Message], Message]
    todo: Message
    of_own: bool = False
    kind: type[InputError] = InputError


def in_order(reasons: Iterable[Reason], causes: Sequence[Cause] = ()) -> tuple[Reason, ...]:
    """Sort the reasons by how much of the excess misfit of the scan their causes explain, then in the order of Suspect.

    Examples
    --------
    >>> few, moved = (Reason(s, lambda what: what, Message("x.y", "")) for s in (Suspect.FEW_FRAMES, Suspect.MOVED))
    >>> [one.suspect.value for one in in_order([few, moved])]
    ['moved', 'few_frames']
    >>> [one.suspect.value for one in in_order([few, moved], [Cause(Suspect.FEW_FRAMES, 0.1)])]
    ['few_frames', 'moved']
    """
    shares = {cause.suspect: cause.share or 0.0 for cause in causes}
    rank = list(Suspect).index

    return tuple(sorted(reasons, key=lambda reason: (-shares.get(reason.suspect, 0.0), rank(reason.suspect))))


@contextmanager
def cause_first(
    reasons: Callable[[], Iterable[Reason]], causes: Callable[[], Sequence[Cause]] = tuple
) -> Iterator[None]:
    """Put the first of the reasons that holds before the text of a complaint raised in this block.

    `reasons` is called if there is a complaint, and gives those that hold; where any does, `causes` gives those that
    are compared. The share of the one that is named is told.
    """
    try:
        yield
    except InputError as error:
        holding = tuple(reasons())
        compared = causes() if holding else ()
        for reason in in_order(holding, compared):
            if reason.of_own or not isinstance(error, OwnCause):
                what = reason.begun(_with_share(error.what, reason.suspect, compared))
                raise reason.kind(what, where=error.where, todo=reason.todo) from error
        raise


def _with_share(complaint: Message, suspect: Suspect, causes: Sequence[Cause]) -> Message:
    """A complaint with the share that the cause named before it explains, where that is known."""
    share = next((cause.share for cause in causes if cause.suspect == suspect), None)
    if share is None:
        return complaint
    return Message(
        "cause.share_of_first",
        "{complaint} (what is named first explains {percent:.0f} % of what is too large)",
        complaint=complaint,
        percent=100 * share,
    )
