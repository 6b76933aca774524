"""Facts decide what is proven: each of them by itself, and what is not known."""

from dataclasses import fields, replace
from typing import Any

import pytest

from core.findings.finding import Effect
from core.findings.proof import OF_PLANES, OF_SCAN, PLANES_UNKNOWN, SCAN_UNKNOWN, SIZE_UNCONFIRMED, ScanFacts
from core.findings.table import FINDINGS
from core.messages import plain

KNOWN: dict[str, Any] = dict.fromkeys([*OF_SCAN, *OF_PLANES, "size_unconfirmed"], False)
NOTHING_WRONG = ScanFacts(**KNOWN)


def test_nothing_speaks_against_a_scan_of_which_all_is_known_and_nothing_holds():
    assert NOTHING_WRONG.all_doubts == ()


@pytest.mark.parametrize(("fact", "doubt"), [*OF_SCAN.items(), *OF_PLANES.items()])
def test_each_fact_by_itself_takes_away_the_proof_and_so_does_not_knowing_it(fact, doubt):
    assert replace(NOTHING_WRONG, **{fact: True}).doubts == (doubt,)
    unknown = SCAN_UNKNOWN if fact in OF_SCAN else PLANES_UNKNOWN
    assert replace(NOTHING_WRONG, **{fact: None}).doubts == (unknown,)


@pytest.mark.parametrize("size", [True, None])
def test_a_size_that_is_not_confirmed_is_a_doubt_of_its_own(size):
    facts = replace(NOTHING_WRONG, size_unconfirmed=size)
    assert (facts.doubts, facts.all_doubts) == ((), (SIZE_UNCONFIRMED,))


def test_every_doubt_is_told_not_the_first_alone():
    lapsed = plain("The check has lapsed.")
    facts = replace(NOTHING_WRONG, moved=True, points_off_alike=True, of_the_day=(lapsed,), size_unconfirmed=True)
    assert facts.all_doubts == (OF_SCAN["moved"], lapsed, OF_PLANES["points_off_alike"], SIZE_UNCONFIRMED)


def test_every_fact_is_one_that_takes_away_proofs():
    assert {one.name for one in fields(ScanFacts)} == {*OF_SCAN, *OF_PLANES, "size_unconfirmed", "of_the_day"}
    doubts = (*OF_SCAN.values(), *OF_PLANES.values(), SCAN_UNKNOWN, PLANES_UNKNOWN, SIZE_UNCONFIRMED)
    assert {FINDINGS[doubt.code].effect for doubt in doubts} == {Effect.NO_PROOF}
