"""Every state of *Measure everything*: it follows from plain facts."""

from itertools import product
from typing import NamedTuple

import pytest

from workbench.pages.whole import why_not_measure_all

BOTH = (False, True)
LEFT = tuple(map(frozenset, ((), ("report",), ("scan", "gauge", "report"), ("camera", "scan", "report"))))


class Facts(NamedTuple):
    running: bool
    live: bool
    left: frozenset[str]
    scan_chosen: bool
    cannot_write: str


STATES = [Facts(*values) for values in product(BOTH, BOTH, LEFT, BOTH, ("", "It is read-only."))]


@pytest.mark.parametrize("facts", STATES)
def test_everything_is_measured_where_something_is_left_and_can_be_done(facts: Facts) -> None:
    why = why_not_measure_all(**facts._asdict())
    idle = not facts.running and not facts.live
    possible = bool(facts.left) and not facts.cannot_write and (facts.scan_chosen or "scan" not in facts.left)
    assert bool(why) != (idle and possible)
    if idle and not facts.left:
        assert why == "Everything is done.", "nothing else is told where nothing is left"
    if idle and facts.left and facts.cannot_write:
        assert why == "It is read-only.", "pictures need not be chosen for what cannot be written"
