"""Small inputs that others filed, each a `make.sh`: what the program says of them is right."""

import os
import re
import subprocess
import sysconfig

import numpy as np
import pytest

from core.files.results.gauge_file import read_gauge
from core.files.results.ply import read_cloud
from tests.shared import CASES

pytestmark = [
    pytest.mark.accuracy,
    pytest.mark.skipif(not CASES.exists(), reason="the cases of shared/cases are not there"),
]


@pytest.fixture(scope="module")
def work(tmp_path_factory):
    """A folder in which all cases share the scan that they change."""
    return tmp_path_factory.mktemp("cases")


def made(case, work):
    """What the program says when the case is made, as one line."""
    (folder,) = CASES.glob(f"{case}-*")
    paths = os.pathsep.join([sysconfig.get_path("scripts"), os.environ["PATH"]])  # the case calls `trisect` by its name
    done = subprocess.run(
        ["sh", folder / "make.sh", work],
        capture_output=True,
        text=True,
        check=False,
        timeout=1800,
        env={**os.environ, "PATH": paths},
    )
    return " ".join((done.stdout + done.stderr).split())


def gauge_of(folder):
    return read_gauge(folder / "gauge.json", read_cloud(folder / "cloud.ply").cloud)


def test_a_picture_shifted_on_the_sensor_is_named_in_whole_sentences(work):
    said = made("07", work)
    assert re.search(r"the picture shifted by about (3[89]|4[0-2]) px", said)
    assert not re.search(r"\w…", said), "no word is cut off"


def test_a_face_that_no_sweep_reaches_is_that_of_all_fan_lines_on_it_and_proves_nothing(work):
    """One line alone lies in its plane of light: as a face it would stand at 87° to the other."""
    said = made("01", work)
    kept = work / "five-out" / "gauge.json"
    if not kept.exists():
        assert re.search(r"faces? (is|are) in view|lie on one stripe|faces no two are parallel", said)
        return
    gauge = gauge_of(work / "five-out")
    assert gauge.verdict != "conforming"
    if gauge.lower.spanned:
        assert np.degrees(gauge.parallelism) < 0.5 and abs(gauge.thickness_mm - 30.0) < gauge.U_mm
    else:
        assert "faces_not_spanned" in {doubt.fact for doubt in gauge.doubts}


def test_doubled_frames_count_once(work):
    made("02", work)
    once, twice = gauge_of(work / "base-out"), gauge_of(work / "dup2-out")
    assert twice.verdict == once.verdict
    assert twice.thickness_mm == pytest.approx(once.thickness_mm, abs=1e-4)
    assert "moved" not in {doubt.fact for doubt in twice.doubts}


def test_two_parts_are_told_and_the_one_near_the_nominal_is_measured(work):
    made("04", work)
    gauge = gauge_of(work / "two-out")
    assert gauge.thickness_mm == pytest.approx(30.0, abs=0.2)
    assert "several_faces" in {doubt.fact for doubt in gauge.doubts}


def test_pictures_that_are_exchanged_are_told_as_such(work):
    assert re.search("exchanged", made("06", work))


def test_a_cloud_has_the_coordinates_that_other_programs_read(work):
    if not (work / "base-out").exists():
        made("02", work)
    head = (work / "base-out" / "cloud.ply").read_bytes().partition(b"end_header")[0].decode()
    assert all(f"property float {axis}\n" in head for axis in "xyz")


def test_a_wrong_count_of_corners_is_told_in_the_time_of_the_right_one(work):
    """The case prints the time before, between and after the two."""
    said = made("11", work)
    begun, between, end = map(int, re.findall(r"\b1[0-9]{9}\b", said))
    assert end - between <= 2 * (between - begun) + 2
    assert re.search(r"18 × 13", said) and "17 × 12" in said
