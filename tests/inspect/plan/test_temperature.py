"""Lengths at 20 °C and by comparison with a master, against figures worked out by hand."""

from dataclasses import replace

import pytest

from core.inspect.causes import CALIBRATIONS, Cause
from core.inspect.characteristic import Characteristic
from core.inspect.conformity import Limits
from core.inspect.plan.conditions import Master, Temperature
from core.inspect.plan.temperature import (
    at_reference,
    compared,
    temperature_contributions,
    with_scale,
)
from core.inspect.results import Contribution
from core.inspect.uncertainty.budget import combined
from core.inspect.uncertainty.coverage import student_factor
from core.inspect.uncertainty.part import TargetTemperature

WARM = Temperature(24.0, 0.5, 11.5e-6, 1.0e-6)


def length(value=50.02, noise=0.003, camera=0.008, kind="thickness", **more):
    budget = (Contribution(Cause.POINT_NOISE, noise), Contribution(Cause.CAMERA, camera))
    return Characteristic("block", kind, value, combined(budget), budget=budget, doubts=(), **more)


def test_a_warm_steel_block_is_shorter_at_20_degrees():
    row = at_reference(length(limits=Limits(50.0, -0.1, 0.1)), WARM, 2.0)
    assert row.value == pytest.approx(50.02 * (1 - 11.5e-6 * 4.0), abs=1e-12)
    rows = {one.source: one for one in row.budget}
    assert rows[Cause.PART_TEMPERATURE].u_mm == pytest.approx(50.02 * 11.5e-6 * 0.5, rel=1e-9)
    assert rows[Cause.PART_TEMPERATURE].sensitivity == pytest.approx(50.02 * 11.5e-6, rel=1e-9)
    assert (rows[Cause.PART_TEMPERATURE].value, rows[Cause.PART_TEMPERATURE].unit) == (24.0, "°C")
    assert rows[Cause.PART_EXPANSION].u_mm == pytest.approx(50.02 * 4.0 * 1e-6, rel=1e-9)
    assert row.u == pytest.approx(combined(row.budget), rel=1e-12)
    assert row.deviation == pytest.approx(row.value - 50.0)
    assert row.notes[0].code == "feature.stated_at_20"
    assert row.at_20
    assert "20 °C" in str(row.notes[0])


def test_a_scale_of_the_same_material_at_the_same_temperature_cancels_the_expansion():
    both = Temperature(24.0, 0.0, 11.5e-6, 1e-6, scale_celsius=24.0, scale_alpha=11.5e-6, u_scale_alpha=1e-6)
    row = at_reference(length(), both, 2.0)
    assert row.value == pytest.approx(50.02, abs=1e-12)
    assert Cause.SCALE_EXPANSION in {one.source for one in row.budget}


def test_at_20_degrees_only_the_thermometer_counts():
    rows = temperature_contributions(50.0, Temperature(20.0, 0.2, 11.5e-6, 1e-6))
    assert [row.source for row in rows] == [Cause.PART_TEMPERATURE]
    assert rows[0].u_mm == pytest.approx(50 * 11.5e-6 * 0.2)


def test_the_end_gauge_of_the_gum_has_its_published_contributions():
    # H.1.3.4: u(δα) = 0.58·10⁻⁶ with θ = −0.1 K gives 2.9 nm; H.1.3.5: α = 11.5·10⁻⁶ with u(δθ) = 0.029 K 16.6 nm
    rows = temperature_contributions(50.0, Temperature(19.9, 0.029, 11.5e-6, 0.58e-6))
    nanometres = {row.source: row.u_mm * 1e6 for row in rows}
    assert nanometres[Cause.PART_EXPANSION] == pytest.approx(2.9, abs=0.05)
    assert nanometres[Cause.PART_TEMPERATURE] == pytest.approx(16.6, abs=0.1)


def test_forms_and_angles_do_not_expand():
    flat = length(kind="flatness")
    lean = length(kind="angle", quantity="angle")
    assert at_reference(flat, WARM, 2.0) is flat
    assert at_reference(lean, WARM, 2.0) is lean
    assert compared(flat, MASTER, 2.0) is flat


MASTER = Master(
    "M50",
    50.0002,
    0.0001,
    50.0152,
    ((Cause.POINT_NOISE, 0.004), (Cause.CAMERA, 0.0075), (Cause.SCALE, 0.002)),
    ("block",),
)


