"""Every state of the Check card, and of fixed lines alone: the buttons follow from plain facts."""

from itertools import product
from typing import Any

import pytest

from workbench.pages.scan.stage import (
    CheckFacts,
    check_buttons,
    why_not_compare,
)

BOOLS, WHY = (False, True), ("", "why not")
CHECKS = [
    facts
    for facts in (CheckFacts(*v) for v in product(BOOLS, BOOLS, WHY, BOOLS, WHY, WHY, WHY, BOOLS))
    if facts.taking or not facts.stopping
]


@pytest.mark.parametrize("facts", CHECKS, ids=str)
def test_what_can_be_done_on_the_check_card(facts: CheckFacts) -> None:
    can = check_buttons(facts)
    if facts.stopping:
        assert can.take, "what stops cannot be stopped again"
    elif facts.taking:
        assert not can.take, "what runs can be stopped, whatever speaks against a start"
    else:
        assert can.take == facts.cannot_take
    if facts.checking:
        assert not can.run, "what runs can be cancelled"
    elif facts.taking or facts.cannot_check:
        assert can.run, "the pictures are not to be checked"
    else:
        assert not can.run, "nothing speaks against a check"
    assert bool(can.choose) == facts.taking, "other pictures are chosen unless some are being taken"
    assert (can.readjust is None) == (facts.taking or not facts.moved)
    assert can.readjust in (None, facts.cannot_readjust)
    assert bool(can.compare) == bool(facts.taking or facts.cannot_compare)


@pytest.mark.parametrize("states", list(product(BOOLS, BOOLS, WHY, BOOLS, BOOLS)), ids=str)
def test_what_is_compared_with_an_artefact_is_measured_up_to_date_and_kept(states: tuple[Any, ...]) -> None:
    comparing, measuring, cannot_write, measured, outdated = states
    why = why_not_compare(
        comparing=comparing, measuring=measuring, cannot_write=cannot_write, measured=measured, outdated=outdated
    )
    assert bool(why) == bool(comparing or measuring or cannot_write or outdated or not measured)
