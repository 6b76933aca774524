"""A plan on one scan: values near the truth, honest uncertainties, and only what an edit changed measured again."""

from dataclasses import replace

import numpy as np
import pytest

from core.errors import InputError
from core.findings.proof import Doubt
from core.inspect.causes import Cause
from core.inspect.conformity import Limits, Verdict
from core.inspect.evaluate import evaluate
from core.inspect.plan.conditions import Master, Temperature
from core.inspect.plan.feature_spec import (
    Auto,
    Cut,
    Deviation,
    FeatureSpec,
    Filters,
    PointsOf,
    Polygon,
    Section,
)
from core.inspect.plan.inspection_plan import InspectionPlan
from core.scan.surface.triangles import Triangles
from tests.inspect.block_scan import NORMAL, TABLE_MM, BlockScan, axes
from tests.scan_facts import NOTHING_WRONG

BLOCK = BlockScan(sweeps=24)
ERRORS = BLOCK.errors(12.0)
UNCONFIRMED = replace(NOTHING_WRONG, size_unconfirmed=True)
TOP, TABLE = (Polygon(tuple((float(u), float(v)) for u, v in polygon)) for polygon in BLOCK.polygons)
PLANES = (FeatureSpec("top", "plane", (TOP,)), FeatureSpec("table", "plane", (Auto(1),)))
DERIVED = (
    FeatureSpec("height", "distance", of=("top", "table")),
    FeatureSpec("lean", "angle", of=("top", "table")),
)


@pytest.fixture(scope="module")
def cloud():
    return BLOCK.measure(np.random.default_rng(3), outliers=0.01)


def rows(inspection):
    assert inspection.problems == ()
    return {row.name: row for row in inspection.characteristics}


def test_every_way_to_the_height_of_a_block_agrees_with_the_truth(cloud):
    plan = InspectionPlan((*PLANES, *DERIVED, FeatureSpec("block", "thickness"), FeatureSpec("step", "steps")))
    found = rows(evaluate(plan, cloud, errors=ERRORS))
    for name in ("height distance", "block thickness", "step height 1"):
        assert found[name].value == pytest.approx(40.0, abs=4 * found[name].u)
        assert 1e-4 < found[name].u < 0.01
    assert found["lean angle"].value < 4 * found["lean angle"].u
    assert found["top flatness"].quantity == "length"
    assert found["lean angle"].quantity == "angle"


def test_a_section_gives_the_height_between_two_stretches(cloud):
    cut = Section(
        line_px=((760.0, 1300.0), (1400.0, 1350.0)),
        half_width_mm=3.0,
        cuts=(Cut("rise", "height", (2.0, 20.0), (50.0, 70.0)),),
    )
    inspection = evaluate(InspectionPlan((FeatureSpec("cut", "section", section=cut),)), cloud, errors=ERRORS)
    rise = rows(inspection)["cut rise"]
    assert rise.value == pytest.approx(40.0, abs=4 * rise.u)
    profile = inspection.result("cut").profile
    middle = np.median(profile.mean_height[(profile.mean_position > 50) & (profile.mean_position < 70)])
    assert middle == pytest.approx(40.0, abs=0.2)


@pytest.mark.parametrize("half_width", [0.5, 3.0])
@pytest.mark.parametrize("lean", [pytest.param(0.0, marks=pytest.mark.accuracy), 10.0])
def test_a_height_is_square_to_the_faces_however_the_sections_plane_leans_on_them(cloud, lean, half_width):
    angle, across = np.radians(lean), axes()[1]
    normal = np.cos(angle) * across + np.sin(angle) * NORMAL
    cuts = (Cut("rise", "height", (2.0, 30.0), (55.0, 85.0)),)
    cut = Section(None, tuple((TABLE_MM - 20) * NORMAL), tuple(normal), half_width_mm=half_width, cuts=cuts)
    rise = rows(evaluate(InspectionPlan((FeatureSpec("cut", "section", section=cut),)), cloud, errors=ERRORS))[
        "cut rise"
    ]
    assert rise.value == pytest.approx(40.0, abs=4 * rise.u)
    assert rise.u < 0.15


