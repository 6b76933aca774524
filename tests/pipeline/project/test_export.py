"""Looking at a report before it is made, and copies for others."""

import json
import os
from dataclasses import replace

import numpy as np
import pytest
from pypdf import PdfReader

from core.errors import Cancelled, InputError
from core.files.atomic import write_bytes
from core.files.project.data import Accepted, ReportChoices
from core.files.project.folder import results_folder
from core.files.results.ply import read_cloud, read_mesh
from core.files.results.run_file import read_run
from core.pipeline.project.calibration import accept_planes, find_poses, solve_poses
from core.pipeline.project.export import export, keep_imported_camera, preview_report
from core.pipeline.project.measuring import measure_scan
from core.pipeline.project.report import make_report, report_bytes
from core.report.template import SECTIONS
from tests.simulated import copy_of


@pytest.fixture
def folder(done, tmp_path):
    return copy_of(done.folder, tmp_path / "project")


def test_the_preview_is_the_report_and_writes_nothing(done, folder):
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*")}
    pages = preview_report(folder, done.project, 300)
    assert {path: path.stat().st_mtime_ns for path in folder.rglob("*")} == before
    assert len(pages) == len(PdfReader(results_folder(folder) / "report.pdf").pages)
    for page in pages:
        assert (page.dtype, page.shape[1:]) == (np.uint8, (300, 3))
        assert page.shape[0] == pytest.approx(300 * 297 / 210, abs=2)
        assert page.mean() > 200, "a page is mostly white"
        assert page.std() > 5, "and not empty"


@pytest.mark.accuracy
def test_a_project_measures_with_a_camera_of_another_program(done, folder, tmp_path):
    file = export(folder, done.project, "opencv", tmp_path / "camera.yaml")
    bare = replace(done.project, sources=replace(done.project.sources, camera=""), accepted=Accepted())
    id_ = keep_imported_camera(folder, bare, file)
    bare = replace(bare, accepted=Accepted(camera=id_))
    poses = find_poses(folder, bare)
    fan = accept_planes(folder, bare, solve_poses(folder, bare, poses), poses)
    bare = replace(bare, accepted=Accepted(camera=id_, planes=fan))
    measured = measure_scan(folder, bare)
    assert measured.gauge.thickness_mm == pytest.approx(done.summary.gauge.thickness_mm, abs=done.summary.gauge.U_mm)
    assert read_run(results_folder(folder) / "run.json").settings["camera"]["imported"] == file.resolve().as_posix()
    words = "".join(page.extract_text() for page in PdfReader(make_report(folder, bare)).pages)
    assert "Free camera parameters" not in words, "nobody here knows which were free"


def test_the_preview_follows_sections_and_paper(done, folder):
    whole = PdfReader(results_folder(folder) / "report.pdf").pages
    choices = ReportChoices(frozenset(SECTIONS), "Letter")
    short = preview_report(folder, replace(done.project, report=choices), 300)
    assert len(short) < len(whole)
    assert short[0].shape[0] == pytest.approx(300 * 11 / 8.5, abs=2)


def test_a_preview_can_be_cancelled(done, folder):
    def stop(step, now, total):
        raise Cancelled

    with pytest.raises(Cancelled):
        preview_report(folder, done.project, 300, stop)


@pytest.mark.parametrize(
    ("kind", "name"), [("pdf", "report.pdf"), ("cloud", "cloud.ply"), ("mesh", "mesh.ply"), ("json", "gauge.json")]
)
def test_a_copy_has_the_bytes_of_the_result(done, folder, tmp_path, kind, name):
    copy = export(folder, done.project, kind, tmp_path / f"out-{name}", in_camera_frame=True)
    assert copy.read_bytes() == (results_folder(folder) / name).read_bytes()
    if kind == "json":
        assert json.loads(copy.read_text())["thickness_mm"] == pytest.approx(50, abs=1)


def test_the_surface_as_stl_has_every_triangle(done, folder, tmp_path):
    stl = export(folder, done.project, "stl", tmp_path / "part.stl").read_bytes()
    mesh = read_mesh(results_folder(folder) / "mesh.ply")
    assert int(np.frombuffer(stl, "<u4", 1, 80)[0]) == len(mesh.triangles)


def test_the_points_as_csv_have_every_point(done, folder, tmp_path):
    csv = export(folder, done.project, "csv", tmp_path / "points.csv").read_text().splitlines()
    points = [line for line in csv if line[:1].isdigit() or line[:1] == "-"]
    assert len(points) == len(read_cloud(results_folder(folder) / "cloud.ply").cloud)


@pytest.mark.parametrize("kind", ["pdf", "cloud", "mesh", "stl", "csv", "json"])
def test_what_is_not_there_is_told_and_nothing_is_written(done, folder, tmp_path, kind):
    for path in results_folder(folder).iterdir():
        path.unlink()
    with pytest.raises(InputError, match=r"is not there|is missing"):
        export(folder, done.project, kind, tmp_path / "copy")
    assert not (tmp_path / "copy").exists()


@pytest.mark.accuracy
def test_the_report_of_a_project_that_cannot_be_written_to_is_exported_and_nothing_else_is_written(
    done, folder, tmp_path, monkeypatch
):
    (results_folder(folder) / "report.pdf").unlink()
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*")}
    monkeypatch.setattr(os, "access", lambda *_: False)
    path = export(folder, done.project, "pdf", tmp_path / "out.pdf")
    assert path.read_bytes() == report_bytes(folder, done.project)
    assert {path: path.stat().st_mtime_ns for path in folder.rglob("*")} == before


def test_a_copy_that_cannot_be_written_leaves_an_older_one_whole(done, folder, tmp_path):
    older = tmp_path / "older"
    write_bytes(older, b"older")
    (tmp_path / "file").write_text("in the way")
    for kind in ("pdf", "csv", "stl"):
        with pytest.raises(InputError, match="cannot be written"):
            export(folder, done.project, kind, tmp_path / "file" / "copy")
    assert older.read_bytes() == b"older"


def test_exporting_a_result_onto_itself_changes_nothing(done, folder):
    report = results_folder(folder) / "report.pdf"
    before = report.read_bytes()
    export(folder, done.project, "pdf", report)
    assert report.read_bytes() == before
