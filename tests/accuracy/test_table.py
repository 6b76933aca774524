"""What the accuracy table says of given results."""

import numpy as np

from core.simulate.scenario import Scenario
from tests.accuracy.cases import FULL, HALF, HEIGHTS, Case, cases
from tests.accuracy.table import table, within_2_sigma

SCANS = [Case("wide", Scenario(height_mm=height, scale=FULL), paper=height == 50.0) for height in HEIGHTS]


def results(*errors, paper=None):
    figures = [{"error": error, "u": 0.01, "within_2_sigma": 0.95, "median_depth": 0.01} for error in errors]
    made = {scan.name: each for scan, each in zip(SCANS, figures, strict=True)}
    made[SCANS[1].name]["paper"] = paper or {"why": "no faces"}
    return made


def line(lines, title):
    (found,) = [each for each in lines if title in each]
    return [cell.strip() for cell in found.strip("|").split("|")]


def test_a_goal_that_is_kept_and_one_that_is_missed_are_told_apart():
    lines = table(SCANS, results(0.02, -0.029, 0.0, 0.01))
    assert line(lines, "largest thickness error")[-2:] == ["0.029 mm", "met"]
    assert line(lines, "scatter")[-1] == "**missed**"


def test_a_result_beyond_its_stated_uncertainty_counts_against_it():
    lines = table(SCANS, results(0.021, 0.019, -0.019, 0.0))
    assert line(lines, "≤ U")[-2:] == ["75.0%", "**missed**"]


def test_what_the_papers_procedure_could_not_measure_is_said():
    told = line(table(SCANS, results(0, 0, 0, 0)), "largest")[3]
    assert told == "none in 1 scans; with the fan's own points none in 1 scans"


def test_the_papers_thickness_is_that_of_the_sweeps_points_and_the_fans_own_are_told_apart():
    told = line(table(SCANS, results(0, 0, 0, 0, paper={"error_of_sweeps": -3.25, "error": 0.5})), "largest")[3]
    assert told == "3.250 mm (1 of 1 scans); with the fan's own points 0.500 mm (1 of 1 scans)"


def test_a_calibration_counts_once_however_many_scans_share_it():
    other = Case("narrow", Scenario(seed=2, scale=FULL))
    shares = results(0, 0, 0, 0)
    for scan, share in zip(SCANS, (0.9, 1.0, 1.0, 0.9), strict=True):
        shares[scan.name]["within_2_sigma"] = share
    shares[other.name] = {"within_2_sigma": 0.6}
    np.testing.assert_allclose(within_2_sigma([*SCANS, other], shares, FULL), [0.95, 0.6])
    assert not len(within_2_sigma([*SCANS, other], shares, HALF))


def test_rows_without_scans_are_left_out():
    assert not any("sphere" in each for each in table(SCANS, results(0, 0, 0, 0)))


def test_every_scan_of_the_campaign_has_a_name_of_its_own_and_shares_its_calibration_with_its_neighbours():
    chosen = cases(short=False)
    assert len({case.name for case in chosen}) == len(chosen)
    assert sum(case.group == "wide" and case.scenario.scale == FULL for case in chosen) == 20
    assert sum(case.group == "replaced" for case in chosen) == 10
