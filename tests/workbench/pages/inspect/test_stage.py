"""Every state of the inspect page: stage and button follow from plain facts."""

from collections.abc import Iterator
from itertools import product

from workbench.pages.inspect.stage import Facts, Stage, WhyNot, stage_of, why_not_measure


def every_state() -> Iterator[Facts]:
    """All facts that can come together."""
    for values in product((False, True), repeat=len(Facts._fields)):
        facts = Facts(*values)
        consistent = (
            (facts.shown or not (facts.stale or facts.thickness))
            and (facts.scan or not (facts.shown or facts.unreadable))
            and not (facts.unreadable and facts.shown and not facts.stale)
        )
        if consistent:
            yield facts


def test_in_no_state_can_something_be_done_that_makes_no_sense():
    reached = set()
    for facts in every_state():
        stage, why_not = stage_of(facts), why_not_measure(facts)
        reached.add(stage)
        if not facts.scan or facts.unreadable or facts.read_only or facts.measuring or facts.face_missing:
            assert why_not, facts
        if stage in (Stage.NO_SCAN, Stage.MEASURING, Stage.UNREADABLE):
            assert why_not, facts
        if stage is Stage.MEASURED:
            assert facts.thickness and not facts.outdated, facts
    assert reached == set(Stage)


def test_in_every_state_the_next_thing_to_do_can_be_done():
    for facts in every_state():
        stage, why_not = stage_of(facts), why_not_measure(facts)
        if stage in (Stage.UNMEASURED, Stage.FAILED, Stage.OUTDATED) and not (facts.unreadable or facts.read_only):
            assert why_not in (WhyNot.NOTHING, WhyNot.FACE_MISSING), facts
            assert bool(why_not) == facts.face_missing, facts


def test_a_grey_button_has_its_reason_among_those_with_a_sentence():
    assert set(map(why_not_measure, every_state())) == set(WhyNot)
