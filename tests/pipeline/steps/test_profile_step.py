"""`trisect profile`: pictures of the fan alone to a thickness with U, its files and its report."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pypdf import PdfReader

from core.files.recording.recording_set import open_set
from core.files.results.gauge_file import read_thickness
from core.files.results.ply import read_cloud
from core.files.results.profile_file import read_profiles_file
from core.pipeline.steps.camera_step import camera_step
from core.pipeline.steps.planes_step import planes_step
from core.pipeline.steps.workspace import Workspace
from core.simulate.recording import simulate_set
from core.simulate.scenario import Scenario
from tests.simulated import trisect

THREE = Scenario(
    scale=0.2, frames=3, camera_views=6, plane_poses=5, seed=4, height_mm=30.0, hand_laser=False, travel_mm=3.0
)


def calibrated(scenario: Scenario, folder: Path) -> tuple[Path, Path]:
    """A set and a folder with its calibrations."""
    simulate_set(scenario, folder / "set")
    work = Workspace.open(open_set(folder / "set"), folder / "out")
    camera_step(work)
    planes_step(work)
    return folder / "set", folder / "out"


@pytest.fixture(scope="module")
def three(tmp_path_factory) -> tuple[Path, Path]:
    return calibrated(THREE, tmp_path_factory.mktemp("three"))


@pytest.fixture(scope="module")
def one(tmp_path_factory) -> tuple[Path, Path]:
    return calibrated(replace(THREE, fan_lines=1), tmp_path_factory.mktemp("one"))


@pytest.fixture(scope="module")
def measured(three) -> Path:
    folder, out = three
    said = trisect("profile", folder, "--out", out, "--json")
    assert said.code in (0, 1), said.err
    (out / "said.json").write_text(said.out)
    return out


def test_the_thickness_is_as_true_as_it_says(measured):
    told = json.loads((measured / "said.json").read_text())
    assert abs(told["thickness_mm"] - 30.0) < told["U_mm"] < 0.15
    assert len(told["pictures"]) == 3


def test_the_files_tell_the_same(measured):
    told, file = json.loads((measured / "said.json").read_text()), read_profiles_file(measured / "profile.json")
    assert read_thickness(measured / "gauge.json").value == told["thickness_mm"] == file.thickness_mm
    cloud = read_cloud(measured / "profiles.ply").cloud
    table = np.genfromtxt(measured / "profiles.csv", delimiter=",", names=True)
    assert len(table) == len(cloud)
    assert set(np.unique(table["line"])) == {1, 2, 3}
    shown = table["picture"] == file.shown
    assert np.median(table["height_mm"][shown][table["height_mm"][shown] > 15]) == pytest.approx(
        30.0, abs=0.15
    )  # one picture, 768 px
    causes = [row.words.code for row in read_thickness(measured / "gauge.json").budget]
    assert {"inspection.cause_camera", "inspection.cause_fan", "inspection.cause_fan_speckle"} <= set(causes)


def test_the_report_shows_the_profiles_and_what_is_taken_for_granted(three, measured):
    said = trisect("report", three[0], "--out", measured)
    assert said.code == 0, said.err
    text = " ".join(" ".join(page.extract_text().split()) for page in PdfReader(measured / "report.pdf").pages)
    assert "Light profiles" in text
    assert "taken to have been at rest during each exposure" in text


@pytest.mark.accuracy
def test_one_line_asks_how_the_faces_are_tilted(one):
    folder, out = one
    said = trisect("profile", folder, "--out", out)
    assert said.code == 2
    assert "--stage planes/NAME" in said.sentence
    assert "has no pose nothing" in trisect("profile", folder, "--out", out, "--stage", "nothing").sentence


@pytest.mark.accuracy
def test_one_line_measures_along_the_normal_of_the_plate_that_lay_on_the_stage(one):
    folder, out = one
    said = trisect("profile", folder, "--out", out, "--stage", "planes/stage", "--json")
    told = json.loads(said.out)
    assert abs(told["thickness_mm"] - 30.0) < told["U_mm"] < 0.25
    assert any("parallel to the plate of planes/stage" in note["text"] for note in told["notes"])


@pytest.mark.slow
def test_pictures_without_both_faces_are_named_and_when_none_has_both_it_is_told(three, tmp_path):
    folder, out = three
    empty = tmp_path / "empty"
    simulate_set(replace(THREE, object="plane", frames=1, camera_views=0, plane_poses=0), empty)
    shutil.copytree(out, tmp_path / "out")
    said = trisect("profile", empty, "--out", tmp_path / "out")
    assert said.code == 3
    assert "none of 1 pictures gives a step" in said.sentence
    shutil.copytree(folder, tmp_path / "mixed")
    shutil.copy(next((empty / "scan").iterdir()), tmp_path / "mixed/scan/frame0009.png")
    told = json.loads(trisect("profile", tmp_path / "mixed", "--out", tmp_path / "out", "--json").out)
    for told_by in ("reason", "code"):
        assert [bool(one[told_by]) for one in told["pictures"]] == [False, False, False, True]


@pytest.mark.slow
def test_regions_in_the_rig_choose_what_is_looked_at(three, tmp_path):
    folder, out = (shutil.copytree(one, tmp_path / one.name) for one in three)
    width, height = picture_size(out)
    corner = [[0, 0], [9, 0], [9, 9]]
    whole = [[0, 0], [width, 0], [width, height], [0, height]]
    for regions, code in (((whole, corner), (0, 1)), ((corner, corner), (3,))):
        text = (three[0] / "rig.toml").read_text()
        (folder / "rig.toml").write_text(
            text.replace("[gauge]", f"[gauge]\nupper_polygon_px = {regions[0]}\nlower_polygon_px = {regions[1]}")
        )
        assert trisect("profile", folder, "--out", out).code in code


def picture_size(out: Path) -> tuple[int, int]:
    return tuple(json.loads((out / "camera.json").read_text())["image_size"])
