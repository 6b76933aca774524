"""Every state of the report page: stage and buttons follow from plain facts."""

from collections.abc import Iterator
from itertools import product

from core.files.results.export_list import EXPORTS
from workbench.pages.report.stage import Facts, Stage, WhyNot, stage_of, why_not_export, why_not_make


def every_state() -> Iterator[Facts]:
    """All facts that can come together."""
    for values in product((False, True), repeat=len(Facts._fields)):
        facts = Facts(*values)
        if (facts.report or not facts.outdated) and (facts.scan or not (facts.thickness or facts.features)):
            yield facts


def test_in_no_state_can_something_be_done_that_makes_no_sense():
    reached = set()
    for facts in every_state():
        reached.add(stage_of(facts))
        if facts.making or not facts.scan or facts.read_only:
            assert why_not_make(facts), facts
        for kind, export in EXPORTS.items():
            why_not = why_not_export(facts, kind)
            if export.needs == "camera":
                assert bool(why_not) != facts.camera, (kind, facts)
            elif not facts.scan:
                assert why_not, (kind, facts)
            if export.needs == "inspect" and not (facts.thickness or facts.features):
                assert why_not, (kind, facts)
    assert reached == set(Stage)


def test_in_every_state_the_next_thing_to_do_can_be_done():
    for facts in every_state():
        if stage_of(facts) in (Stage.READY, Stage.OUTDATED) and not facts.read_only:
            assert not why_not_make(facts), facts
        if facts.scan and not facts.making:
            assert not why_not_export(facts, "pdf"), "what was measured can be handed over, read-only or not"


def test_a_grey_button_has_its_reason_among_those_with_a_sentence():
    reasons = {why_not_make(facts) for facts in every_state()}
    reasons |= {why_not_export(facts, kind) for facts in every_state() for kind in EXPORTS}
    assert reasons == set(WhyNot)
