"""A project's results as they are loaded: as measured, or not at all."""

from core.files.project.folder import results_folder
from core.pipeline.project.results import load_results
from tests.simulated import copy_of


def test_results_are_loaded_as_they_were_measured(done):
    results = load_results(done.folder)
    assert len(results.cloud) == done.summary.points
    assert len(results.mesh.triangles) == done.summary.triangles
    assert results.gauge.thickness_mm == done.summary.gauge.thickness_mm
    assert results.frames == done.summary.frames
    assert results.calibration_id == done.summary.calibration_id
    assert results.notes == done.summary.notes
    assert results.problems == ()


def test_results_that_do_not_belong_together_are_not_loaded(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    camera = results_folder(folder) / "camera.json"
    camera.write_text(camera.read_text().replace('"k1": ', '"k1": 1'))
    results = load_results(folder)
    assert results.camera is not None
    assert (results.fan, results.cloud, results.gauge, results.frames) == (None, None, None, ())
    assert "calibrated again" in str(results.problems[0])


def test_a_project_without_results_loads_nothing_and_complains_of_nothing(tmp_path):
    results = load_results(tmp_path)
    assert (results.cloud, results.gauge, results.problems, dict(results.files)) == (None, None, (), {})
