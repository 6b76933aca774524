"""What makes a step out of date, and what does not."""

from dataclasses import replace

import numpy as np
import pytest

from core.files.project.data import Accepted, KeptStudy, Repeat, ReportChoices, Sources, new_project
from core.files.project.keys import STEPS, changed, finished, inputs_of
from core.files.recording.rig import GaugeSpec
from core.files.step_graph import CALIBRATED, IN_PROJECT
from core.image.targets import Checkerboard
from core.inspect.plan.feature_spec import FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.uncertainty.part import Part, TargetTemperature
from core.messages import plain

START = replace(
    new_project("block"),
    sources=Sources("recordings/camera-1", "recordings/planes-1", "recordings/scan-1"),
    accepted=Accepted("cam1", "fan1"),
)


def measured(project=START):
    results = {}
    for step in STEPS:
        results[step] = finished(step, project, results)
    return results


def out_of_date(project):
    """Step → the inputs that changed since everything was measured with START."""
    results = measured()
    why = {step: changed(results[step].rests_on, inputs_of(step, project, results)) for step in STEPS}
    return {step: names for step, names in why.items() if names}


def with_options(**changes):
    return replace(START, options=replace(START.options, **changes))


def test_nothing_is_out_of_date_when_all_is_measured():
    assert out_of_date(START) == {}


def test_another_operator_makes_only_the_report_out_of_date():
    project = replace(START, info=replace(START.info, operator="Ada"))
    assert out_of_date(project) == {"report": ("project fields",)}


def test_another_camera_calibration_makes_planes_check_and_scan_out_of_date_and_says_so():
    project = replace(START, accepted=Accepted("cam2", "fan1"))
    assert out_of_date(project) == dict.fromkeys(("planes", "check", "scan"), ("camera calibration",))


@pytest.mark.parametrize(
    ("project", "expected"),
    [
        (with_options(excluded=frozenset({"camera/view03.png"})), {"camera": ("left-out views",)}),
        (with_options(excluded=frozenset({"planes/pose02"})), {"planes": ("left-out poses",)}),
        (with_options(excluded=frozenset({"scan/frame0007.png"})), {"scan": ("left-out frames",)}),
        (with_options(sigma_cut_mm=0.1), {"scan": ("scan settings",)}),
        (with_options(constrain_fan=False), {"planes": ("constraint of the fan",)}),
        (with_options(adjust_camera=True), {"planes": ("adjustment of the camera",)}),
        (with_options(camera=replace(START.options.camera, k3=True)), {"camera": ("camera settings",)}),
        (replace(START, sources=replace(START.sources, scan="recordings/scan-2")), {"scan": ("recording",)}),
        (replace(START, report=ReportChoices(frozenset({"inputs"}))), {"report": ("sections of the report",)}),
        (replace(START, report=ReportChoices(language="de")), {"report": ("sections of the report",)}),
        (replace(START, report=ReportChoices(template="house.toml")), {"report": ("sections of the report",)}),
        (
            replace(START, accepted=Accepted("cam1", "fan2")),
            {"check": ("laser planes",), "scan": ("laser planes",)},
        ),
        (
            replace(START, sources=replace(START.sources, check="recordings/check-1")),
            {"check": ("pictures of the interim check",), "scan": ("pictures of the interim check",)},
        ),
        (
            replace(START, rig=replace(START.rig, gauge=GaugeSpec(50.0, 0.2))),
            {"gauge": ("nominal thickness",)},
        ),
        (
            replace(START, rig=replace(START.rig, gauge=GaugeSpec(None, None, np.eye(3, 2), np.eye(3, 2)))),
            {"gauge": ("thickness regions",)},
        ),
        (
            replace(START, rig=replace(START.rig, camera_target=Checkerboard(9, 6, 10.0))),
            {"camera": ("camera target",)},
        ),
        (
            replace(START, rig=replace(START.rig, part=Part(target=TargetTemperature(23.0, 0.5)))),
            dict.fromkeys(("gauge", "inspection"), ("material and temperature of the part",)),
        ),
    ],
)
def test_an_edit_makes_out_of_date_what_it_changes_and_nothing_else(project, expected):
    assert out_of_date(project) == expected