def test_a_part_is_compared_with_a_master_of_its_size():
    row = compared(length(), MASTER, 2.0)
    assert row.value == pytest.approx(50.02 - 0.015, abs=1e-12)
    rows = {one.source: one.u_mm for one in row.budget}
    assert rows[Cause.CAMERA] == pytest.approx(0.0005)  # both wrong in the same way
    assert rows[Cause.POINT_NOISE] == 0.003
    assert rows[Cause.MASTER_MEASURED] == 0.004
    assert rows[Cause.CERTIFICATE] == 0.0001
    assert row.u == pytest.approx(combined(row.budget))
    assert row.u < length().u


def test_a_plan_that_states_nothing_of_the_scale_has_that_of_the_target():
    stated = TargetTemperature(24.0, 0.5, 8.6e-6, 1e-6)
    assert (
        temperature_contributions(50.0, with_scale(WARM, TargetTemperature()))[-1].source
        == Cause.SCALE_TEMPERATURE_ASSUMED
    )
    known = with_scale(WARM, stated)
    assert (known.scale_celsius, known.u_scale_celsius, known.scale_alpha) == (24.0, 0.5, 8.6e-6)
    own = Temperature(24.0, 0.5, 11.5e-6, 1e-6, scale_celsius=22.0, u_scale_celsius=0.2, scale_alpha=24e-6)
    assert with_scale(own, stated) is own
    half = Temperature(24.0, 0.5, 11.5e-6, 1e-6, scale_celsius=22.0, u_scale_celsius=0.2)
    causes = {row.source for row in temperature_contributions(50.0, with_scale(half, TargetTemperature()))}
    assert {Cause.SCALE_TEMPERATURE, Cause.SCALE_EXPANSION_ASSUMED} <= causes


def test_the_targets_warmth_is_the_same_for_part_and_master():
    warm = at_reference(length(), with_scale(WARM, TargetTemperature()), 2.0)
    of_scale = next(row.u_mm for row in warm.budget if row.source == Cause.SCALE_TEMPERATURE_ASSUMED)
    master = Master(
        "M50", 50.0, 0.0001, 50.0152, (*MASTER.budget, (Cause.SCALE_TEMPERATURE_ASSUMED, of_scale)), ("block",)
    )
    rows = {one.source: one.u_mm for one in compared(warm, master, 2.0).budget}
    assert rows[Cause.SCALE_TEMPERATURE_ASSUMED] == 0
    assert rows[Cause.MASTER_MEASURED] == 0.004


@pytest.mark.parametrize("cause", [cause for source, cause in CALIBRATIONS.items() if "known" in source])
def test_what_errs_in_known_planes_never_cancels_as_the_masters_may_have_been_others(cause):
    part, master = (
        replace(length(), budget=(Contribution(cause, 0.008),)),
        replace(MASTER, budget=((cause, 0.008),)),
    )
    rows = {one.source: one.u_mm for one in compared(part, master, 2.0).budget}
    assert rows[cause] == 0.008
    assert rows[Cause.MASTER_MEASURED] == 0.008


def test_a_master_measured_with_another_calibration_cancels_nothing():
    other = Master("M50", 50.0002, 0.0001, 50.0152, MASTER.budget, ("block",), same_calibration=False)
    row = compared(length(), other, 2.0)
    rows = {one.source: one.u_mm for one in row.budget}
    assert rows[Cause.CAMERA] == 0.008
    assert rows[Cause.MASTER_MEASURED] == pytest.approx((0.004**2 + 0.0075**2 + 0.002**2) ** 0.5)
    assert row.u > length().u


def test_a_master_of_quite_another_size_is_not_used():
    row = compared(length(value=70.0), MASTER, 2.0)
    assert row.value == 70.0
    assert "too different" in str(row.notes[-1])


def test_the_factor_covers_what_a_correction_leaves_of_the_budget():
    """Causes known well cancel in a comparison, and form that is hardly known is left; a thermometer's adds to both."""
    form = Contribution(Cause.FORM, 0.006, dof=4)
    known = Contribution(Cause.CAMERA, 0.008)
    budget = (form, known)
    found = Characteristic(
        "block", "thickness", 50.02, combined(budget), k=student_factor(2.0, budget), budget=budget, doubts=()
    )
    cancelled = compared(found, replace(MASTER, budget=((Cause.CAMERA, 0.008),)), 2.0)
    assert cancelled.k == student_factor(2.0, cancelled.budget) > found.k > 2.0
    warm = at_reference(found, replace(WARM, u_part_celsius=15.0), 2.0)
    assert warm.k == student_factor(2.0, warm.budget) < found.k
