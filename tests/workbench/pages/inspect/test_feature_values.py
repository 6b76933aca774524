"""A feature as fields of a form, and back."""

import math

import pytest

from core.inspect.conformity import Limits
from core.inspect.plan.feature_spec import Auto, FeatureSpec, InBox, InSphere, PointsOf, Polygon, Section
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.plan.kinds import KINDS
from workbench.pages.inspect.features import values as fields

SIZE = (640, 480)
PLANES = InspectionPlan((FeatureSpec("top", "plane"), FeatureSpec("table", "plane")))
ALL = InspectionPlan((*PLANES.features, FeatureSpec("pin", "cylinder"), FeatureSpec("hole", "cylinder")))


def made(kind, plan=ALL):
    return fields.new_feature(kind, "new", plan, SIZE, "part.stl")


@pytest.mark.parametrize("kind", [kind.name for kind in KINDS])
def test_a_new_feature_fits_into_a_plan(kind):
    assert not fields.why_not(kind, ALL)
    InspectionPlan((*ALL.features, made(kind))).ordered()


@pytest.mark.parametrize("kind", [kind.name for kind in KINDS])
def test_every_field_can_be_set_to_what_it_is(kind):
    spec = fields.with_new_cut(made(kind))
    for key, value in fields.values_of(spec).items():
        if not key.startswith("limits "):
            assert fields.with_value(spec, key, value) == spec, key


def test_without_two_elements_there_is_no_distance():
    assert "made of two other features" in fields.why_not("distance", InspectionPlan(PLANES.features[:1]))


def test_the_angle_is_shown_in_degrees_and_kept_in_radians():
    values = {"limits nominal angle": 90.0, "limits lower angle": -0.5, "limits upper angle": 0.5}
    spec = fields.with_limits(made("angle"), "angle", values)
    ((result, limits),) = spec.limits
    assert result == "angle" and limits.nominal == pytest.approx(math.pi / 2)
    assert limits.upper == pytest.approx(math.radians(0.5))
    assert fields.limits_values(spec, "angle") == pytest.approx(values)


def test_a_form_has_an_upper_limit_alone():
    spec = fields.with_limits(made("plane"), "flatness", {"limits upper flatness": 0.05})
    assert spec.limits == (("flatness", Limits(0.0, -math.inf, 0.05)),)
    assert fields.with_limits(spec, "flatness", {"limits upper flatness": None}).limits == ()


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ((50.0, None, None), "Enter a lower or an upper deviation"),
        ((None, -0.1, 0.1), "Enter the nominal value too"),
        ((50.0, 0.2, 0.1), "above the upper one"),
    ],
)
def test_half_limits_are_told(values, sentence):
    keys = [f"limits {side} diameter" for side in fields.SIDES]
    with pytest.raises(ValueError, match=sentence):
        fields.with_limits(made("sphere"), "diameter", dict(zip(keys, values, strict=True)))


def test_regions_come_from_faces_by_number_or_from_other_features():
    spec = fields.with_value(made("thickness"), "parts", 2)
    assert spec.regions == (Auto(1), Auto(2))
    spec = fields.with_value(spec, "source 1", fields.POINTS_OF + "table")
    assert spec.regions == (Auto(1), PointsOf("table"))
    drawn = fields.with_region(spec, 0, Polygon(((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))))
    assert fields.values_of(drawn)["source 0"] == fields.DRAWN
    assert fields.with_value(drawn, "parts", None).regions == drawn.regions[:1]


AT = Section(point_mm=(1234.567, -0.001, 12.0), normal=(0.017452406, -0.999847695, 0.0))


def test_a_section_by_numbers_shows_its_place_and_direction_in_part_coordinates():
    spec = fields.new_feature("section", "new", ALL, SIZE, section=AT)
    values = fields.values_of(spec)
    assert values["place"] == "1234.567; -0.001; 12" and values["direction"] == "0.017452406; -0.999847695; 0"
    assert not any(key.startswith("line ") for key in values)
    for key, value in values.items():
        if not key.startswith("limits "):
            assert fields.with_value(spec, key, value) == spec, key
    moved = fields.with_value(fields.with_value(spec, "place", "10; 20,5; \N{MINUS SIGN}3"), "direction", "1; 1; 0")
    assert moved.section.point_mm == (10.0, 20.5, -3.0) and moved.section.normal == (1.0, 1.0, 0.0)
    assert moved.section.line_px is None


