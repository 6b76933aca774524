"""What is stated of a part: corrections, budget rows, and what is assumed and said."""

from dataclasses import replace

import numpy as np
import pytest

from core.inspect.conformity import Verdict
from core.inspect.evaluate import evaluate
from core.inspect.faces import FacePair
from core.inspect.gauge import measure_gauge
from core.inspect.plan.conditions import Temperature
from core.inspect.plan.feature_spec import Auto, FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.plan.temperature import temperature_of
from core.inspect.uncertainty.part import MATERIALS, TARGET_AT_20, Part, TargetTemperature
from core.inspect.uncertainty.skewed_light import NOTHING_SEEN, unseen_mean_mm
from core.pipeline.steps.gauge_step import of_part
from tests.inspect.block_scan import BlockScan

METAL = Part(material="metal", celsius=20.0, u_celsius=0.0, target=TARGET_AT_20)


@pytest.fixture(scope="module")
def scan():
    return BlockScan(height=50.0, sweeps=18)


@pytest.fixture(scope="module")
def gauge_of(scan):
    """The thickness of a part of which this is stated."""
    cloud = replace(scan.measure(np.random.default_rng(3)), skewness=np.zeros(0), spread_mm=np.zeros(0))
    rng = np.random.default_rng(4)
    by_sweep = rng.normal(0, 0.02, int(cloud.sweep.max()) + 2)
    skewness = by_sweep[np.maximum(cloud.sweep, -1)]
    cloud = replace(cloud, skewness=skewness, spread_mm=np.full(len(cloud), 0.7))

    def gauge(part):
        return measure_gauge(
            cloud,
            errors=replace(scan.errors(), part=part),
            regions=FacePair(np.flatnonzero(scan.upper), np.flatnonzero(~scan.upper)),
            nominal_mm=50.0,
            tolerance_mm=5.0,
        )

    return gauge


def rows(gauge):
    return {row.words.code.removeprefix("inspection.cause_"): row.u_mm for row in gauge.budget}


def test_metal_at_20_degrees_changes_nothing(gauge_of):
    plain, metal = gauge_of(None), of_part(gauge_of(METAL), METAL)
    assert (metal.thickness_mm, metal.u_mm, metal.k, metal.notes) == (
        plain.thickness_mm, plain.u_mm, plain.k, plain.notes,
    )  # fmt: skip
    assert rows(metal) == rows(plain)


def test_light_from_below_is_in_u_as_far_as_the_sections_leave_it(gauge_of):
    plain, unstated, plastic = gauge_of(None), gauge_of(Part()), gauge_of(Part(material="plastic"))
    assert 0.005 < rows(unstated)["light_from_below_assumed"] < 0.05
    assert rows(plastic)["light_from_below"] > rows(unstated)["light_from_below_assumed"]
    assert unstated.thickness_mm == plain.thickness_mm and unstated.U_mm > plain.U_mm
    assert unstated.verdict == Verdict.CONFORMING


def test_an_offset_and_a_layer_of_spray_are_taken_off_with_their_uncertainty(gauge_of):
    part = Part(material="wax", offset_mm=0.12, offset_sd_mm=0.01, spray_mm=0.02, spray_sd_mm=0.004)
    plain, corrected = gauge_of(None), gauge_of(part)
    assert corrected.thickness_mm == pytest.approx(plain.thickness_mm + 0.10)
    assert rows(corrected) == pytest.approx({**rows(plain), "part_offset": 0.01, "spray": 0.004})
    assert corrected.u_mm == pytest.approx(np.sqrt(plain.u_mm**2 + 0.01**2 + 0.004**2))
    assert "part.surface_corrected" in {note.code for note in corrected.notes}
    assert rows(gauge_of(Part(material="sprayed")))["spray_assumed"] == 0.01


def test_a_correction_may_turn_the_verdict(gauge_of):
    assert gauge_of(Part(material="metal", offset_mm=6.0, offset_sd_mm=0.0)).verdict == Verdict.NOT_CONFORMING


def test_a_temperature_that_is_not_stated_is_assumed_in_the_budget_and_told(gauge_of):
    unstated = of_part(gauge_of(None), Part())
    assert rows(unstated)["part_temperature_assumed"] == pytest.approx(50 * 11.5e-6 * 3, rel=1e-3)
    assert [note.code for note in unstated.notes[-2:]] == ["part.material_assumed", "part.temperature_assumed"]


