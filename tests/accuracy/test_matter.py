"""Parts that take light in and parts that shine: is U true, or is it told? And is nothing told of matt ones?

Whole sets at half the full size, measured as a user would with one calibration.
"""

import pytest

from core.inspect.conformity import Verdict
from core.simulate.scenario import Scenario
from tests.accuracy.twin import measure

SET = {"scale": 0.5, "frames": 48}
TOLD = "inspection.light_is_skewed"
MATTER = {
    "translucent, 35 % from 0.8 mm": {"inner_share": 0.35},
    "translucent, 35 % from 1.2 mm": {"inner_share": 0.35, "inner_mm": 1.2},
    "glossy": {"gloss": 3.0, "gloss_deg": 6.0},
}


@pytest.fixture(scope="module")
def calibrated(tmp_path_factory):
    """A folder with a calibration, by a scan of a matt block."""
    folder = tmp_path_factory.mktemp("matt")
    measure(Scenario(**SET), folder)
    return folder


def said_of(scenario, folder, calibrated):
    """Error and U in mm, verdict, and whether skewed light was told."""
    gauge = measure(scenario, folder, calibrated).gauge
    error, told = gauge.thickness_mm - 50.0, TOLD in {note.code for note in gauge.notes}
    print(f"{1e3 * error:+.0f} ± {1e3 * gauge.U_mm:.0f} µm, {gauge.verdict}, {'told' if told else 'nothing told'}")
    return error, gauge.U_mm, gauge.verdict, told


@pytest.mark.accuracy
@pytest.mark.parametrize("seed", [2, 3, 4])
@pytest.mark.parametrize("matter", MATTER)
def test_no_matter_makes_a_thickness_wrong_beyond_u_without_a_word(matter, seed, calibrated, tmp_path):
    error, expanded, verdict, told = said_of(Scenario(**SET, **MATTER[matter], seed=seed), tmp_path, calibrated)
    assert abs(error) <= expanded or (told and verdict != Verdict.CONFORMING)
    if "inner_share" in MATTER[matter]:
        assert told
        assert verdict != Verdict.CONFORMING
        assert abs(error) <= expanded


@pytest.mark.accuracy
@pytest.mark.parametrize("seed", [2, 3, 4, 5, 6])
def test_nothing_is_told_of_a_matt_part(seed, calibrated, tmp_path):
    error, expanded, verdict, told = said_of(Scenario(**SET, seed=seed), tmp_path, calibrated)
    assert not told
    assert abs(error) <= expanded
    assert verdict == Verdict.CONFORMING
