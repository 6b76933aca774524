"""plan.toml: read, written again the same, and refused with a sentence."""

import math

import pytest

from core.errors import InputError
from core.files.plan.plan_file import read_plan, write_plan
from core.findings.proof import Doubt
from core.inspect.causes import Cause
from core.inspect.conformity import Limits
from core.inspect.plan.conditions import Master, Temperature
from core.inspect.plan.feature_spec import (
    Auto,
    Cut,
    Deviation,
    FaceAt,
    FeatureSpec,
    Filters,
    InBox,
    InSphere,
    PointsOf,
    Polygon,
    Position,
    Section,
)
from core.inspect.plan.inspection_plan import InspectionPlan, PartFrame

SQUARE = Polygon(((800.0, 500.0), (1100.5, 500.0), (950.0, 800.0)))
EVERYTHING = InspectionPlan(
    features=(
        FeatureSpec("top", "plane", (SQUARE,), filters=Filters(0.05, 2.0, 3.0, 4.0)),
        FeatureSpec("side", "plane", (Auto(3),), limits=(("flatness", Limits(0.0, -math.inf, 0.05)),)),
        FeatureSpec("ball", "sphere", limits=(("diameter", Limits(50.0, -0.05, 0.05)),)),
        FeatureSpec("pin", "cylinder", (InBox((0.0, 0.0, 0.0), (10.0, 20.0, 30.0)),)),
        FeatureSpec("corner", "point", (InSphere((1.0, 2.0, 3.0), 4.0),)),
        FeatureSpec("block", "thickness", (SQUARE, PointsOf("side"))),
        FeatureSpec("step", "thickness", (FaceAt(at_px=(812.5, 640.25)), FaceAt(at_mm=(1.5, -2.0, 40.0)))),
        FeatureSpec(
            "steps",
            "steps",
            limits=(("height", Limits(0.0, -0.1, 0.2)),),
            nominal_heights=(40.0, 50.0),
            over="previous",
        ),
        FeatureSpec("gap", "distance", of=("ball", "top")),
        FeatureSpec("lean", "angle", of=("side", "top"), limits=(("angle", Limits(math.pi / 2, -0.01, 0.01)),)),
        FeatureSpec(
            "cut", "section", section=Section(((1.0, 2.0), (3.0, 4.0)), cuts=(Cut("r1", "radius", (1.0, 2.0)),))
        ),
        FeatureSpec("cut 2", "section", section=Section(None, (1.0, 2.0, 3.0), (0.0, 1.0, 0.0), 0.5, 0.2)),
        FeatureSpec("form", "deviation", deviation=Deviation("part.stl", "frame", 0.2, 3.0)),
        FeatureSpec("hole", "cylinder"),
        FeatureSpec("lies", "position", of=("hole",), position=Position((10.0, 20.0, 0.5))),
        FeatureSpec("reach", "distance", (), of=("ball", "side")),
    ),
    frame=PartFrame("top", "side", "ball"),
    temperature=Temperature(22.0, 0.5, 11.5e-6, 1e-6),
    master=Master("M50", 50.0001, 0.0001, 50.02, ((Cause.CAMERA, 0.01),), ("block",), True, (Doubt.named("moved"),)),
    k=2.5,
)


def test_a_plan_comes_back_as_it_was_written(tmp_path):
    path = tmp_path / "plan.toml"
    write_plan(path, EVERYTHING)
    again = read_plan(path)
    lean = again.feature("lean").limits_of("angle")
    assert lean.nominal == pytest.approx(math.pi / 2, rel=1e-15)
    assert lean.upper == pytest.approx(0.01, rel=1e-14)
    plain = [feature for feature in again.features if feature.name != "lean"]
    assert plain == [feature for feature in EVERYTHING.features if feature.name != "lean"]
    assert (again.frame, again.temperature, again.master, again.k) == (
        EVERYTHING.frame,
        EVERYTHING.temperature,
        EVERYTHING.master,
        2.5,
    )


def test_a_form_has_its_tolerance_above_only(tmp_path):
    path = tmp_path / "plan.toml"
    path.write_text('[[feature]]\nname = "a"\nkind = "plane"\nlimits.flatness = { tolerance_mm = 0.05 }\n')
    assert read_plan(path).features[0].limits_of("flatness") == Limits(0.0, -math.inf, 0.05)


MASTER = '[master]\nname = "M50"\ncertified_mm = 50\nu_certified_mm = 0.0001\nfeatures = ["a"]\nmeasured_mm = 50.02\n'
FEATURE = '[[feature]]\nname = "a"\nkind = "plane"\n'


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (FEATURE + "colour = 1\n", r"feature\[0\]\.colour is an unknown key"),
        (FEATURE.replace("plane", "plain"), "plane, sphere, cylinder"),
        (FEATURE + "region = { polygon_px = [[1, 2], [3, 4]] }\n", "three or more"),
        (FEATURE + "region = { number = 1, points_of = 'b' }\n", "one of them, not number and points_of"),
        (FEATURE + "region = { face_at_px = [1, 2], face_at_mm = [1, 2, 3] }\n", "not face_at_px and face_at_mm"),
        (FEATURE + "region = { face_at_mm = [1, 2] }\n", "in part coordinates"),
        (FEATURE + "limits.diameter = { nominal_mm = 1, tolerance_mm = 1 }\n", "gives flatness, not diameter"),
        (FEATURE + "limits.flatness = { nominal_mm = 1 }\n", "tolerance_mm is missing"),
        (FEATURE + "limits.flatness = { lower_mm = 2, upper_mm = 1 }\n", "above upper_mm"),
        (FEATURE + FEATURE, "two features have this name"),
        (FEATURE + "region = { points_of = 'b' }\n", "no feature 'b'"),
        ('[[feature]]\nname = "d"\nkind = "distance"\nof = ["d", "e"]\n', "no feature 'e'"),
        (FEATURE + "region = { points_of = 'a' }\n", "rests on itself"),
        (FEATURE + "regions = []\n", "has no region"),
        (FEATURE + MASTER, r"master\.budget is missing: how uncertain measured_mm is .* as in budget = \[\{ source"),
        (FEATURE + MASTER + "budget = []\n", r"master\.budget is missing"),
        ("k = [\n", "no valid TOML"),
        ('[temperature]\npart_celsius = "warm"\n', "temperature in °C"),
    ],
)
def test_a_wrong_plan_is_refused_by_name(tmp_path, text, said):
    path = tmp_path / "plan.toml"
    path.write_text(text)
    with pytest.raises(InputError, match=said) as complaint:
        read_plan(path)
    assert "plan.toml" in complaint.value.where


def test_a_missing_plan_is_said(tmp_path):
    with pytest.raises(InputError, match="missing"):
        read_plan(tmp_path / "plan.toml")
