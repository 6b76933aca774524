"""Geometry as DXF: read back by another reading, in mm, the same bytes each time; found where the part is."""

import json

import ezdxf
import numpy as np
import pytest

from core.errors import InputError
from core.files.exchange.dxf import layer_name, write_dxf
from core.files.results.geometry_file import read_geometry
from core.files.results.inspection_file import write_inspection
from core.inspect.evaluate import evaluate
from core.inspect.geometry import Curve, CylinderShape, Geometry, Outline, SphereShape, curves, cylinder, outlines
from core.inspect.plan.feature_spec import FeatureSpec, Section
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.shown.view_frame import CAMERA_FRAME, FrameKind, ViewFrame
from core.model import Pose
from tests.inspect.test_evaluate import BLOCK, ERRORS, PLANES

SQUARE = np.array([[0.0, 0, 5], [10, 0, 5], [10, 20, 5], [0, 20, 5]])
AXIS = np.array([1.0, 2.0, 2.0]) / 3
EVERY = Geometry(
    (
        Outline("top: ü", SQUARE),
        SphereShape("ball", np.array([1.0, 2, 3]), 12.5),
        CylinderShape("bore", np.array([[4.0, 5, 6], [4, 5, 6] + 30 * AXIS]), 8.0),
        Curve("cut A", np.array([[0.0, 0, 0], [1, 0, 0.5], [2, 0, 0.25]])),
    ),
    FrameKind.PART,
)


def read(path):
    document = ezdxf.readfile(path)
    audit = document.audit()
    assert (audit.errors, audit.fixes) == ([], [])
    return document


def test_every_kind_is_read_back_without_errors_in_millimetres(tmp_path):
    write_dxf(tmp_path / "a.dxf", EVERY)
    document = read(tmp_path / "a.dxf")
    assert (document.units, document.header["$MEASUREMENT"]) == (ezdxf.units.MM, 1)
    assert document.header["$PROJECTNAME"] == "the part, coordinates of the inspection plan"
    space = document.modelspace()
    assert {one.dxf.layer for one in space} == {"top_ ü", "ball", "bore", "cut A"}
    (outline,) = space.query('POLYLINE[layer=="top_ ü"]')
    assert outline.is_closed and np.allclose([tuple(one) for one in outline.points()], SQUARE)
    (curve,) = space.query('POLYLINE[layer=="cut A"]')
    assert not curve.is_closed and np.allclose([tuple(one) for one in curve.points()], EVERY.drawn[3].places)
    circles = space.query('CIRCLE[layer=="ball"]')
    assert len(circles) == 3
    for circle in circles:
        assert np.allclose(circle.ocs().to_wcs(circle.dxf.center), [1, 2, 3]) and circle.dxf.radius == 12.5
    ends = space.query('CIRCLE[layer=="bore"]')
    assert np.allclose([circle.ocs().to_wcs(circle.dxf.center) for circle in ends], EVERY.drawn[2].ends)
    assert all(np.allclose(circle.dxf.extrusion, AXIS) and circle.dxf.radius == 8 for circle in ends)


def test_the_same_geometry_gives_the_same_bytes(tmp_path):
    for name in ("a", "b"):
        write_dxf(tmp_path / name, EVERY)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()
    assert not ezdxf.options.write_fixed_meta_data_for_testing, "the library is left as it was"


def test_a_layer_is_called_as_dxf_permits():
    assert layer_name('a<b>/"c" | d') == "a_b___c_ _ d"
    assert layer_name(" ") == "_"


