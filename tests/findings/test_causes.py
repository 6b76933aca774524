"""What is said to widen U is a row of its budget: each such finding by the cause whose row it widens."""

import ast
from typing import get_args

import pytest

from core.calibrate.deviations import Source
from core.findings.finding import Effect
from core.findings.table import FINDINGS
from core.inspect.causes import CALIBRATIONS, Cause
from tests.code import modules, nodes

pytestmark = pytest.mark.usefixtures("syntax_trees")

WIDENED = {
    "camera.bad_fit": Cause.CAMERA,
    "camera.corners_err_together": Cause.CAMERA,
    "camera.corners_err_alike": Cause.CAMERA,
    "camera.bowed_target": Cause.CAMERA,
    "target.flatness_assumed": Cause.FAN_ASSUMED,
    "target.size_assumed": Cause.SCALE_ASSUMED,
    "target.sizes_disagree": Cause.SCALE,
    "fan.channels_differ": Cause.FAN_CALIBRATION,
    "fan.poses_scatter": Cause.FAN_CALIBRATION,
    "fan.bowed_target": Cause.FAN_CALIBRATION,
    "fan.bow_or_bend": Cause.BENT_LIGHT,
    "fan.lines_bent": Cause.BENT_LIGHT,
    "fan.lines_wavy": Cause.BENT_LIGHT,
    "set.log_not_read": Cause.CHANGE_ASSUMED,
    "scan.stability_assumed": Cause.CHANGE_ASSUMED,
    "scan.stability_more_than_stated": Cause.CHANGE_CHARTED,
    "scan.warmer_than_usual": Cause.CHANGE_ASSUMED,
    "scan.kelvins_assumed": Cause.CHANGE,
    "scan.kelvins_since_check_assumed": Cause.CHANGE,
    "scan.hours_assumed": Cause.CHANGE,
    "scan.compressed": Cause.POINT_NOISE,
    "scan.compression_assumed": Cause.POINT_NOISE,
    "scan.speckled": Cause.FAN_SPECKLE,
    "scan.exposure_blur": Cause.POINT_NOISE,
    "scan.rows_roll": Cause.SWEEP_PLANES,
    "scan.crossings_scatter": Cause.SWEEP_PLANES,
    "scan.stripes_wider_on_part": Cause.SKEWED_LIGHT,
    "scan.scale_weak": Cause.SWEEP_PLANES,
    "scan.scale_unknown": Cause.SWEEP_PLANES,
    "part.material_assumed": Cause.LIGHT_FROM_BELOW_ASSUMED,
    "part.temperature_assumed": Cause.PART_TEMPERATURE_ASSUMED,
    "form.scatter": Cause.FORM,
    "form.askew": Cause.FORM,
    "form.levels_askew": Cause.FORM,
    "form.bowed": Cause.FORM,
    "form.uneven": Cause.FORM,
    "form.uneven_along": Cause.FORM,
    "form.off_nominal": Cause.FORM,
    "profile.assumes_stage": Cause.FACE_TILT,
    "profile.assumes_square": Cause.FACE_TILT,
    "profile.not_straight": Cause.FORM,
    "inspection.rig_not_checked": Cause.CHANGE_ASSUMED,
}


def made_rows():
    """The causes of which a function of the program makes a row, by `Cause.NAME` or by the source of a deviation."""
    named = {
        node.attr
        for path in modules("core")
        if path.name != "causes.py"
        for node in nodes(path)
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "Cause"
    }
    return {Cause[name] for name in named} | {CALIBRATIONS[source] for source in get_args(Source)}


def test_every_finding_that_widens_u_names_the_row_that_it_widens():
    assert set(WIDENED) == {code for code, row in FINDINGS.items() if row.effect == Effect.WIDENS_U}


def test_every_row_that_is_widened_is_made_by_a_function():
    assert set(WIDENED.values()) - made_rows() == set()
    assert Cause.CAMERA in made_rows() and Cause.FACE_TILT in made_rows()
