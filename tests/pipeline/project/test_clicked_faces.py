"""Faces grown from points clicked on a project's scan: the faces of its thickness, ready to be proposed and kept."""

import os
import pickle

import numpy as np
import pytest

from core.errors import InputError
from core.files.project.folder import results_folder
from core.files.results.ply import read_cloud
from core.inspect.evaluate import evaluate
from core.inspect.plan.feature_spec import FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan
from core.model import Pose
from core.pipeline.project import clicked_faces as module
from core.pipeline.project.clicked_faces import clicked_faces
from core.pipeline.project.inspection import MOST_DRAWN
from tests.simulated import copy_of


@pytest.fixture(scope="module")
def cloud(done):
    return read_cloud(results_folder(done.folder) / "cloud.ply").cloud


@pytest.fixture(scope="module")
def faces(done):
    """A point amid the upper and one amid the lower face of the thickness."""
    return tuple(
        int(face.indices[len(face.indices) // 2]) for face in (done.summary.gauge.upper, done.summary.gauge.lower)
    )


def test_a_click_on_a_face_of_the_thickness_grows_over_all_of_it(done, faces, cloud):
    (face,) = clicked_faces(done.folder, faces[:1]).faces
    upper = done.summary.gauge.upper
    assert face.kind == "plane"
    assert len(upper.indices) < face.used < 1.5 * len(upper.indices), "its margin belongs to it"
    assert len(face.places) <= MOST_DRAWN
    assert np.all(np.abs(upper.plane.distances(face.places.astype(np.float64))) < 1.0)
    assert 0 < face.rms_mm < 0.2
    (seed,) = face.seeds
    assert seed.at_px == pytest.approx(cloud.uv[faces[0]], abs=0.06)


@pytest.mark.parametrize("swapped", [pytest.param(False, marks=pytest.mark.accuracy), True])
def test_two_clicks_are_parallel_the_nearer_face_first_and_measure_the_thickness(done, faces, cloud, swapped):
    pair = clicked_faces(done.folder, faces[::-1] if swapped else faces)
    assert pair.parallel
    depths = [float(np.median(face.places[:, 2])) for face in pair.faces]
    assert depths[0] < depths[1]
    spec = FeatureSpec("step", "thickness", tuple(face.seeds[-1] for face in pair.faces))
    inspection = evaluate(InspectionPlan((spec, FeatureSpec("found", "thickness"))), cloud)
    assert inspection.problems == ()
    clicked, found = inspection.characteristics
    assert clicked.value == pytest.approx(found.value, abs=found.U)


def test_with_part_coordinates_the_place_in_them_comes_first(done, faces, cloud):
    pose = Pose(np.diag([1.0, -1.0, -1.0]), np.array([5.0, 6.0, 500.0]))
    (face,) = clicked_faces(done.folder, faces[:1], "plane", pose).faces
    assert face.seeds[0].at_mm == pytest.approx(pose.inverse().apply(cloud.points[faces[0]][None])[0], abs=6e-4)
    assert face.seeds[1].at_px is not None


def test_two_clicks_on_one_face_are_refused(done, faces):
    other = int(done.summary.gauge.upper.indices[3])
    with pytest.raises(InputError, match="one and the same face"):
        clicked_faces(done.folder, (faces[0], other))


def test_the_cloud_is_read_once_and_again_when_the_scan_is_another(done, faces, tmp_path, monkeypatch):
    folder, read = copy_of(done.folder, tmp_path / "project"), []

    def reading(path):
        read.append(path)
        return read_cloud(path)

    monkeypatch.setattr(module, "read_cloud", reading)
    memory = {}
    first = clicked_faces(folder, faces[:1], memory=memory)
    assert clicked_faces(folder, faces[:1], memory=memory).faces[0].used == first.faces[0].used
    assert len(read) == 1
    path = results_folder(folder) / "cloud.ply"
    os.utime(path, (1, 1))
    clicked_faces(folder, faces[:1], memory=memory)
    assert len(read) == 2


def test_a_point_of_another_scan_is_refused(done):
    with pytest.raises(InputError, match="replaced by another one"):
        clicked_faces(done.folder, (10**6,))


def test_it_can_be_sent_to_another_process(done, faces):
    pair = clicked_faces(done.folder, faces)
    again = pickle.loads(pickle.dumps(pair))
    assert [face.seeds for face in again.faces] == [face.seeds for face in pair.faces]
