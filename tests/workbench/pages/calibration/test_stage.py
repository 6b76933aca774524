"""Every state of the calibration pages: stage and buttons follow from plain facts."""

from collections.abc import Iterator
from itertools import product

from workbench.pages.calibration.stage import (
    Facts,
    RestoreFacts,
    Stage,
    WhyNot,
    WhyNotRestore,
    disabled_reasons,
    stage_of,
    why_not_restore,
)

IDS = ("", "a", "b")
BOTH = (False, True)


def every_state() -> Iterator[Facts]:
    """All facts that can come together."""
    others = [name for name in Facts._fields if name not in ("accepted", "candidate")]
    for accepted, candidate in product(("", "a"), IDS):
        for values in product(BOTH, repeat=len(others)):
            facts = Facts(accepted=accepted, candidate=candidate, **dict(zip(others, values, strict=True)))
            consistent = (
                facts.calibration == bool(facts.candidate)
                and (facts.source or not (facts.searching or facts.solving or facts.failed or facts.empty))
                and (facts.accepted or not facts.current)
                and (facts.candidate or not facts.rejected)
            )
            if consistent:
                yield facts


def test_in_no_state_can_something_be_done_that_makes_no_sense():
    reached = set()
    for facts in every_state():
        stage, can = stage_of(facts), disabled_reasons(facts)
        reached.add(stage)
        if facts.live or facts.searching or facts.solving:
            assert can.run, facts
        if facts.read_only:
            assert can.run and can.accept, facts
        if facts.live or facts.solving or facts.keeping or not facts.candidate:
            assert can.accept, facts
        if facts.live or facts.solving or not facts.candidate:
            assert can.reject, facts
        if stage in (Stage.NONE, Stage.NO_CAMERA, Stage.LIVE, Stage.SEARCHING, Stage.SOLVING):
            assert can.run, facts
        if stage is Stage.ACCEPTED and facts.candidate:
            assert can.accept, facts
        if stage is Stage.REJECTED:
            assert can.reject, facts
    assert reached == set(Stage)


def test_in_every_state_the_next_thing_to_do_can_be_done():
    for facts in every_state():
        stage, can = stage_of(facts), disabled_reasons(facts)
        if facts.read_only:
            continue
        if stage in (Stage.FOUND, Stage.FAILED):
            assert not can.run, facts
        if stage is Stage.SOLVED and not facts.keeping and not facts.solving:
            assert not can.accept and not can.reject, facts
        if stage in (Stage.REJECTED, Stage.OTHER) and not facts.keeping and not facts.solving:
            assert not can.accept, facts


def test_a_grey_button_has_its_reason_among_those_with_a_sentence():
    reasons = {why for facts in every_state() for why in disabled_reasons(facts)}
    assert reasons == set(WhyNot)


def test_one_of_the_history_is_restored_only_where_nothing_runs_and_it_would_change_something():
    states = [RestoreFacts(*values) for values in product(BOTH, repeat=len(RestoreFacts._fields))]
    for facts in states:
        why = why_not_restore(facts)
        can = facts.kept and facts.chosen and not any(facts[2:])
        assert (why is WhyNotRestore.NOTHING) == can, facts
        if why in (WhyNotRestore.LIVE, WhyNotRestore.KEEPING, WhyNotRestore.JOB):
            assert facts.chosen and not facts.in_use, "who waits for the end of a job can restore it then"
    assert {why_not_restore(facts) for facts in states} == set(WhyNotRestore)
