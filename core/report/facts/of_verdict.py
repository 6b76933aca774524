"""What is told of a verdict."""

from __future__ import annotations

from core.messages import label
from core.report.facts.fact import Fact, Grade
from core.states import DECISIONS, VERDICT

_GRADES: dict[str, Grade] = {
    "capable": "good", "not capable": "bad",
    "acceptable": "good", "acceptable with reservations": "warn", "not acceptable": "bad",
    "conforming": "good", "not proven": "warn", "not conforming": "bad",
}  # fmt: skip
NO_LIMIT = label("none: no limit was given")


def verdict_fact(verdict: str) -> Fact:
    """Make the fact on the verdict on a part or of a study; if `verdict` is "", it says that no limit was given."""
    return Fact(VERDICT, decision(verdict) or NO_LIMIT, grade=_GRADES.get(verdict, ""))


def decision(verdict: str) -> str:
    """Return the words for a verdict; "" if `verdict` is ""."""
    return DECISIONS[verdict] if verdict else ""
