"""The acceptance check: what its verdict rests on, and what it says of itself."""

import pytest

from core.wings.studies.kinds.acceptance import Reading, acceptance_check


def spheres(errors, u=0.001):
    return [Reading("size", f"p{number}", 30.0 + error, 30.0, u) for number, error in enumerate(errors)]


@pytest.mark.parametrize(
    ("worst", "verdict"),
    [
        (0.047, "conforming"),
        (-0.047, "conforming"),
        (0.049, "not proven"),
        (0.051, "not proven"),
        (-0.053, "not conforming"),
    ],
)
def test_every_position_must_prove_itself_against_the_limit_and_its_uncertainty(worst, verdict):
    found = acceptance_check(spheres([0.01] * 9 + [worst]), {"size": 0.05})
    assert found.verdict == verdict
    assert found.quantities[0].largest_error == pytest.approx(worst)
    assert found.quantities[0].worst.position == "p9"


def test_an_artefact_whose_uncertainty_is_not_stated_proves_nothing():
    assert acceptance_check(spheres([0.0] * 10, u=0.0), {"size": 0.05}).verdict == "not proven"


def test_one_quantity_that_fails_fails_the_check():
    readings = [*spheres([0.0] * 10), *(Reading("form", f"p{n}", 0.09, u=0.001) for n in range(10))]
    found = acceptance_check(readings, {"size": 0.05, "form": 0.08})
    assert [(one.quantity, one.verdict) for one in found.quantities] == [
        ("form", "not conforming"),
        ("size", "conforming"),
    ]
    assert found.verdict == "not conforming"


def test_without_limits_there_is_no_verdict():
    assert acceptance_check(spheres([0.01] * 10)).verdict == ""


def test_it_says_what_it_is_not_and_how_many_positions_are_missing():
    notes = acceptance_check([*spheres([0.0] * 10), Reading("flatness", "left", 0.02)], {"flatness": 0.1}).notes
    assert "not a certificate" in str(notes[0])
    assert any("1 of the 6 positions" in str(note) for note in notes)
    assert not any("of the 10 positions" in str(note) for note in notes)
    assert any("no uncertainty of the artefact" in str(note) for note in notes)


def test_the_same_position_twice_is_one_position():
    readings = [Reading("flatness", "left", 0.02)] * 6
    assert not acceptance_check(readings).quantities[0].enough_positions


def test_nothing_to_check_and_a_limit_of_nothing_are_refused():
    with pytest.raises(ValueError, match="needs a reading"):
        acceptance_check([])
    with pytest.raises(ValueError, match="sphere-spacing error"):
        acceptance_check(spheres([0.0]), {"spacing": 0})
