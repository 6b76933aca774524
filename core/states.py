"""How far something is, and what was decided about it: one word for each, in window, command line and report.

Files keep the keys. A title is made of a word by `core.messages.capital`.
"""

from __future__ import annotations

from core.messages import label

STEP_STATES = {"todo": label("to do"), "ready": label("ready"), "done": label("done"), "outdated": label("out of date")}
"""Of a step of the work, of a calibration, a check or a report."""

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
