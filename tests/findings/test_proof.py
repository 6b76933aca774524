"""Facts decide what is proven: each of them by itself, and what is not known."""

import ast
from dataclasses import fields, replace

import numpy as np
import pytest

from core.findings.finding import Effect
from core.findings.of_proof import DAY, REASONS, UNNAMED
from core.findings.proof import (
    OF_PLANES,
    OF_SCAN,
    PLANES_UNKNOWN,
    SCAN_UNKNOWN,
    SIZE_UNCONFIRMED,
    Doubt,
    ScanFacts,
    doubts_named,
    notes_beside,
)
from core.findings.table import FINDINGS, note_of
from core.inspect.characteristic import Characteristic
from core.inspect.conformity import Limits, Verdict, decide
from core.inspect.results import Face, GaugeResult
from core.messages import plain
from core.model import LightPlane
from tests.code import modules, nodes
from tests.scan_facts import NOTHING_WRONG

LIMITS = Limits(50.0, -0.2, 0.2)
NO_PROOF = [row.code for row in FINDINGS.values() if row.effect == Effect.NO_PROOF]


def test_nothing_speaks_against_a_scan_of_which_all_is_known_and_nothing_holds():
    assert NOTHING_WRONG.doubts == ()


@pytest.mark.parametrize(("fact", "doubt"), [*OF_SCAN.items(), *OF_PLANES.items()])
def test_each_fact_by_itself_takes_away_the_proof_and_so_does_not_knowing_it(fact, doubt):
    assert replace(NOTHING_WRONG, **{fact: True}).doubts == (doubt,)
    unknown = SCAN_UNKNOWN if fact in OF_SCAN else PLANES_UNKNOWN
    assert replace(NOTHING_WRONG, **{fact: None}).doubts == (unknown,)


@pytest.mark.parametrize("size", [True, None])
def test_a_size_that_is_not_confirmed_is_a_doubt_of_its_own(size):
    assert replace(NOTHING_WRONG, size_unconfirmed=size).doubts == (SIZE_UNCONFIRMED,)


def test_every_doubt_is_told_not_the_first_alone():
    lapsed = Doubt("check_lapsed", plain("The check has lapsed."))
    facts = replace(NOTHING_WRONG, moved=True, points_off_alike=True, of_the_day=(lapsed,), size_unconfirmed=True)
    assert facts.doubts == (OF_SCAN["moved"], lapsed, OF_PLANES["points_off_alike"], SIZE_UNCONFIRMED)


def test_every_fact_is_one_that_takes_away_proofs():
    assert {one.name for one in fields(ScanFacts)} == {*OF_SCAN, *OF_PLANES, "size_unconfirmed", "of_the_day"}
    doubts = (*OF_SCAN.values(), *OF_PLANES.values(), SCAN_UNKNOWN, PLANES_UNKNOWN, SIZE_UNCONFIRMED)
    assert {FINDINGS[doubt.note.code].effect for doubt in doubts} == {Effect.NO_PROOF}


def test_who_asks_for_a_verdict_or_makes_a_result_has_to_say_what_is_in_doubt():
    with pytest.raises(TypeError, match="doubts"):
        decide(50.0, LIMITS, 0.1)
    with pytest.raises(TypeError, match="doubts"):
        Characteristic("a", "thickness", 50.0, 0.01)
    with pytest.raises(TypeError, match="doubts"):
        gauge()


def gauge(**more):
    face = Face(LightPlane(np.array([0.0, 0.0, 0.01])), np.arange(3), np.zeros(3), 0.0, 0.0)
    return GaugeResult(50.0, 0.01, 2.0, face, face, 0.0, (), 50.0, 0.2, **more)


def characteristic(**more):
    return Characteristic("a", "thickness", 50.0, 0.01, limits=LIMITS, **more)


@pytest.mark.parametrize("make", [gauge, characteristic])
@pytest.mark.parametrize("code", NO_PROOF)
def test_no_finding_by_which_nothing_is_proven_stands_beside_conforming(code, make):
    row = FINDINGS[code]
    note = row.note(**dict.fromkeys(row.places, 1))
    assert make(doubts=()).verdict == Verdict.CONFORMING
    assert make(doubts=(Doubt.of(note),)).verdict == Verdict.NOT_PROVEN
    with pytest.raises(ValueError, match=row.fact):
        make(notes=(note,), doubts=())


def test_a_note_that_takes_away_no_proof_makes_no_doubt():
    with pytest.raises(ValueError, match="takes away no proof"):
        Doubt.of(note_of("profile.stood_still"))
    with pytest.raises(ValueError, match="takes away no proof"):
        Doubt.of(plain("It was too warm."))


def test_a_verdict_is_made_by_one_function_alone():
    """Nobody else names the verdict that is to be proven where it is given."""
    found = [
        path.name
        for path in modules("core", "trisect")
        for node in nodes(path)
        if isinstance(node, ast.Return) and isinstance(node.value, ast.Attribute) and node.value.attr == "CONFORMING"
    ]
    assert found == ["conformity.py"]


def test_every_fact_that_takes_away_a_proof_is_told_in_few_words():
    assert {row.fact for row in FINDINGS.values() if row.effect == Effect.NO_PROOF} | {UNNAMED, DAY} <= set(REASONS)
    assert [str(one.note) for one in doubts_named(["moved", "melted"], complete=False)] == [
        "something moved during the scan", "melted",
    ]  # fmt: skip


def test_a_file_of_an_earlier_version_names_no_doubts():
    assert doubts_named([], complete=True) == ()
    assert [one.fact for one in doubts_named([], complete=False)] == [UNNAMED]
    moved = OF_SCAN["moved"].note
    assert notes_beside((), (moved, plain("Warm."))) == (plain("Warm."),)
    assert notes_beside(doubts_named(["moved"], complete=False), (moved,)) == (moved,)