def test_only_what_an_edit_changed_is_measured_again(cloud):
    plan = InspectionPlan((*PLANES, *DERIVED))
    before = evaluate(plan, cloud, errors=ERRORS)
    edited = replace(plan, features=(replace(PLANES[0], filters=Filters(outliers=3.0)), PLANES[1], *DERIVED))
    after = evaluate(edited, cloud, errors=ERRORS, previous=before)
    same = [a.characteristics is b.characteristics for a, b in zip(before.results, after.results, strict=True)]
    assert same == [False, True, False, False]
    fresh = evaluate(edited, cloud, errors=ERRORS)
    assert [row.value for row in after.characteristics] == [row.value for row in fresh.characteristics]
    moved = evaluate(plan, cloud.select(np.arange(len(cloud) - 1)), errors=ERRORS, previous=before)
    assert not any(a.key == b.key for a, b in zip(before.results, moved.results, strict=True))


def test_a_nominal_surface_concerns_only_what_is_compared_with_it(cloud):
    corners = np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]])
    compared = [FeatureSpec(name, "deviation", deviation=Deviation(f"{name}.stl", "as measured")) for name in "ab"]
    plan = InspectionPlan((PLANES[0], *compared))
    nominals = {"a.stl": Triangles(corners), "b.stl": Triangles(corners)}
    before = evaluate(plan, cloud, errors=ERRORS, nominals=nominals)
    changed = {**nominals, "b.stl": Triangles(corners + 1.0)}
    after = evaluate(plan, cloud, errors=ERRORS, previous=before, nominals=changed)
    assert [a.key == b.key for a, b in zip(before.results, after.results, strict=True)] == [True, True, False]


def test_other_limits_are_decided_without_measuring_again(cloud):
    plan = InspectionPlan((FeatureSpec("block", "thickness"), FeatureSpec("step", "steps", nominal_heights=(40.0,))))
    before = evaluate(plan, cloud, errors=ERRORS)
    tight, wide = Limits(40.5, -0.1, 0.1), Limits(0.0, -0.1, 0.1)
    features = (
        replace(plan.features[0], limits=(("thickness", tight),)),
        replace(plan.features[1], limits=(("height", wide),)),
    )
    after = evaluate(replace(plan, features=features), cloud, errors=ERRORS, previous=before)
    assert [a.indices is b.indices for a, b in zip(before.results, after.results, strict=True)] == [True, True]
    assert [row.verdict for row in after.characteristics] == ["not conforming", "conforming"]
    assert [row.verdict for row in before.characteristics] == ["", ""]
    assert evaluate(plan, cloud, errors=ERRORS, previous=after).verdict == ""


def test_a_feature_that_is_not_there_has_a_problem_and_the_others_are_measured(cloud):
    corner = Polygon(((0.0, 0.0), (5.0, 0.0), (5.0, 5.0)))
    plan = InspectionPlan(
        (
            FeatureSpec("lost", "plane", (corner,), limits=(("flatness", Limits(0.0, -np.inf, 1.0)),)),
            FeatureSpec("gap", "distance", of=("lost", "table")),
            PLANES[1],
        )
    )
    inspection = evaluate(plan, cloud, errors=ERRORS)
    assert len(inspection.problems) == 2
    assert "feature lost" in str(inspection.problems[0])
    assert "lost was not measured" in str(inspection.problems[1])
    assert [row.name for row in inspection.characteristics] == ["table flatness"]
    assert inspection.verdict == "not proven"


def test_points_used_are_named_and_lie_on_the_face(cloud):
    inspection = evaluate(InspectionPlan((PLANES[0], FeatureSpec("again", "plane", (PointsOf("top"),)))), cloud)
    top, again = inspection.results
    assert np.all(np.diff(top.indices) > 0)
    assert BLOCK.upper[top.indices].mean() > 0.99
    assert np.isin(again.indices, top.indices).all()
    assert "less than is known" in str(inspection.notes[0])


