"""Everything a measured project hands over to other programs, and what a template does to its report."""

from __future__ import annotations

import json
from dataclasses import replace

import cv2
import numpy as np
import pye57
import pytest
import yaml
from lxml import etree
from openpyxl import load_workbook
from PIL import Image
from pypdf import PdfReader

from core.errors import InputError
from core.files.project.data import ReportChoices
from core.files.project.folder import results_folder
from core.files.results.camera_file import read_camera, write_camera
from core.files.results.export_list import EXPORTS
from core.model import Camera
from core.pipeline.project.export import choose_template, export, export_results, import_camera
from core.pipeline.project.report import make_report, project_content
from core.pipeline.steps.export_kinds import WRITERS
from tests.simulated import copy_of


@pytest.fixture
def folder(done, tmp_path):
    return copy_of(done.folder, tmp_path / "project")


def without_skew(folder):
    """The project's camera with γ = 0 among the results, for what has no skew."""
    path = results_folder(folder) / "camera.json"
    calibration = read_camera(path)
    matrix = calibration.camera.matrix.copy()
    matrix[0, 1] = 0
    camera = Camera(calibration.camera.image_size, matrix, calibration.camera.distortion)
    write_camera(path, replace(calibration, camera=camera))
    return camera


def test_every_kind_has_a_name_a_title_an_ending_and_a_file_of_its_own():
    assert len({kind.file for kind in EXPORTS.values()}) == len(EXPORTS)
    assert list(WRITERS) == list(EXPORTS)
    for name, kind in EXPORTS.items():
        assert (kind.name, kind.ending[:1], kind.needs in ("camera", "scan", "gauge")) == (name, ".", True)
        assert kind.title.strip()


def test_results_are_handed_over_as_the_report_has_them(done, folder, tmp_path):
    content = project_content(folder, done.project)
    value = content.gauge.thickness_mm
    paths = {kind: export(folder, done.project, kind, tmp_path / EXPORTS[kind].file)
             for kind in ("table", "xlsx", "results", "dfq", "qif", "e57", "opencv", "opencv-json")}  # fmt: skip
    assert load_workbook(paths["xlsx"])["result"]["G2"].value == pytest.approx(value, rel=1e-15)
    tables = json.loads(paths["results"].read_text())
    assert (tables["characteristics"][0]["value"], tables["report_id"]) == (value, content.report_id)
    assert f"K0001/1 {value:.9f}".rstrip("0") in paths["dfq"].read_text("cp1252")
    measured = etree.parse(paths["qif"]).findtext(".//{*}ThicknessCharacteristicMeasurement/{*}Value")
    assert float(measured) == pytest.approx(value, abs=1e-11)
    points = pye57.E57(str(paths["e57"])).read_scan(0, ignore_missing_fields=True)
    assert len(points["cartesianX"]) == len(content.cloud)
    storage = cv2.FileStorage(str(paths["opencv"]), cv2.FILE_STORAGE_READ)
    assert np.array_equal(storage.getNode("camera_matrix").mat(), content.camera.camera.matrix)
    assert import_camera(paths["opencv-json"], tmp_path / "in").camera.image_size == content.camera.camera.image_size


def test_a_calibration_says_in_the_report_since_when_it_holds(done, folder):
    content = project_content(folder, done.project)
    assert [mark.of for mark in content.calibrations] == ["camera", "planes"]
    for mark in content.calibrations:
        assert mark.made_at is not None
        assert 0 <= mark.age(content.timestamp).total_seconds() < 86400
        assert len(mark.sha256) == 64
    assert len(content.rig_id) == 12


def test_ros_refuses_a_skew_and_takes_the_camera_without(done, folder, tmp_path):
    with pytest.raises(InputError, match="no skew"):
        export(folder, done.project, "ros", tmp_path / "c.yaml")
    camera = without_skew(folder)
    export(folder, done.project, "ros", tmp_path / "c.yaml")
    file = yaml.safe_load((tmp_path / "c.yaml").read_text())
    assert file["camera_matrix"]["data"] == camera.matrix.ravel().tolist()
    back = import_camera(tmp_path / "c.yaml", tmp_path / "in")
    assert np.array_equal(read_camera(tmp_path / "in" / "camera.json").camera.matrix, back.camera.matrix)


def test_a_folder_of_results_is_handed_over_without_its_pictures(done, folder, tmp_path):
    files = export_results(results_folder(folder), ["xlsx", "dfq"], tmp_path / "out")
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"result.xlsx", "result.dfq"}
    assert files == {"xlsx": tmp_path / "out" / "result.xlsx", "dfq": tmp_path / "out" / "result.dfq"}
    with pytest.raises(InputError, match='no format "doc"; choose among pdf, cloud, e57'):
        export_results(results_folder(folder), ["doc"])


def test_choosing_a_template_takes_what_it_names_and_leaves_the_rest_to_the_user(done, folder):
    Image.new("RGB", (40, 20), "red").save(folder / "logo.png")
    (folder / "house.toml").write_text(
        'name = "House of Gauges"\nlogo = "logo.png"\nlanguage = "de"\nwithout = ["frame", "inputs"]\n'
    )
    before = ReportChoices(frozenset({"remarks"}), "Letter")
    choices = choose_template(folder, before, folder / "house.toml")
    assert choices == ReportChoices(frozenset({"remarks", "frame", "inputs"}), "Letter", "de", "house.toml")
    assert choose_template(folder, choices, None) == replace(choices, template="")
    report = make_report(folder, replace(done.project, report=choices))
    text = " ".join(page.extract_text() for page in PdfReader(report).pages)
    assert "House of Gauges" in text
    assert "Messbericht" in text
    assert "bewusst weggelassen: Ein Bild des Scans; Eingaben" in " ".join(text.split())


def test_a_template_that_is_gone_is_told_and_the_old_report_stays(done, folder):
    report = results_folder(folder) / "report.pdf"
    before = report.read_bytes()
    choices = ReportChoices(template="gone.toml")
    with pytest.raises(InputError, match=r"gone\.toml"):
        make_report(folder, replace(done.project, report=choices))
    assert report.read_bytes() == before
