"""Scans by a path tracer, an independent generator of pictures: right within U, and nothing blamed that is in order."""

import json
import shutil
from itertools import combinations

import pytest

from core.files.recording.recording_set import open_set
from core.files.results.ply import read_cloud
from core.inspect.conformity import Verdict
from core.pipeline.steps.camera_step import camera_step
from core.pipeline.steps.gauge_step import gauge_step
from core.pipeline.steps.planes_step import planes_step
from core.pipeline.steps.scan_step import scan_step
from core.pipeline.steps.workspace import Workspace
from tests.accuracy.causes import CLAIMS
from tests.accuracy.hostile import told_codes
from tests.accuracy.ideal import plain_thickness
from tests.shared import REAL_SETS

TRACED = REAL_SETS.parent / "traced"

TRUE = {"scan.bright_in_part"}
"""Codes that are true of all four: on the table's side near the laser, 6 to 14 % of the fan is saturated."""

PLAIN_TIMES = 1.3
"""Times the error of a plain fit of the same points that an error may be: nothing that is assumed moves a thickness."""

pytestmark = [
    pytest.mark.accuracy,
    pytest.mark.skipif(not TRACED.is_dir(), reason="the path-traced scans are not here"),
]


@pytest.fixture(scope="module")
def calibrated(tmp_path_factory):
    """The results of the calibration of all four."""
    out = tmp_path_factory.mktemp("traced")
    work = Workspace.open(open_set(TRACED / "matt"), out)
    camera_step(work)
    planes_step(work)
    return out


@pytest.mark.parametrize("name", ["matt", "steps", "high", "alike"])
def test_a_path_traced_scan_is_right_within_its_uncertainty_and_nothing_is_blamed(name, calibrated, tmp_path):
    heights = json.loads((TRACED / name / "truth.json").read_text())["face_heights_mm"]
    out = tmp_path / "out"
    shutil.copytree(calibrated, out)
    work = Workspace.open(open_set(TRACED / name), out)
    scan_step(work)
    gauge = gauge_step(work)
    error = min((gauge.thickness_mm - (upper - lower) for lower, upper in combinations(heights, 2)), key=abs)
    plain = error + plain_thickness(read_cloud(work.path("cloud")).cloud, gauge) - gauge.thickness_mm
    print(f"{name}: {1e3 * error:+.0f} ± {1e3 * gauge.U_mm:.0f} µm, {gauge.verdict}, {told_codes(out)}")
    print(f"{name}: plain fit {1e3 * plain:+.0f} µm")
    assert abs(error) <= gauge.U_mm
    assert abs(error) <= PLAIN_TIMES * abs(plain)
    assert gauge.lower.spanned, "where sweeps that run alike do not reach the table, the fan's lines do"
    assert gauge.verdict != Verdict.NOT_CONFORMING
    assert CLAIMS.intersection(told_codes(out)) <= TRUE
