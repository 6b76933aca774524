"""Every state of the scan page: stage and buttons follow from plain facts."""

from collections.abc import Iterator
from itertools import product

from workbench.pages.scan.stage import Facts, Stage, WhyNot, disabled_reasons, stage_of


def every_state() -> Iterator[Facts]:
    """All facts that can come together."""
    for values in product((False, True), repeat=len(Facts._fields)):
        facts = Facts(*values)
        consistent = (
            not (facts.live and (facts.check_live or facts.measuring))
            and (facts.measured or not facts.outdated)
            and (facts.source or not (facts.listed or facts.measuring))
            and (facts.listed or not facts.frames)
            and (facts.frames or not facts.counting)
        )
        if consistent:
            yield facts


def test_in_no_state_can_something_be_done_that_makes_no_sense():
    reached = set()
    for facts in every_state():
        stage, can = stage_of(facts), disabled_reasons(facts)
        reached.add(stage)
        if facts.live or facts.measuring or facts.read_only or not (facts.counting and facts.camera and facts.planes):
            assert can.measure, facts
        if stage in (Stage.NONE, Stage.LISTING, Stage.EMPTY, Stage.LIVE, Stage.MEASURING):
            assert can.measure, facts
        if not facts.measuring:
            assert can.cancel, facts
        if facts.measuring or facts.check_live or not facts.calibrations_read:
            assert can.record, facts
        if facts.live or not facts.calibrations_read or not (facts.camera and facts.planes):
            assert can.take_check, facts
    assert reached == set(Stage)


def test_in_every_state_the_next_thing_to_do_can_be_done():
    for facts in every_state():
        stage, can = stage_of(facts), disabled_reasons(facts)
        ready = facts.camera and facts.planes and facts.counting and not facts.read_only
        if stage in (Stage.RECORDED, Stage.FAILED, Stage.MEASURED, Stage.OUTDATED) and ready:
            assert not can.measure, facts
        if stage is Stage.MEASURING:
            assert not can.cancel, facts
        if stage in (Stage.NONE, Stage.EMPTY) and facts.has_fan and facts.calibrations_read and not facts.check_live:
            assert not can.record, facts


def test_what_is_missing_is_told_in_the_order_in_which_it_is_done():
    nothing = Facts(*[False] * len(Facts._fields))
    told = []
    for name in ("camera", "planes", "source", "listed", "frames", "counting"):
        told.append(disabled_reasons(nothing).measure)
        nothing = nothing._replace(**{name: True})
    assert told == [
        WhyNot.NO_CAMERA, WhyNot.NO_PLANES, WhyNot.NO_SOURCE, WhyNot.LISTING, WhyNot.NO_FRAMES, WhyNot.ALL_LEFT_OUT
    ]  # fmt: skip
    assert not disabled_reasons(nothing).measure


def test_a_grey_button_has_its_reason_among_those_with_a_sentence():
    assert {why for facts in every_state() for why in disabled_reasons(facts)} == set(WhyNot)