def test_lengths_are_stated_at_20_degrees(cloud):
    plan = InspectionPlan((FeatureSpec("block", "thickness"),))
    cold = evaluate(plan, cloud, errors=ERRORS).characteristics[0]
    warm = evaluate(replace(plan, temperature=Temperature(30.0, 1.0, 11.5e-6, 1e-6)), cloud, errors=ERRORS)
    (row,) = warm.characteristics
    assert row.value == pytest.approx(cold.value * (1 - 11.5e-5), abs=1e-12)
    assert row.u == pytest.approx(np.sqrt(cold.u**2 + (40 * 11.5e-6) ** 2 + (40 * 1e-5) ** 2), rel=1e-3)


def test_a_plan_that_cannot_be_is_refused(cloud):
    with pytest.raises(InputError, match="made of 2 other features"):
        evaluate(InspectionPlan((FeatureSpec("gap", "distance", of=("a",)), replace(PLANES[0], name="a"))), cloud)
    with pytest.raises(InputError, match="no angle is made of that"):
        blocks = (FeatureSpec("b", "thickness"), PLANES[0])
        evaluate(InspectionPlan((*blocks, FeatureSpec("x", "angle", of=("b", "top")))), cloud)


@pytest.mark.accuracy
def test_flatness_scatters_as_much_as_its_uncertainty_says():
    plan = InspectionPlan(PLANES[:1])
    found = []
    for seed in range(9):
        scan = BLOCK.measure(np.random.default_rng(seed))
        found += [evaluate(plan, scan, errors=ERRORS).characteristics[0]]
    values, stated = np.array([row.value for row in found]), np.array([row.u for row in found])
    assert 0.4 < values.std(ddof=1) / np.sqrt(np.mean(stated**2)) < 1.8


def test_only_lengths_compared_with_a_master_prove_anything_where_the_size_of_the_target_is_assumed(cloud):
    doubted = replace(ERRORS, facts=UNCONFIRMED)
    master = Master("M", 40.0, 1e-3, 40.001, ((Cause.POINT_NOISE, 1e-3),), ("height",))
    plan = InspectionPlan(
        (
            *PLANES,
            replace(DERIVED[0], limits=(("distance", Limits(40.0, -0.5, 0.5)),)),
            FeatureSpec("block", "thickness"),
        ),
        master=master,
    )
    sure, found = rows(evaluate(plan, cloud, errors=ERRORS)), rows(evaluate(plan, cloud, errors=doubted))
    assert found["height distance"].verdict == sure["height distance"].verdict == Verdict.CONFORMING
    assert found["block thickness"].doubts
    for other in (replace(master, measured_mm=60.0), replace(master, same_calibration=False)):
        of_other = rows(evaluate(replace(plan, master=other), cloud, errors=doubted))
        assert of_other["height distance"].verdict == Verdict.NOT_PROVEN


@pytest.mark.parametrize(
    ("fact", "same", "verdict"),
    [
        ("moved", True, "not proven"),
        ("size_unconfirmed", True, "conforming"),
        ("size_unconfirmed", False, "not proven"),
    ],
)
def test_what_a_master_does_not_prove_nothing_that_is_compared_with_it_does(fact, same, verdict, cloud):
    budget = ((Cause.POINT_NOISE, 1e-3),)
    master = Master("M", 40.0, 1e-3, 40.001, budget, ("height",), same, (Doubt.named(fact),))
    limited = replace(DERIVED[0], limits=(("distance", Limits(40.0, -0.5, 0.5)),))
    row = rows(evaluate(InspectionPlan((*PLANES, limited), master=master), cloud, errors=ERRORS))["height distance"]
    assert row.verdict == verdict
    assert ("By its own results master M proves nothing" in str(row.notes[0])) is (verdict == "not proven")


def test_a_doubt_that_comes_or_goes_has_all_measured_again(cloud):
    plan = InspectionPlan(PLANES)
    before = evaluate(plan, cloud, errors=ERRORS)
    after = evaluate(plan, cloud, errors=replace(ERRORS, facts=UNCONFIRMED), previous=before)
    assert [not row.doubts for row in before.characteristics] == [True] * len(after.characteristics)
    assert [not row.doubts for row in after.characteristics] == [False] * len(after.characteristics)
