"""What the scan page's settings say of the rig's stability."""

from core.calibrate.change import DEFAULT_STABILITY, Stability
from workbench.pages.scan.stability import STABILITY, shown, stated


def test_a_value_typed_in_states_it_and_the_others_as_they_are_assumed():
    now = stated(None, "turn", 50.0)
    assert now == Stability(
        50e-6, DEFAULT_STABILITY.shift_mm, DEFAULT_STABILITY.centre_px, DEFAULT_STABILITY.focal_share
    )
    assert shown(now)["turn"] == 50.0


def test_an_emptied_value_states_nothing_any_more():
    assert stated(Stability(50e-6), "centre_px", None) is None
    assert set(shown(None).values()) == {None}


def test_what_is_assumed_is_shown_in_the_units_of_rig_toml():
    assert {one.key: one.usual for one in STABILITY} == {
        "turn": 200.0, "shift_mm": 20.0, "centre_px": 0.2, "focal_share": 100.0,
    }  # fmt: skip
    assert shown(DEFAULT_STABILITY) == {one.key: one.usual for one in STABILITY}
