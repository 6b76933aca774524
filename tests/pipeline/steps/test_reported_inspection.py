"""What a report takes from inspection.json."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from core.errors import InputError
from core.files.arrays_file import write_arrays
from core.files.results.inspection_file import write_inspection
from core.inspect.characteristic import Characteristic
from core.inspect.conformity import Limits
from core.inspect.evaluate import Inspection
from core.inspect.features.measured import FeatureResult
from core.inspect.plan.control_frame import ControlFrame
from core.inspect.plan.feature_spec import FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan, PartFrame
from core.pipeline.steps.report_step import with_inspection
from core.report.content import CalibrationMark
from tests.report.report_samples import block_content


@pytest.fixture(scope="module")
def content():
    marks = (CalibrationMark("camera", "aaa", "0" * 64), CalibrationMark("planes", "bbb", "1" * 64))
    return replace(block_content(), calibrations=marks)


def inspected(folder, content, **changes):
    """An inspection.json of a plane and of a comparison with a nominal surface, and the points beside it."""
    row = {"name": "top flatness", "feature": "top", "kind": "flatness", "value": 0.031, "u": 0.004, "k": 2.0,
           "complete": True, "limits": {"nominal": 0.0, "lower": None, "upper": 0.05}, "rule": "range",
           "notes": ["Few points."],
           "budget": [{"source": "camera calibration", "u": 0.004, "dof": None}]}  # fmt: skip
    tables = {
        "schema_version": 1,
        "characteristics": [row],
        "features": [
            {"name": "top", "kind": "plane"},
            {"name": "to CAD", "kind": "deviation"},
            {"name": "ball", "kind": "sphere", "problem": "ball: there is no sphere."},
        ],
        "plan": {"k": 2.0, "feature": [{"name": "to CAD", "kind": "deviation", "deviation": {"tolerance_mm": 0.25}}]},
        "notes": ["Said by the inspection."],
        "calibration_id": "aaa-bbb",
    }
    (folder / "inspection.json").write_text(json.dumps(tables | changes))
    points = content.cloud.points[:50]
    deviation = np.column_stack([points, np.linspace(-0.3, 0.3, 50)])
    write_arrays(folder / "inspection.npz", {"points_0": np.arange(30), "deviation_1": deviation})


def test_without_an_inspection_nothing_is_said_of_one(tmp_path, content):
    assert with_inspection(content, tmp_path) is content


def test_characteristics_points_deviations_and_problems_come_from_the_files(tmp_path, content):
    inspected(tmp_path, content)
    found = with_inspection(content, tmp_path)
    thickness, one = found.characteristics
    assert thickness.kind == "thickness"
    assert (one.name, one.value, one.verdict, one.budget[0].dof) == ("top flatness", 0.031, "conforming", math.inf)
    assert found.points["top"].tolist() == list(range(30))
    assert found.features == {"top flatness": "top"}
    (deviations,) = found.deviations
    assert (deviations.name, deviations.tolerance_mm) == ("to CAD", 0.25)
    assert np.allclose(deviations.uv, content.cloud.uv[:50], atol=0.01), "where the camera sees them"
    for note in ("Said by the inspection.", "ball: there is no sphere.", "top flatness: Few points."):
        assert note in [str(told) for told in found.all_notes]


def test_a_section_brings_its_profile_and_a_distance_is_seen_where_its_first_feature_is(tmp_path, content):
    features = [{"name": name, "kind": "plane"} for name in ("top", "between", "cut")]
    plan = {"feature": [{"name": "between", "of": ["nothing", "top", "cut"]}, {"name": "top"}]}
    inspected(tmp_path, content, features=features, plan=plan)
    profile = np.column_stack([np.linspace(0, 30, 20), np.ones(20)])
    write_arrays(
        tmp_path / "inspection.npz", {"points_0": np.arange(30), "points_1": np.arange(0), "profile_2": profile}
    )
    found = with_inspection(content, tmp_path)
    assert found.seen_at == {"between": "top"}
    assert list(found.sections) == ["cut"] and np.array_equal(found.sections["cut"], profile)


def test_feature_control_frames_and_datums_are_those_the_plan_asked_for(tmp_path, content):
    limits = (("flatness", Limits(0.0, -math.inf, 0.05)),)
    features = (FeatureSpec("top", "plane", limits=limits), FeatureSpec("side", "plane"))
    row = Characteristic("top flatness", "flatness", 0.03, 0.004, limits=limits[0][1], doubts=())
    results = (FeatureResult(features[0], characteristics=(row,)), FeatureResult(features[1]))
    plan = InspectionPlan(features, PartFrame("top", "side"))
    write_inspection(tmp_path / "inspection.json", Inspection(plan, results), "aaa-bbb")
    found = with_inspection(content, tmp_path)
    assert found.datums == {"top": "A", "side": "B"}
    assert found.control_frames == {"top flatness": ControlFrame("flatness", 0.05)}


def test_the_inspection_of_another_scan_is_refused(tmp_path, content):
    inspected(tmp_path, content, calibration_id="ccc-ddd")
    with pytest.raises(InputError, match=r"inspection\.json: is of a scan with calibration ccc-ddd, but this one has"):
        with_inspection(content, tmp_path)


def test_points_that_are_not_in_the_cloud_are_refused(tmp_path, content):
    inspected(tmp_path, content)
    small = replace(content, cloud=content.cloud.select(np.arange(20)), gauge=None, mesh=content.mesh)
    with pytest.raises(InputError, match="top names points that the cloud does not have"):
        with_inspection(small, tmp_path)
