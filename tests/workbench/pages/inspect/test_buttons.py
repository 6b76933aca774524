"""Every state of the panels of the Inspect page: their buttons follow from plain facts."""

from collections.abc import Iterable
from itertools import product

import pytest

from workbench.pages.inspect.features.plan import FeaturesFacts, features_buttons
from workbench.pages.inspect.repeats.repeats import RepeatsFacts, repeats_buttons
from workbench.pages.inspect.stage import (
    FacesFacts,
    PicksFacts,
    SurfaceFacts,
    faces_buttons,
    picks_buttons,
    surface_buttons,
)

BOOLS, WHY = (False, True), ("", "Why not.")


def are_sentences(reasons: Iterable[str]) -> bool:
    """Whether each reason begins and ends as a sentence does."""
    return all(not why or (why[0].isupper() and why.endswith(".")) for why in reasons)


SURFACES = [
    facts
    for facts in (SurfaceFacts(*v) for v in product(BOOLS, repeat=4))
    if (facts.scan or not (facts.unreadable or facts.shown)) and not (facts.unreadable and facts.shown)
    if facts.shown or not facts.mesh
]


@pytest.mark.parametrize("facts", SURFACES, ids=str)
def test_the_surface_is_used_once_it_is_shown_and_its_mesh_where_it_has_one(facts: SurfaceFacts) -> None:
    can = surface_buttons(facts)
    assert are_sentences(can)
    assert (can.use == "") == facts.shown
    assert (can.mesh == "") == (facts.shown and facts.mesh)
    assert (can.measure == "") == (facts.scan and not facts.unreadable), "it need not be shown"
    if not facts.shown:
        said = "first" if not facts.scan else "cannot be read" if facts.unreadable else "being read"
        assert said in can.use and can.mesh == can.use


FACES = [
    facts
    for facts in (FacesFacts(*v) for v in product(WHY, BOOLS, BOOLS, WHY))
    if not (facts.found and facts.no_surface) and not (facts.own and facts.missing)
]


@pytest.mark.parametrize("facts", FACES, ids=str)
def test_regions_are_drawn_taken_given_up_and_exchanged_where_there_are_some(facts: FacesFacts) -> None:
    can = faces_buttons(facts)
    assert are_sentences(can)
    assert can.draw == facts.no_surface
    assert (can.take_found == "") == (facts.found and not facts.own)
    assert (can.automatic == "") == bool(facts.own or facts.missing), "there is something to give up"
    assert (can.exchange == "") == facts.own, "two regions are exchanged"
    if facts.missing:
        assert can.exchange == facts.missing, "one region is there: the other is asked for"
    if facts.no_surface and not facts.own:
        assert can.take_found == facts.no_surface, "nothing can be measured before there is a surface"


PICKS = [facts for facts in (PicksFacts(*v) for v in product(WHY, BOOLS, BOOLS)) if facts.some or not facts.chosen]


@pytest.mark.parametrize("facts", PICKS, ids=str)
def test_what_was_picked_is_removed_and_one_of_it_once_it_is_chosen(facts: PicksFacts) -> None:
    can = picks_buttons(facts)
    assert are_sentences(can)
    assert can.pick == facts.no_surface
    assert (can.clear == "") == facts.some
    assert (can.remove == "") == facts.chosen
    if facts.some and not facts.chosen:
        assert can.remove.startswith("Choose")


REPEATS = [
    facts
    for facts in (RepeatsFacts(why, *flags) for why in WHY for flags in product(BOOLS, repeat=7))
    if not (facts.no_surface and facts.thickness) and (facts.some or not (facts.among or facts.chosen))
]


def test_a_repeat_is_added_once_and_only_what_is_shown_and_up_to_date() -> None:
    for facts in REPEATS:
        can = repeats_buttons(facts)
        assert are_sentences(can), facts
        good = facts.thickness and not (facts.stale or facts.scan_old or facts.outdated or facts.among)
        assert (can.add == "") == good, facts
        if facts.no_surface:
            assert can.add == facts.no_surface, "nothing can be measured before there is a surface"
        assert (can.remove == "") == facts.chosen, facts
        assert (can.copy == "") == facts.some, facts


FEATURES = [
    FeaturesFacts(no_scan, cannot_write, measured, measuring, count, place, cannot_remove)
    for no_scan, cannot_write, cannot_remove in product(WHY, repeat=3)
    for measured, measuring in product(BOOLS, repeat=2)
    for count in range(4)
    for place in range(-1, count)
    if place >= 0 or not cannot_remove
]


def test_features_are_measured_removed_moved_and_saved_where_there_are_some() -> None:
    for facts in FEATURES:
        can = features_buttons(facts)
        assert are_sentences(can), facts
        possible = not (facts.no_scan or facts.cannot_write) and (facts.count > 0 or facts.measured)
        assert (can.measure == "") == (possible and not facts.measuring), facts
        assert (can.remove == "") == (facts.place >= 0 and not facts.cannot_remove), facts
        for reason, there in ((can.up, facts.place - 1), (can.down, facts.place + 1)):
            assert (reason == "") == (facts.place >= 0 and 0 <= there < facts.count), facts
        assert (can.save == "") == (facts.count > 0), facts
