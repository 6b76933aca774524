"""What is told of kept calibrations, and of what differs between two."""

from dataclasses import replace
from datetime import UTC, datetime

from core.calibrate.camera.changes import CameraChanges, ParameterChange
from core.files.project.calibration_store import StoredCalibration
from core.report.facts.of_kept import change_cells, stored_cameras, stored_planes
from core.report.wording import Words

CAMERA = StoredCalibration("camera", "c1", datetime(2026, 3, 2, 12, 9, tzinfo=UTC), 9, 12, rms_px=0.0421)


def test_the_calibration_in_use_is_marked_among_the_kept_ones():
    first, second = stored_cameras((CAMERA, replace(CAMERA, id="c2")), "c2").texts(Words())
    assert first[1:] == ["0.042", "9 of 12", "c1", ""] and second[-2:] == ["c2", "in use"]


def test_light_planes_of_fewer_lines_leave_the_others_cells_empty():
    three = replace(CAMERA, rms_mm=(0.01, 0.02, 0.03), camera_id="c1")
    table = stored_planes((three, replace(three, rms_mm=(0.04,))), "")
    assert [row[1:4] for row in table.texts(Words())] == [["0.010", "0.020", "0.030"], ["0.040", "", ""]]
    assert all(row[6] == "c1" for row in table.texts(Words()))


def test_a_change_that_chance_hardly_explains_is_graded_and_what_a_model_lacks_is_no_row():
    parameters = (ParameterChange("alpha", 2410.0, 2414.0, 4.0, 0.5), ParameterChange("k3", 0.0, 0.0, 0.0, 0.0))
    *_, views, alpha = change_cells(CameraChanges(parameters, (0.04, 0.05), (9, 10)))
    assert [fact.parts(Words())[0] for fact in views] == ["9", "10"]
    assert [fact.parts(Words())[0] for fact in alpha] == ["2410.00", "2414.00", "+4.00", "0.50"]
    assert [fact.grade for fact in alpha] == ["", "", "warn", ""]
