"""Features on a face that was clicked: measured over all of it, and found again on the next part."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.errors import InputError
from core.inspect.evaluate import evaluate
from core.inspect.plan.feature_spec import Auto, FaceAt, FeatureSpec, Filters, Section
from core.inspect.plan.inspection_plan import InspectionPlan, PartFrame
from core.model import Pose
from core.scan.surface.cloud import Cloud
from core.scan.surface.normals import with_normals
from tests.inspect.block_scan import BlockScan, pixels
from tests.inspect.shape_scan import BALL, BALL_RADIUS, ShapeScan

BLOCK, SHAPES = BlockScan(), ShapeScan()
FACES = ("table", "plane"), ("pin", "cylinder"), ("ball", "sphere")


@pytest.fixture(scope="module")
def block():
    return BLOCK.measure(np.random.default_rng(1))


@pytest.fixture(scope="module")
def shapes():
    return with_normals(SHAPES.measure(np.random.default_rng(1)))


def seen(cloud: Cloud, which, number=40) -> FaceAt:
    """Clicked where one of the points lies."""
    u, v = cloud.uv[np.flatnonzero(which)[number]]
    return FaceAt(at_px=(float(u), float(v)))


def measured(cloud, *features, frame=None):
    found = evaluate(InspectionPlan(features, frame), cloud)
    assert found.problems == (), found.problems
    return found


def value(inspection, name):
    return {row.name: row for row in inspection.characteristics}[name]


def test_a_thickness_between_clicked_faces_is_that_of_the_faces_found(block):
    clicked = FeatureSpec("clicked", "thickness", (seen(block, BLOCK.upper), seen(block, ~BLOCK.upper)))
    inspection = measured(block, clicked, FeatureSpec("found", "thickness"))
    mine, automatic = value(inspection, "clicked thickness"), value(inspection, "found thickness")
    assert mine.value == pytest.approx(automatic.value, abs=0.2 * automatic.U)
    assert mine.value == pytest.approx(40.0, abs=mine.U)
    used = inspection.result("clicked").indices
    assert len(np.intersect1d(used, inspection.result("found").indices)) > 0.98 * len(used)


def test_steps_of_clicked_levels_are_measured(block):
    levels = seen(block, ~BLOCK.upper), seen(block, BLOCK.upper)
    (row,) = measured(block, FeatureSpec("steps", "steps", levels)).characteristics
    assert row.value == pytest.approx(40.0, abs=row.U)


def test_the_margin_and_the_largest_sigma_hold_for_a_clicked_face(block):
    region = (seen(block, BLOCK.upper),)
    limit = float(np.median(block.sigma[BLOCK.upper]))
    features = (
        FeatureSpec("whole", "plane", region, filters=Filters(margin_mm=0.0)),
        FeatureSpec("inner", "plane", region, filters=Filters(margin_mm=5.0)),
        FeatureSpec("sure", "plane", region, filters=Filters(margin_mm=0.0, sigma_max_mm=limit)),
    )
    inspection = measured(block, *features)
    whole, inner, sure = (inspection.result(one.name).indices for one in features)
    for part in (inner, sure):
        assert 100 < len(part) < 0.9 * len(whole) and BLOCK.upper[part].all()
    assert block.sigma[sure].max() <= limit
    size = {name: np.ptp(block.points[inspection.result(name).indices, :2], axis=0) for name in ("whole", "inner")}
    assert np.all(size["inner"] < size["whole"] - 7.0)


def test_clicked_round_surfaces_are_measured_as_what_they_are(shapes):
    features = [FeatureSpec(name, kind, (seen(shapes, SHAPES.on == on),)) for (name, kind), on in
                zip(FACES, (2, 1, 0), strict=True)]  # fmt: skip
    inspection = measured(shapes, *features)
    for row, diameter in (("pin diameter", 30.0), ("ball diameter", 40.0)):
        assert value(inspection, row).value == pytest.approx(diameter, abs=0.1)
    for name, on in (("pin", 1), ("ball", 0), ("table", 2)):
        assert np.mean(SHAPES.on[inspection.result(name).indices] == on) > 0.99


def test_a_section_keeps_to_a_clicked_face(block):
    (left, top), (right, bottom) = block.uv.min(axis=0), block.uv.max(axis=0)
    middle = float(top + bottom) / 2
    line = Section(((float(left), middle), (float(right), middle)), half_width_mm=5.0)
    inspection = measured(block, FeatureSpec("cut", "section", (seen(block, BLOCK.upper),), section=line))
    assert np.all(BLOCK.upper[inspection.result("cut").indices])


def displaced(cloud: Cloud) -> Cloud:
    """The next part: turned and put down elsewhere in the camera's view."""
    pose = Pose(Rotation.from_rotvec([0.03, -0.05, 0.5]).as_matrix(), np.array([12.0, -8.0, 4.0]))
    middle = np.array([0.0, 0.0, 545.0])
    points = pose.apply(cloud.points - middle) + middle
    return replace(cloud, points=points, uv=pixels(points), normals=np.zeros((len(cloud), 3)))


