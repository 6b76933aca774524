"""Every state of a live source: the buttons follow from plain facts."""

from itertools import product

import pytest

from workbench.pages.live.buttons import LiveFacts, live_buttons

BOOLS, WHY = (False, True), ("", "why not")
STATES = [
    facts
    for facts in (LiveFacts(*v) for v in product(BOOLS, BOOLS, BOOLS, WHY))
    if facts.running or not (facts.named or facts.stopping)
]


@pytest.mark.parametrize("facts", STATES, ids=str)
def test_what_can_be_done_with_a_live_source(facts: LiveFacts) -> None:
    can = live_buttons(facts)
    if not facts.running:
        assert can.start == facts.cannot_start
    elif facts.stopping:
        assert can.start, "what stops cannot be stopped again"
    else:
        assert not can.start, "what runs can be stopped, whatever speaks against a start"
    assert (not can.steer) == (facts.named and not facts.stopping), "only pictures that come can be taken or marked"