@pytest.mark.parametrize("text", ["", "10; 20", "1; 2; 3; 4", "ten; 2; 3", "1; 2; inf", "1 2 3"])
def test_a_place_that_is_none_is_refused_with_one_sentence(text):
    spec = fields.new_feature("section", "new", ALL, SIZE, section=AT)
    with pytest.raises(ValueError, match=r"^Write x, y and z in mm with semicolons between them, as 10; 20; 0.$"):
        fields.with_value(spec, "place", text)


@pytest.mark.parametrize("text", ["", "1; 0", "x; 0; 0", "0; 0; 0", "0; 0; 1", "0; 0; -2", "0; nan; 1"])
def test_a_direction_that_cannot_be_measured_in_is_refused_with_one_sentence(text):
    spec = fields.new_feature("section", "new", ALL, SIZE, section=AT)
    with pytest.raises(ValueError, match=r"^Write x, y and z with semicolons between them, as 0; 1; 0: .* not along z"):
        fields.with_value(spec, "direction", text)


SPHERE, BOX = InSphere((1.0, 2.0, 1234.567), 5.0), InBox((0.0, 1.0, -2.0), (10.0, 20.0, 5.0))


@pytest.mark.parametrize("region", [SPHERE, BOX])
def test_a_region_of_part_coordinates_stands_in_fields(region):
    spec = fields.with_region(made("plane"), 0, region)
    for key, value in fields.values_of(spec).items():
        if not key.startswith("limits "):
            assert fields.with_value(spec, key, value) == spec, key


def test_a_sphere_and_a_box_are_chosen_and_typed():
    spec = fields.with_value(made("plane"), "source 0", "sphere")
    spec = fields.with_value(fields.with_value(spec, "centre 0", "1; 2,5; 3"), "radius 0", 4.0)
    assert spec.regions == (InSphere((1.0, 2.5, 3.0), 4.0),)
    spec = fields.with_value(spec, "source 0", "box")
    spec = fields.with_value(fields.with_value(spec, "high 0", "20; 21; 22"), "low 0", "1; 2; 3")
    assert spec.regions == (InBox((1.0, 2.0, 3.0), (20.0, 21.0, 22.0)),)
    assert fields.with_value(spec, "source 0", "auto").regions == (Auto(),)


@pytest.mark.parametrize(
    ("region", "key", "text", "sentence"),
    [
        (SPHERE, "centre 0", "1; 2", "Write x, y and z in mm"),
        (BOX, "low 0", "", "Write x, y and z in mm"),
        (BOX, "high 0", "10; 1; 5", "Each of the smallest x, y and z is to be below the largest one."),
    ],
)
def test_a_region_that_is_none_is_refused_with_one_sentence(region, key, text, sentence):
    with pytest.raises(ValueError, match=sentence):
        fields.with_value(fields.with_region(made("plane"), 0, region), key, text)


def test_a_sphere_reaches_round_the_box_it_is_made_for():
    sphere = fields.around("sphere", (0.0, 0.0, 0.0), (3.0, 4.0, 0.001))
    assert sphere.centre_mm[:2] == (1.5, 2.0) and 2.5 < sphere.radius_mm < 2.502


def test_heights_are_read_with_semicolons_and_refused_with_a_sentence():
    spec = fields.with_value(made("steps"), "nominal_heights", "10; 20,5 ;30")
    assert spec.nominal_heights == (10.0, 20.5, 30.0)
    with pytest.raises(ValueError, match="semicolons"):
        fields.with_value(spec, "nominal_heights", "ten")


def test_what_is_asked_of_a_cut_follows_its_name_and_goes_with_it():
    spec = fields.with_new_cut(fields.with_new_cut(made("section")))
    values = dict(zip((f"limits {side} height 1" for side in fields.SIDES), (5.0, -0.1, 0.1), strict=True))
    spec = fields.with_value(fields.with_limits(spec, "height 1", values), "cut 0 name", "rib")
    assert spec.limits[0][0] == "rib"
    with pytest.raises(ValueError, match="a name of its own"):
        fields.with_value(spec, "cut 0 name", "height 2")
    assert fields.without_cut(spec, 0).limits == ()
