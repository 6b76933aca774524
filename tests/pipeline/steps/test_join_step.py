"""`trisect join` on a small set of a block turned over in its carrier: what it measures, and what it measures again."""

import json
import shutil
from dataclasses import replace

import numpy as np
import pytest

from core.errors import InputError
from core.files.recording.recording_set import further_views, open_set
from core.files.results.ply import read_cloud
from core.pipeline.steps import join_step as room
from core.pipeline.steps.join_step import joined_views, turned_last, view_workspaces
from core.pipeline.steps.workspace import Workspace
from core.simulate.effects.carrier import CarrierBeside
from core.simulate.recording import simulate_set
from core.views.thickness import faces_across, upper_face
from tests.shared import made_once
from tests.simulated import CUT, TINY, contents, copy_of, trisect
from tests.views.made import both_seen, carrier

TURNED = replace(TINY, scale=0.25, frames=12, carrier=CarrierBeside(marks=12))


@pytest.fixture(scope="module")
def joined(tmp_path_factory):
    """The folder with the set and its results, joined; copy it before changing it."""
    return made_once(tmp_path_factory, "joined", _join)


def _join(folder):
    simulate_set(TURNED, folder / "set")
    for step, words in {"camera": (), "planes": (), "scan": CUT, "join": CUT}.items():
        said = trisect(step, folder / "set", "--out", folder / "out", *words)
        assert said.code in (0, 1), said.err


@pytest.fixture
def again(joined, tmp_path, monkeypatch):
    """A copy, and the views that are measured in it from then on."""
    folder = copy_of(joined, tmp_path / "again")
    measured = []

    def scan(place, *_):
        measured.append(place.recording_set.folders["scan"].name)

    monkeypatch.setattr(room, "scan_step", scan)
    return folder, measured


def test_the_cloud_has_both_views_and_the_thickness_is_within_its_U(joined):
    table = json.loads((joined / "out" / "joint.json").read_text())
    thickness = table["thickness"]
    assert [view["name"] for view in table["views"]] == ["scan", "turned"]
    assert abs(thickness["thickness_mm"] - 50.0) <= thickness["U_mm"] < 1.0
    assert thickness["points"]["upper"] > 100 and thickness["points"]["lower"] > 100
    assert np.shape(table["views"][1]["pose"]) == (4, 4) and np.shape(table["views"][1]["covariance"]) == (6, 6)
    assert np.linalg.eigvalsh(table["views"][1]["covariance"]).min() > 0
    cloud = read_cloud(joined / "out" / "joined.ply").cloud
    assert (np.bincount(cloud.view) > 100).tolist() == [True, True]
    assert {"camera.json", "planes.json", "cloud.ply"} <= set(contents(joined / "out" / "views" / "turned"))


def test_each_views_face_is_of_that_view_and_the_two_look_away_from_each_other(joined):
    found = joined_views(Workspace.open(open_set(joined / "set"), joined / "out")).joined
    faces = faces_across(found)
    for view, indices in enumerate((faces.upper, faces.lower)):
        assert (found.cloud.view[indices] == view).all()
        assert np.array_equal(indices, upper_face(found, view))
    first, last = (found.cloud.normals[one].mean(axis=0) for one in (faces.upper, faces.lower))
    assert first @ last < -0.9 * np.linalg.norm(first) * np.linalg.norm(last)


def test_what_is_measured_already_is_not_measured_again(again):
    folder, measured = again
    assert trisect("join", folder / "set", "--out", folder / "out", *CUT).code in (0, 1)
    assert measured == []


@pytest.mark.parametrize("change", ["picture", "frame gone", "settings", "calibration"])
def test_a_view_is_measured_again_where_its_cloud_is_of_something_else(again, change):
    folder, measured = again
    place, words = folder / "set" / "views" / "turned", CUT
    frames = sorted(path for path in place.iterdir() if path.stem != "reference")
    if change == "picture":
        shutil.copy(frames[0], frames[1])
    elif change == "frame gone":
        frames[-1].unlink()
    elif change == "settings":
        words = ("--sigma-cut", "0.2")
    else:
        path = folder / "out" / "views" / "turned" / "scan.npz"
        with np.load(path, allow_pickle=False) as arrays:
            kept = {name: arrays[name] for name in arrays.files}
        name = next(name for name in kept if "calibration" in name)
        np.savez(path, **{**kept, name: np.array("of-another")})
    trisect("join", folder / "set", "--out", folder / "out", *words)
    assert measured == ["turned"]


def test_a_calibration_taken_over_is_replaced_whole(again):
    folder, _ = again
    taken = folder / "out" / "views" / "turned" / "camera.json"
    taken.write_text("{")
    with taken.open() as held:  # a reader sees the old file or the new one, never a half
        view_workspaces(Workspace.open(open_set(folder / "set"), folder / "out"))
        assert held.read() == "{"
    assert taken.read_bytes() == (folder / "out" / "camera.json").read_bytes()


def test_further_views_are_sets_of_their_own_pictures_with_the_same_rig(joined):
    recording = open_set(joined / "set")
    (view,) = further_views(recording).values()
    assert view.rig == recording.rig and view.camera == recording.camera
    assert {path.parent.name for path in (view.reference, *view.frames)} == {"turned"}
    assert len(view.frames) == TURNED.frames and view.known_planes == ()


def test_a_view_called_as_the_first_one_is_refused(again):
    folder, _ = again
    (folder / "set" / "views" / "turned").rename(folder / "set" / "views" / "scan")
    with pytest.raises(InputError, match=r"views.scan: a further view cannot be called scan"):
        further_views(open_set(folder / "set"))


def test_the_thickness_goes_to_the_view_of_the_other_side_whatever_it_is_called():
    known = carrier()
    first, turned = both_seen(known)
    again = replace(first, view="z first again")
    assert turned_last(known, [first, turned, again]) == [first, again, turned]
    assert turned_last(known, [turned, first, again]) == [turned, first, again]