def test_outlines_tubes_and_curves_are_where_their_points_are():
    rng = np.random.default_rng(0)
    flat = np.column_stack([rng.uniform(0, 10, 500), rng.uniform(0, 20, 500), np.zeros(500)])
    both = np.concatenate([flat, flat + [0, 0, 8.0]])
    low, high = outlines("step", np.array([0.0, 0, 1]), np.array([[5.0, 5, 0], [5, 5, 8]]), both)
    assert np.allclose(low.corners[:, 2], 0) and np.allclose(high.corners[:, 2], 8)
    assert np.ptp(low.corners, axis=0)[:2] == pytest.approx([10, 20], abs=0.5)
    assert outlines("line", np.array([0.0, 0, 1]), np.zeros((1, 3)), np.outer(np.arange(5.0), [1, 0, 0])) == []
    found = cylinder("bore", np.zeros(3), np.array([0.0, 0, 1]), 5.0, np.array([[5.0, 0, -2], [0, 5, 7]]))
    assert np.allclose(found.ends, [[0, 0, -2], [0, 0, 7]])
    position = np.concatenate([np.arange(0, 10, 0.1), np.arange(30, 40, 0.1)])
    profile = np.column_stack([position, np.full(len(position), 2.0)])
    first, second = curves("cut", np.array([1.0, 1, 1]), np.eye(3)[[0, 2]], profile, 0.5)
    assert np.allclose(first.places[:, 1:], [1, 3]) and second.places[0, 0] == pytest.approx(31.2, abs=0.2)


@pytest.fixture(scope="module")
def scanned():
    cloud = BLOCK.measure(np.random.default_rng(3))
    section = Section(line_px=((760.0, 1300.0), (1400.0, 1350.0)), half_width_mm=3.0)
    plan = InspectionPlan((*PLANES, FeatureSpec("cut", "section", section=section)))
    return cloud.points, evaluate(plan, cloud, errors=ERRORS)


def inspected(folder, inspection, **changes):
    path = folder / "inspection.json"
    write_inspection(path, inspection)
    path.write_text(json.dumps(json.loads(path.read_text()) | changes))
    return path


def test_an_inspections_geometry_lies_on_its_points_in_the_frame_asked_for(tmp_path, scanned):
    points, inspection = scanned
    path = inspected(tmp_path, inspection)
    in_camera = read_geometry(path, points, CAMERA_FRAME)
    by_name = {one.name: one for one in in_camera.drawn}
    top, cut = by_name["top"], by_name["cut"]
    used = points[inspection.result("top").indices]
    assert np.linalg.norm(top.corners[:, None] - used[None], axis=2).min(axis=1).max() < 0.2, "corners lie on points"
    near = np.linalg.norm(cut.places[:, None] - points[None], axis=2).min(axis=1)
    assert np.median(near) < 1.0, "the curve runs through the cloud"
    pose = Pose.from_vector([0.1, -0.2, 0.3, 5.0, 6.0, 700.0])
    in_part = read_geometry(path, points, ViewFrame(FrameKind.PART, pose))
    assert np.allclose(pose.apply(in_part.drawn[0].corners), in_camera.drawn[0].corners)
    write_dxf(tmp_path / "a.dxf", in_part)
    assert len(read(tmp_path / "a.dxf").modelspace()) == len(in_part.drawn)


def test_what_cannot_be_drawn_is_told(tmp_path, scanned):
    points, inspection = scanned
    with pytest.raises(InputError, match="of another scan"):
        read_geometry(inspected(tmp_path, inspection), points[:10], CAMERA_FRAME)
    path = inspected(tmp_path, inspection).with_suffix(".npz")
    arrays = dict(np.load(path))
    np.savez(path, **(arrays | {"points_0": np.array([-(2**62)])}))
    with pytest.raises(InputError, match="of another scan"):
        read_geometry(path.with_suffix(".json"), points, CAMERA_FRAME)
    with pytest.raises(InputError, match="no plane, sphere, cylinder or section"):
        read_geometry(inspected(tmp_path, inspection, features=[]), points, CAMERA_FRAME)
    tables = json.loads(inspected(tmp_path, inspection).read_text())
    for feature in tables["features"]:
        feature.pop("section", None)
    with pytest.raises(InputError, match="does not say where the section cut lies"):
        read_geometry(inspected(tmp_path, inspection, features=tables["features"]), points, CAMERA_FRAME)
