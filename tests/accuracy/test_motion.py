"""Hands that move while rows are read out, and things that move within a scan: is U true, or is it told?

Whole sets at a quarter of the full size, with calibrations of their own, measured as a user would.
"""

import numpy as np
import pytest

from core.errors import InputError
from core.files.results.run_file import read_run
from core.inspect.conformity import Verdict
from core.simulate.scenario import Scenario
from tests.accuracy.twin import calibrated_once, measure
from tests.shared import each_once

SET = {"scale": 0.25, "frames": 36, "camera_views": 10, "plane_poses": 8}
TOLD = {"scan.fan_shifted", "scan.moved", "scan.frames_moved"}
SWITCHES = {
    "hand at 14 mm/s": {"readout_ms": 71.0, "hand_mm_s": 14.0},
    "hand at 28 mm/s with tremor": {"readout_ms": 71.0, "hand_mm_s": 28.0, "tremor_mm": 0.35},
    "hand at 28 mm/s, exposed for 10 ms": {"exposure_ms": 10.0, "hand_mm_s": 28.0, "tremor_mm": 0.35},
    "hand at 28 mm/s, exposed for 40 ms": {"exposure_ms": 40.0, "hand_mm_s": 28.0, "tremor_mm": 0.35},
    "part lifted by 0.4 mm": {"lifted_mm": 0.4, "moved_frame": 22},
}


@pytest.fixture(scope="module")
def calibrated(tmp_path_factory):
    return calibrated_once(tmp_path_factory, Scenario(**SET))


@pytest.mark.accuracy
@pytest.mark.parametrize(("switch", "seed"), each_once(SWITCHES, (1, 2, 3)))
def test_no_movement_makes_a_thickness_wrong_beyond_u_without_a_word(switch, seed, calibrated, tmp_path):
    try:
        measured = measure(Scenario(**SET, **SWITCHES[switch], seed=seed), tmp_path, calibrated)
    except InputError as refused:  # too little is left between which nothing moved: refused, and why
        assert "moved_frame" in SWITCHES[switch]
        assert "moved during the scan" in str(refused)
        return
    gauge, error = measured.gauge, measured.gauge.thickness_mm - 50.0
    told = {note.code for note in read_run(tmp_path / "out" / "run.json").notes["scan"]}
    print(f"{switch}, seed {seed}: {1e3 * error:+.0f} ± {1e3 * gauge.U_mm:.0f} µm, {gauge.verdict}, {sorted(told)}")
    assert abs(error) <= gauge.U_mm or (told & TOLD and gauge.verdict != Verdict.CONFORMING)
    if told & TOLD:
        assert gauge.doubts
    if "moved_frame" in SWITCHES[switch]:
        assert "scan.fan_shifted" in told
    if "readout_ms" in SWITCHES[switch]:
        assert "scan.hand_moved" in told
    assert ("scan.exposure_blur" in told) is (SWITCHES[switch].get("exposure_ms") == 40.0)
    off = measured.depth_errors() / np.hypot(measured.cloud.sigma, measured.cloud.sigma_common)
    assert np.mean(np.abs(off[np.isfinite(off)]) < 2) > 0.93
