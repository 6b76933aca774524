"""Feature control frames and datum letters of a plan."""

import math
from dataclasses import replace

import pytest

from core.inspect.conformity import Limits
from core.inspect.plan.control_frame import ControlFrame, control_frames, datum_letters
from core.inspect.plan.feature_spec import Deviation, FeatureSpec, Position
from core.inspect.plan.inspection_plan import InspectionPlan, PartFrame


def asked(name, kind, result, of=(), **settings):
    return FeatureSpec(name, kind, of=of, limits=((result, Limits(0.0, -math.inf, 0.05)),), **settings)


PLAN = InspectionPlan(
    (
        asked("top", "plane", "flatness"),
        FeatureSpec("base", "plane"),
        FeatureSpec("side", "plane"),
        asked("pin", "cylinder", "form"),
        FeatureSpec("hole", "cylinder"),
        FeatureSpec("ball", "sphere"),
        asked("lie", "parallelism", "parallelism", ("top", "base")),
        asked("run", "parallelism", "parallelism", ("hole", "pin")),
        asked("stand", "perpendicularity", "perpendicularity", ("pin", "base")),
        asked("lean", "perpendicularity", "perpendicularity", ("side", "pin")),
        asked("place", "position", "position", ("hole",), position=Position((1.0, 2.0, 3.0))),
        asked("centre", "position", "position", ("ball",), position=Position((1.0, 2.0, 3.0))),
        asked("shape", "deviation", "profile", deviation=Deviation("part.stl", "frame")),
        FeatureSpec("gap", "distance", of=("ball", "hole")),
    ),
    PartFrame("base", "side"),
)


def test_letters_are_those_of_the_part_coordinates_first_and_features_that_are_no_datum_have_none():
    assert datum_letters(PLAN) == {"base": "A", "side": "B", "pin": "C"}
    assert datum_letters(replace(PLAN, frame=None)) == {"base": "A", "pin": "B"}


@pytest.mark.parametrize(
    ("name", "frame"),
    [
        ("top flatness", ControlFrame("flatness", 0.05)),
        ("pin form", ControlFrame("cylindricity", 0.05)),
        ("lie parallelism", ControlFrame("parallelism", 0.05, "", ("A",))),
        ("run parallelism", ControlFrame("parallelism", 0.05, "⌀", ("C",))),
        ("stand perpendicularity", ControlFrame("perpendicularity", 0.05, "⌀", ("A",))),
        ("lean perpendicularity", ControlFrame("perpendicularity", 0.05, "", ("C",))),
        ("place position", ControlFrame("position", 0.05, "⌀", ("A", "B"))),
        ("centre position", ControlFrame("position", 0.05, "S⌀", ("A", "B"))),
        ("shape profile", ControlFrame("profile of a surface", 0.05, "", ("A", "B"))),
    ],
)
def test_a_frame_has_the_zone_and_the_datums_of_its_feature(name, frame):
    assert control_frames(PLAN)[name] == frame


def test_a_profile_that_is_fitted_refers_to_no_datum():
    fitted = asked("shape", "deviation", "profile", deviation=Deviation("part.stl"))
    assert control_frames(replace(PLAN, features=(*PLAN.features[:-2], fitted)))["shape profile"].datums == ()


def test_without_a_tolerance_there_is_no_frame():
    none = replace(PLAN, features=tuple(replace(one, limits=()) for one in PLAN.features))
    assert control_frames(none) == {}
