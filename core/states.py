"""How far something is, and what was decided about it: one word for each, in window, command line and report.

Files keep the keys. A title is made of a word by `core.messages.capital`.
"""

from __future__ import annotations

from collections.abc import Sequence

from core.messages import Message, label

STEP_STATES = {
    "todo": label("to do"), "ready": label("ready"), "done": label("done"), "outdated": label("out of date"),
    "not needed": label("not needed"),
}  # fmt: skip
"""Of a step of the work, of a calibration, a check or a report."""

NO_FAN = label("Not needed: rig.toml states no fan.")
"""Why nothing of the fan is calibrated or checked in a project."""

OUT_OF_DATE = {
    "camera": label("The accepted camera calibration is out of date; calibrate again."),
    "planes": label("The accepted laser planes are out of date; calibrate again."),
    "check": label("The check is out of date; check again."),
    "scan": label("The scan is out of date; measure it again."),
    "gauge": label("The thickness is out of date; measure it again."),
    "feature": label("The feature is out of date: it, or one that it rests on, was changed; measure it again."),
}
"""Of what the project would give otherwise now, by the result: why nothing that rests on it can be done, and what to do
first. `changed_since` says what it no longer is of."""


def changed_since(names: Sequence[str]) -> Message:
    """Make the reason why a result is out of date: the `names` of its inputs that have changed.

    Examples
    --------
    >>> str(changed_since(["camera", "the pictures"]))
    'out of date: changed since: camera, the pictures'
    """
    return Message("project.outdated_since", "out of date: changed since: {names}", names=tuple(names))


def outdated_with(steps: Sequence[str]) -> Message:
    """Make the reason why a result is out of date: the names of the `steps` it rests on that are out of date.

    Examples
    --------
    >>> str(outdated_with(["scan"]))
    'out of date, because this is: scan'
    """
    return Message("project.outdated_with", "out of date, because this is: {steps}", steps=tuple(steps))


CHECKS = {"passed": label("in order"), "doubtful": label("in doubt"), "failed": label("changed")}
"""What a check of the rig has shown."""

CONDITIONS = {"ok": label("in order"), "failed": label("not in order"), "unknown": label("not known")}
"""Of what a scan rests on, looked at before it begins."""

SET_STATES = {
    "todo": label("to do"), "running": label("being measured"), "done": label("done"), "failed": label("not measured"),
}  # fmt: skip
"""Of each of many recording sets."""

VERDICT = label("verdict")
"""What was decided, as it is called."""
SPREAD = label("s (n − 1)")
"""The standard deviation of repeats about their mean, as it is called."""

DECISIONS = {
    "conforming": label("conforming"),
    "not conforming": label("not conforming"),
    "not proven": label("not proven"),
    "": label("no verdict"),
    "capable": label("capable"),
    "not capable": label("not capable"),
    "acceptable": label("acceptable"),
    "acceptable with reservations": label("acceptable with reservations"),
    "not acceptable": label("not acceptable"),
}
"""On a result, a part, or a study."""
