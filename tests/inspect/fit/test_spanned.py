"""Points of one stripe span no surface: it is refused, or has no flatness, no angle and proves nothing."""

from dataclasses import replace

import numpy as np
import pytest

from core.inspect.conformity import Limits, Verdict
from core.inspect.evaluate import Inspection, evaluate
from core.inspect.faces import FacePair
from core.inspect.gauge import measure_gauge
from core.inspect.plan.conditions import Master
from core.inspect.plan.feature_spec import FeatureSpec, InBox
from core.inspect.plan.inspection_plan import InspectionPlan
from core.model.arrays import Array
from core.scan.surface.cloud import FAN, Cloud
from tests.inspect.block_scan import BlockScan
from tests.inspect.shape_scan import BALL, PIN, ShapeScan
from tests.scan_facts import NOTHING_WRONG

BLOCK = BlockScan(height=30.0, sweeps=24)
ERRORS = BLOCK.errors()
SHAPES = ShapeScan()
WHOLE = InBox((-200.0, -200.0, 0.0), (200.0, 200.0, 1000.0))


def scan(seed: int = 0) -> Cloud:
    return BLOCK.measure(np.random.default_rng(seed))


def one_line_below(cloud: Cloud) -> tuple[Cloud, FacePair]:
    """The points on the block, and on the table those of one line of the fan."""
    kept = cloud.select(BLOCK.upper | (cloud.sweep == FAN))
    upper = BLOCK.upper[BLOCK.upper | (cloud.sweep == FAN)]
    return kept, FacePair(np.flatnonzero(upper), np.flatnonzero(~upper))


def measured(kind: str, cloud: Cloud, middle: Array, radius_mm: float) -> Inspection:
    """A feature of this kind over all points within so many mm of a place."""
    near = cloud.select(np.linalg.norm(cloud.points - middle, axis=1) < radius_mm)
    return evaluate(InspectionPlan((FeatureSpec("it", kind, (WHOLE,)),)), near, errors=SHAPES.errors)


def test_a_face_of_one_stripe_has_no_flatness_and_no_angle_and_proves_nothing() -> None:
    cloud, pair = one_line_below(scan())
    gauge = measure_gauge(cloud, errors=ERRORS, regions=pair, nominal_mm=30.0, tolerance_mm=1.0)
    assert gauge.thickness_mm == pytest.approx(30.0, abs=0.1)
    assert gauge.verdict == Verdict.NOT_PROVEN
    assert gauge.lower.flatness_mm is None
    assert gauge.upper.flatness_mm is not None
    assert gauge.parallelism is None
    assert gauge.normal is not None
    assert abs(gauge.lower.plane.normal @ gauge.normal) == pytest.approx(1.0)  # not that of the light plane
    assert "lower face" in str(gauge.notes[0])


def test_two_lines_on_a_face_span_it() -> None:
    cloud = scan()
    kept = BLOCK.upper | np.isin(cloud.sweep, [FAN, FAN - 1])
    upper = BLOCK.upper[kept]
    pair = FacePair(np.flatnonzero(upper), np.flatnonzero(~upper))
    gauge = measure_gauge(cloud.select(kept), errors=ERRORS, regions=pair, nominal_mm=30.0, tolerance_mm=1.0)
    assert gauge.verdict == Verdict.CONFORMING
    assert gauge.parallelism is not None


def test_a_thickness_of_a_plan_proves_nothing_either_even_by_a_master(monkeypatch: pytest.MonkeyPatch) -> None:
    cloud, pair = one_line_below(scan())
    limits = (("thickness", Limits(30.0, -1.0, 1.0)),)
    master = Master("gauge block", 30.0, 0.001, 30.0, (), ("thick",))
    plan = InspectionPlan((FeatureSpec("thick", "thickness", limits=limits),), master=master)
    errors = replace(ERRORS, facts=replace(NOTHING_WRONG, size_unconfirmed=True))
    assert evaluate(plan, scan(), errors=errors).verdict == Verdict.CONFORMING
    monkeypatch.setattr("core.inspect.features.thickness._faces", lambda spec, scene: pair)
    (row,) = evaluate(plan, cloud, errors=errors).characteristics
    assert row.by_master
    assert row.verdict == Verdict.NOT_PROVEN


def test_a_level_of_one_stripe_proves_no_height(monkeypatch: pytest.MonkeyPatch) -> None:
    cloud, pair = one_line_below(scan())
    limits = (("height", Limits(0.0, -1.0, 1.0)),)
    plan = InspectionPlan((FeatureSpec("step", "steps", limits=limits, nominal_heights=(30.0,)),))
    assert evaluate(plan, scan(), errors=ERRORS).verdict == Verdict.CONFORMING
    monkeypatch.setattr("core.inspect.features.steps._levels", lambda spec, scene: [pair.lower, pair.upper])
    (row,) = evaluate(plan, cloud, errors=ERRORS).characteristics
    assert row.value == pytest.approx(30.0, abs=0.1)
    assert row.verdict == Verdict.NOT_PROVEN
    assert "level 1" in str(row.notes[0])


@pytest.mark.parametrize("kind", ["plane", "sphere", "cylinder"])
def test_a_surface_of_one_stripe_is_refused(kind: str) -> None:
    cloud = SHAPES.measure(np.random.default_rng(0))
    middle = {"plane": BALL + [-50.0, 0.0, 20.0], "sphere": BALL, "cylinder": PIN}[kind]
    on = {"plane": 2, "sphere": 0, "cylinder": 1}[kind]
    mine = cloud.select(SHAPES.on == on)
    stripe = int(np.argmax(np.bincount(mine.sweep)))
    inspection = measured(kind, mine.select(mine.sweep == stripe), middle, 200.0)
    assert inspection.unmeasured or inspection.problems
    assert measured(kind, mine, middle, 200.0).problems == ()