def test_a_stated_temperature_puts_a_thickness_to_20_degrees(gauge_of):
    part = Part(material="aluminium", celsius=25.0, u_celsius=0.5)
    plain, cold = gauge_of(None), of_part(gauge_of(None), part)
    assert cold.thickness_mm == pytest.approx(plain.thickness_mm * (1 - 23e-6 * 5))
    assert rows(cold)["part_temperature"] == pytest.approx(50 * 23e-6 * 0.5, rel=1e-3)
    assert rows(cold)["part_expansion"] == pytest.approx(50 * 0.9e-6 * 5, rel=1e-3)
    assert [note.code for note in cold.notes] == [*(note.code for note in plain.notes), "feature.stated_at_20"]
    assert (plain.at_20, cold.at_20) == (False, True)
    sprayed = temperature_of(Part(material="sprayed", celsius=25.0, u_celsius=0.5))
    assert sprayed.alpha_assumed and not sprayed.celsius_assumed


def test_a_target_whose_temperature_is_not_stated_is_a_row_that_says_so(gauge_of):
    plain, unstated = gauge_of(None), of_part(gauge_of(None), replace(METAL, target=TargetTemperature()))
    assert unstated.thickness_mm == plain.thickness_mm
    assert rows(unstated) == pytest.approx({**rows(plain), "target_temperature_assumed": 50 * 13.5e-6 * 3}, rel=1e-3)
    assert "(assumed)" in str(unstated.budget[-1].source)
    assert not any(note.code.startswith("target.") for note in unstated.notes), "2 µm need no question"


def test_a_target_that_was_warm_makes_what_is_measured_with_it_longer(gauge_of):
    target = TargetTemperature(26.0, 0.5, 24e-6, 1e-6)
    plain, warm = gauge_of(None), of_part(gauge_of(None), replace(METAL, target=target))
    assert warm.thickness_mm == pytest.approx(plain.thickness_mm * (1 + 24e-6 * 6))
    of_target = {"target_temperature": 50 * 24e-6 * 0.5, "target_expansion": 50 * 1e-6 * 6}
    assert rows(warm) == pytest.approx({**rows(plain), **of_target}, rel=1e-3)
    assert warm.notes[-1].code == "feature.stated_at_20"
    alone = of_part(gauge_of(None), Part(material="metal", target=replace(target, alpha=None, u_alpha=None)))
    assert {"target_temperature", "target_expansion_assumed", "part_temperature_assumed"} <= set(rows(alone))
    assert "feature.scale_at_20" in {note.code for note in alone.notes}
    assert (warm.at_20, alone.at_20) == (True, False), "the temperature of the part is assumed"


def test_an_inspection_reckons_with_the_part_unless_its_plan_states_a_temperature(scan):
    cloud = scan.measure(np.random.default_rng(3))
    errors = replace(scan.errors(), part=Part(material="steel"))
    plan = InspectionPlan((FeatureSpec("block", "thickness"),))
    (row,) = evaluate(plan, cloud, errors=errors).characteristics
    assert "inspection.cause_part_temperature_assumed" in {one.words.code for one in row.budget}
    found = evaluate(replace(plan, temperature=Temperature(20.0, 0.1, 1e-5, 0.0)), cloud, errors=errors)
    causes = {one.words.code for one in found.characteristics[0].budget}
    assert "inspection.cause_part_temperature" in causes
    assert "inspection.cause_part_temperature_assumed" not in causes
    assert not any(note.code.startswith("part.") for note in found.notes)


def test_light_from_below_two_faces_does_not_cancel_in_their_distance(scan):
    cloud = scan.measure(np.random.default_rng(3))
    errors = replace(scan.errors(), part=Part())
    faces = (FeatureSpec("top", "plane", (Auto(2),)), FeatureSpec("table", "plane", (Auto(1),)))
    plan = InspectionPlan((*faces, FeatureSpec("height", "distance", of=("top", "table"))))
    found = {row.name: row for row in evaluate(plan, cloud, errors=errors).characteristics}
    by_light = [row for row in found["height distance"].budget if "light_from_below" in row.words.code]
    once = unseen_mean_mm(NOTHING_SEEN, 1.0, 0.5)
    assert by_light[0].u_mm == pytest.approx(np.sqrt(2) * once, rel=0.1), "sections that are not known tell nothing"


@pytest.mark.parametrize("name", MATERIALS)
def test_every_material_says_how_it_expands(name):
    alpha, u_alpha = Part(material=name).expansion
    assert 0 < u_alpha < alpha < 3e-4
    assert Part(material=name, alpha=1e-6, u_alpha=0.0).expansion == (1e-6, 0.0)
