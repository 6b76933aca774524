"""What the scan page's settings say of the rig's stability."""

from core.calibrate.change import DEFAULT_STABILITY, Stability
from core.calibrate.drift import NO_DRIFT, Drift
from core.files.recording.rig import default_rig
from workbench.pages.scan.stability import STABILITY, rig_shown, rig_stated, shown, stated, usual_per_kelvin


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


def test_what_changes_for_each_kelvin_and_hour_is_stated_one_by_one_and_emptied_again():
    rig = rig_stated(default_rig(), "per_kelvin.turn", 40.0)
    rig = rig_stated(rig, "per_hour.centre_px", 0.01)
    assert rig.drift == Drift(Stability(40e-6, 0.0, 0.0, 0.0), Stability(0.0, 0.0, 0.01, 0.0))
    assert rig.stability is None, "what else may change stays assumed"
    assert (rig_shown(rig)["per_kelvin.turn"], rig_shown(rig)["per_kelvin.shift_mm"]) == (40.0, None)
    rig = rig_stated(rig_stated(rig, "per_kelvin.turn", None), "per_hour.centre_px", None)
    assert rig.drift == NO_DRIFT and set(rig_shown(rig).values()) == {None}


def test_the_temperature_of_the_calibration_is_the_rigs():
    rig = rig_stated(default_rig(), "calibrated_celsius", 21.5)
    assert rig.air.calibrated == rig_shown(rig)["calibrated_celsius"] == 21.5
    assert rig_stated(rig, "calibrated_celsius", None) == default_rig()


def test_what_is_usual_for_each_kelvin_is_what_is_assumed_over_five_of_them():
    assert {one.key: usual_per_kelvin(one) for one in STABILITY}["turn"] == 40.0