def test_a_template_finds_the_same_face_on_a_part_that_lies_elsewhere(shapes):
    frame, base = PartFrame("table", "pin"), (FeatureSpec("table", "plane"), FeatureSpec("pin", "cylinder"))
    pose = measured(shapes, *base, frame=frame).pose_camera_part
    top = BALL - [0.0, 3.0, np.sqrt(BALL_RADIUS**2 - 9.0)]
    template = FeatureSpec("ball", "sphere", (FaceAt(at_mm=tuple(pose.inverse().apply(top[None])[0])),))
    for cloud in (shapes, displaced(SHAPES.measure(np.random.default_rng(2)))):
        inspection = measured(cloud, template, *base, frame=frame)
        assert np.mean(SHAPES.on[inspection.result("ball").indices] == 0) > 0.99
        assert value(inspection, "ball diameter").value == pytest.approx(2 * BALL_RADIUS, abs=0.1)


def test_a_face_in_part_coordinates_waits_for_them(block):
    placed = FeatureSpec("top", "plane", (FaceAt(at_mm=(0.0, 0.0, 40.0)),))
    assert placed.in_part_coordinates
    assert not FeatureSpec("top", "plane", (FaceAt(at_px=(9.0, 9.0)),)).in_part_coordinates
    plan = InspectionPlan((placed, FeatureSpec("table", "plane")), PartFrame("table", "top"))
    with pytest.raises(InputError, match="rests on itself"):
        evaluate(plan, block)


@pytest.mark.parametrize("region", [FaceAt(at_px=(5.0, 5.0)), FaceAt(at_mm=(500.0, 0.0, 0.0))])
def test_where_nothing_was_measured_there_is_no_face(block, region):
    inspection = evaluate(InspectionPlan((FeatureSpec("a", "plane", (region,)),)), block)
    assert "nothing was measured at the place that was clicked" in str(inspection.problems[0])


def test_a_stray_point_where_a_face_was_clicked_does_no_harm(block):
    u, v = block.uv[np.flatnonzero(BLOCK.upper)[300]]
    at = int(np.argmin(np.linalg.norm(block.uv - [u, v], axis=1)))
    points = np.array(block.points)
    points[at] *= 1.02
    stray = replace(block, points=points)
    found = measured(stray, FeatureSpec("top", "plane", (FaceAt(at_px=(float(u), float(v))),)))
    assert BLOCK.upper[found.result("top").indices].all() and at not in found.result("top").indices


def test_a_face_smaller_than_its_margin_is_refused(block):
    wide = FeatureSpec("a", "plane", (seen(block, BLOCK.upper),), filters=Filters(margin_mm=40.0))
    inspection = evaluate(InspectionPlan((wide,)), block)
    assert "no plane face" in str(inspection.problems[0])


def test_a_face_is_at_one_place():
    for wrong in ({}, {"at_px": (1.0, 2.0), "at_mm": (1.0, 2.0, 3.0)}):
        with pytest.raises(ValueError, match="one of the two"):
            FaceAt(**wrong)


def test_other_features_can_be_taken_from_a_clicked_one(block):
    features = (
        FeatureSpec("top", "plane", (seen(block, BLOCK.upper),)),
        FeatureSpec("table", "plane", (Auto(1),)),
        FeatureSpec("height", "distance", of=("top", "table")),
    )
    assert value(measured(block, *features), "height distance").value == pytest.approx(40.0, abs=0.1)
