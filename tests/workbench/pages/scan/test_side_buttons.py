"""Every state of the Check card, and of fixed lines alone: the buttons follow from plain facts."""

from itertools import product

import pytest

from workbench.pages.scan.stage import (
    CheckFacts,
    CompareFacts,
    ProfilesFacts,
    check_buttons,
    why_not_compare,
    why_not_profiles,
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


@pytest.mark.parametrize("facts", [CompareFacts(*v) for v in product(BOOLS, BOOLS, WHY, BOOLS, BOOLS)], ids=str)
def test_what_is_compared_with_an_artefact_is_measured_up_to_date_and_kept(facts: CompareFacts) -> None:
    free = not (facts.comparing or facts.measuring or facts.cannot_write)
    assert bool(why_not_compare(facts)) == (not free or facts.outdated or not facts.measured)


@pytest.mark.parametrize("facts", [ProfilesFacts(*v) for v in product(BOOLS, WHY)], ids=str)
def test_the_fixed_lines_are_measured_once_and_only_with_what_a_scan_needs(facts: ProfilesFacts) -> None:
    assert bool(why_not_profiles(facts)) == bool(facts.measuring or facts.cannot)
