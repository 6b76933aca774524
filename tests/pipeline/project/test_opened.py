"""A project opened to be read: what is there, nothing of two measurements at once, and nothing written."""

import pytest

from core.errors import InputError
from core.files.project.data import ProjectFile, new_project
from core.files.project.folder import create_project, write_project
from core.pipeline.project.opened import open_project


@pytest.fixture
def folder(tmp_path):
    create_project(tmp_path / "block", ProjectFile(new_project("block")))
    return tmp_path / "block"


def test_what_is_not_there_is_nothing(folder):
    project = open_project(folder / "project.json")
    assert project.settings.info.name == "block"
    assert (project.camera, project.planes, project.cloud, project.mesh, project.gauge, project.inspection) == (
        None,
    ) * 6
    assert project.characteristics == () and not project.changed


def test_a_folder_of_results_has_no_settings(tmp_path):
    (tmp_path / "camera.json").write_text("{}")
    project = open_project(tmp_path)
    assert project.settings is None and project.camera is None
    assert len(project.results.problems) == 1, "the damaged file is told"


def test_what_was_not_read_before_a_change_is_refused_and_what_was_stays(folder):
    project = open_project(folder)
    before = project.settings
    write_project(folder, ProjectFile(new_project("other")))
    assert project.changed and project.settings is before
    with pytest.raises(InputError, match="opened_again"):
        _ = project.results
    assert project.opened_again().settings.info.name == "other"


def test_where_neither_a_project_nor_a_result_is_nothing_is_opened(tmp_path):
    with pytest.raises(InputError, match="neither a project nor a result"):
        open_project(tmp_path)


def test_reading_writes_nothing(folder):
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*")}
    project = open_project(folder)
    assert project.results.problems == () and project.settings
    assert {path: path.stat().st_mtime_ns for path in folder.rglob("*")} == before
