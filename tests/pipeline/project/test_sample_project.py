"""The sample as a finished project: whole, or not there at all."""

import shutil
from pathlib import Path

import pytest

from core.errors import Cancelled, InputError
from core.files.project.folder import read_project
from core.files.project.keys import STEPS, changed, inputs_of
from core.pipeline.project import sample_project as module
from core.pipeline.project.sample_project import clear_unfinished, sample_project, sample_to_measure


@pytest.fixture
def small(tiny_set, tmp_path, monkeypatch) -> Path:
    """A tiny set stands for the sample; gives the folder projects are put into."""
    monkeypatch.setattr(module, "sample_set", lambda progress, has_fan=True: tiny_set)
    monkeypatch.setattr(module, "sample_folder", lambda has_fan=True: tmp_path / "cache" / "sample")
    return tmp_path / "projects"


def until(step):
    """A progress that is cancelled in the middle of a stage."""

    def progress(name, done, total):
        if name == step and 2 * done >= total:
            raise Cancelled

    return progress


@pytest.mark.parametrize("stage", ["camera views", pytest.param("crossings", marks=pytest.mark.accuracy)])
def test_cancelled_in_the_middle_it_leaves_nothing(small, stage):
    with pytest.raises(Cancelled):
        sample_project(small / "Sample", progress=until(stage))
    assert list(small.iterdir()) == []


def test_it_is_finished_and_nothing_of_it_is_out_of_date(small, finished_project_folder, monkeypatch):
    """What `finished_project` makes is made once for all tests; here it is put in place."""
    asked = []

    def made_before(folder, project, progress):
        asked.append(project)
        shutil.copytree(finished_project_folder, folder, dirs_exist_ok=True)
        (folder / "project.json").unlink()
        return read_project(finished_project_folder)

    monkeypatch.setattr(module, "finished_project", made_before)
    folder = sample_project(small / "Sample")
    assert [path.name for path in small.iterdir()] == ["Sample"]
    file = read_project(folder)
    assert {"camera", "planes", "scan", "report"} <= set(file.results) <= set(STEPS)
    for step, done in file.results.items():
        assert changed(done.rests_on, inputs_of(step, file.project, file.results)) == (), step
    assert (folder / "results" / "report.pdf").read_bytes().startswith(b"%PDF")
    (project,) = asked
    assert project.info.notes and not project.accepted.camera


def test_it_says_what_it_is_in_the_language_of_who_opens_it(small):
    info = sample_to_measure("de").info
    assert (info.name, info.part, info.laboratory) == ("Beispiel", "Endmaß 50 mm", "Simulierter Aufbau")
    assert info.notes.startswith("Jedes Bild")


def test_what_is_there_already_is_left_alone(small):
    (small / "Sample").mkdir(parents=True)
    with pytest.raises(InputError, match="there is something already; choose another name"):
        sample_project(small / "Sample")


def test_what_a_killed_process_left_is_cleared_up(small):
    (small / ".Sample.abc" / "project" / "results").mkdir(parents=True)
    (small / "Sample of mine").mkdir()
    clear_unfinished(small / "Sample")
    assert [path.name for path in small.iterdir()] == ["Sample of mine"]