def test_a_colour_channel_is_in_every_picture():
    project = replace(START, rig=replace(START.rig, channel="green"))
    assert set(out_of_date(project)) == {"camera", "planes", "check", "scan"}


def test_a_scan_measured_anew_with_other_settings_makes_thickness_and_report_out_of_date():
    results = measured()
    project = with_options(sigma_cut_mm=0.1)
    results["scan"] = finished("scan", project, results)
    assert changed(results["gauge"].rests_on, inputs_of("gauge", project, results)) == ("scan",)
    assert changed(results["report"].rests_on, inputs_of("report", project, results)) == ("scan",)


def test_repeats_are_part_of_the_report():
    at = finished("scan", START, {}).at
    project = replace(START, repeats=(Repeat("scan-1", 50.0, 0.01, 2.0, "cam1-fan1", at),))
    assert out_of_date(project) == {"report": ("repeats",)}


def test_an_edit_taken_back_leaves_everything_in_date():
    there = with_options(excluded=frozenset({"scan/frame0007.png"}))
    back = replace(there, options=replace(there.options, excluded=frozenset()))
    assert out_of_date(back) == {}


def test_a_calibration_given_up_is_missed_by_its_own_step():
    assert "accepted camera calibration" in out_of_date(replace(START, accepted=Accepted("", "fan1")))["camera"]


def test_an_unknown_step_is_refused():
    with pytest.raises(ValueError, match="weigh"):
        inputs_of("weigh", START, {})


def test_features_rest_on_the_scan_and_on_the_plan_and_the_report_on_them():
    project, results = new_project(""), {}
    results["scan"] = finished("scan", project, results)
    results["inspection"] = finished("inspection", project, results)
    ball = replace(project, inspection=InspectionPlan((FeatureSpec("ball", "sphere"),)))
    assert changed(results["inspection"].rests_on, inputs_of("inspection", ball, results)) == ("features",)
    assert "features" in inputs_of("report", project, results)


def test_a_report_made_before_there_were_features_is_out_of_date_only_once_there_are_some():
    """Its record does not name them at all."""
    project, results = new_project(""), {}
    results["scan"] = finished("scan", project, results)
    before = {name: key for name, key in inputs_of("report", project, results).items() if name != "features"}
    assert changed(before, inputs_of("report", project, results)) == ()
    results["inspection"] = finished("inspection", project, results)
    assert changed(before, inputs_of("report", project, results)) == ("features",)


@pytest.mark.parametrize("step", IN_PROJECT, ids=lambda step: step.name)
def test_the_results_a_step_is_made_of_are_those_of_the_graph(step):
    """Each in turn is another, with nothing else changed."""
    project = replace(new_project(""), accepted=Accepted("c1", "p1"))
    results = {name: finished(name, project, {}) for name in STEPS}
    before, resting = inputs_of(step.name, project, results), set()
    for name in STEPS:
        if name in CALIBRATED:
            other, others = replace(project, accepted=replace(project.accepted, **{name: "other"})), results
        else:
            other, others = project, {**results, name: replace(results[name], key="other")}
        if changed(before, inputs_of(step.name, other, others)):
            resting.add(name)
    assert resting == {*step.rests_on, *step.shows} & {*STEPS}


def test_a_report_rests_on_the_studies_that_are_ticked():
    project, kept = new_project("block"), KeptStudy("c0ffee", "grr", plain("3 parts"))
    without = inputs_of("report", project, {})
    left_out = inputs_of("report", replace(project, studies=(replace(kept, included=False),)), {})
    assert left_out == without
    assert changed(without, inputs_of("report", replace(project, studies=(kept,)), {})) == ("studies",)
