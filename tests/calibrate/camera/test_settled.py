"""Whether a camera was solved to the end is seen by what a further step would change."""

from dataclasses import replace

import pytest

from core.calibrate.camera.calibration import calibrate_camera
from core.calibrate.camera.settled import has_settled
from core.files.results.camera_file import read_camera, write_camera
from tests.calibrate.camera_views import TRUTH, synthetic_views


@pytest.fixture(scope="module")
def calibration():
    return calibrate_camera(synthetic_views(1, 8, 0.05), TRUTH.image_size)


def short_of(calibration, share):
    """The same, stopped where its focal length is so many of its standard deviations from the end."""
    matrix = calibration.camera.matrix.copy()
    matrix[0, 0] += share * calibration.sd["alpha"]
    return replace(calibration, camera=replace(calibration.camera, matrix=matrix))


def test_a_camera_solved_to_the_end_has_settled_and_one_stopped_before_has_not(calibration):
    assert calibration.converged is True
    assert [has_settled(short_of(calibration, share)) for share in (0.001, 0.5, -3.0)] == [True, False, False]


def test_of_a_camera_without_views_it_is_not_known(calibration):
    assert has_settled(replace(calibration, views=())) is None


def test_a_fit_that_was_stopped_is_told_first(monkeypatch):
    monkeypatch.setattr("core.calibrate.camera.bundle._MOST_ITERATIONS", 1)
    stopped = calibrate_camera(synthetic_views(1, 8, 0.05), TRUTH.image_size)
    assert (stopped.converged, stopped.notes[0].code) == (False, "camera.not_converged")


def test_a_file_keeps_it_and_views_show_it_where_an_earlier_file_does_not(tmp_path, calibration):
    path = tmp_path / "camera.json"
    kept = {}
    for name, one in {
        "said": replace(calibration, converged=False),
        "by its views": replace(calibration, converged=None),
        "stopped": replace(short_of(calibration, 0.5), converged=None),
        "of another program": replace(calibration, converged=None, views=()),
    }.items():
        write_camera(path, one)
        kept[name] = read_camera(path).converged
    assert kept == {"said": False, "by its views": True, "stopped": None, "of another program": None}
