"""`trisect verify`: what lies there is compared with every hash that was kept of it."""

from __future__ import annotations

import hashlib
import io
import json
from dataclasses import replace
from pathlib import Path

import pytest

from core.files.project.data import ProjectFile, Sources, new_project
from core.files.project.folder import create_project, read_project, write_project
from core.files.project.witness import TRAIL
from core.files.recording.recording_set import RIG
from core.pipeline.project.workspace import project_set
from core.wings.audit.trail import read_trail
from core.wings.audit.verify import verify
from core.wings.audit.witness import CHANGING, note_results, noting_results
from tests.simulated import trisect


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """One with a recording within it, and results whose hashes were kept."""
    folder = tmp_path / "block"
    scan = folder / "recordings" / "scan-1"
    scan.mkdir(parents=True)
    (scan / "frame0.png").write_bytes(b"a picture")
    made = replace(new_project("Block"), sources=Sources(scan="recordings/scan-1"))
    create_project(folder, ProjectFile(made))
    inputs = {
        "scan/frame0.png": hashlib.sha256(b"a picture").hexdigest(),
        RIG: project_set(folder, made).rig_hash,
    }
    results = folder / "results"
    results.mkdir()
    run = {"set": "Block", "measured_at": "2026-11-23T10:00:00+00:00", "inputs": inputs}
    (results / "run.json").write_text(json.dumps(run))
    (results / "cloud.ply").write_bytes(b"a cloud")
    note_results(folder)
    return folder


def test_a_project_as_it_was_left_is_whole(project: Path) -> None:
    said = trisect("verify", project)
    assert said.code == 0
    assert read_trail(project).head in said.out
    found = verify(project, head=read_trail(project).entries[0].hash[:12])
    assert (found.results, found.inputs, found.problems) == (2, 2, ())


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("results/cloud.ply", "results/cloud.ply is not what it was (entry 2)"),
        ("recordings/scan-1/frame0.png", "scan/frame0.png is not what the results were made of"),
        ("project.json", "project.json is not what the program last saved"),
    ],
)
def test_a_file_changed_by_hand_is_named(project: Path, name: str, said: str) -> None:
    path = project / name
    path.write_bytes(path.read_bytes() + b"\n")
    told = trisect("verify", project, "--json")
    assert told.code == 1
    assert [(one["text"], bool(one["code"])) for one in json.loads(told.out)["problems"]] == [(said, True)]


def test_results_that_are_gone_or_came_from_elsewhere_are_named(project: Path) -> None:
    (project / "results" / "cloud.ply").rename(project / "results" / "mesh.ply")
    assert [str(problem) for problem in verify(project).problems] == [
        "results/cloud.ply is missing",
        "results/mesh.ply was not made with the results beside it",
    ]


def test_a_report_of_another_project_and_a_changed_trail_are_told(project: Path) -> None:
    assert [problem.code for problem in verify(project, head="abc123" * 10).problems] == ["verify.head_unknown"]
    path = project / TRAIL
    path.write_text(path.read_text().replace("Block", "Blick", 1))
    assert "entry 1 was changed" in trisect("verify", project).out


def test_a_save_that_was_cut_off_is_a_note(project: Path) -> None:
    before = (project / "project.json").read_bytes()
    made = read_project(project).project
    write_project(project, ProjectFile(replace(made, info=replace(made.info, part="A"))))
    (project / "project.json").write_bytes(before)
    found = verify(project)
    assert (found.problems, [note.code for note in found.notes]) == ((), ["verify.save_cut_off"])


def test_a_program_that_ends_between_its_results_and_their_entry_has_not_changed_good_ones(
    project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("core.wings.audit.witness.append", _killed)
    with pytest.raises(KeyboardInterrupt), noting_results(project):
        (project / "results" / "cloud.ply").write_bytes(b"a better cloud")
    monkeypatch.undo()
    found = verify(project)
    assert (found.problems, [note.code for note in found.notes]) == ((), ["verify.change_cut_off"])
    assert "1 file was not compared" in trisect("verify", project).out
    with noting_results(project):
        pass
    assert (verify(project).problems, verify(project).notes) == ((), ())
    (project / "results" / "cloud.ply").write_bytes(b"a cloud made by hand")
    assert [problem.code for problem in verify(project).problems] == ["verify.result"]


def _killed(*_: object, **__: object) -> None:
    raise KeyboardInterrupt


def test_what_failed_has_its_entry_only_where_it_changed_something(project: Path) -> None:
    before = len(read_trail(project).entries)
    with pytest.raises(ValueError, match="no faces"), noting_results(project):
        raise ValueError("no faces")
    assert len(read_trail(project).entries) == before
    with pytest.raises(ValueError, match="no faces"), noting_results(project):
        (project / "results" / "cloud.ply").unlink()
        raise ValueError("no faces")
    assert len(read_trail(project).entries) == before + 1
    assert (verify(project).problems, (project / CHANGING).exists()) == ((), False)


def test_the_trail_is_shown_and_exported_and_takes_remarks(project: Path, tmp_path: Path) -> None:
    said = trisect("audit", project, "--remark", "seen by the customer", "--csv", tmp_path / "trail.csv")
    assert said.code == 0
    assert "seen by the customer" in said.out
    assert 'info.name: – → "Block"' in said.out
    assert "seen by the customer" in (tmp_path / "trail.csv").read_text()
    assert trisect("audit", tmp_path).code == 2


def test_people_are_named_and_sign_on_the_command_line(project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def say(*words: object, pins: str = "") -> str:
        monkeypatch.setattr("sys.stdin", io.StringIO(pins))
        said = trisect(*words)
        return said.out if said.code == 0 else said.sentence

    assert "everybody may do everything" in say("people", project)
    anna = ("--add", "Anna", "--role", "administrator")
    assert "administrator" in say("people", project, *anna, "--reasons", pins="anna-1\n")
    assert "only an administrator" in say("people", project, "--add", "Ole", pins="0000\n")
    assert "operator" in say("people", project, "--add", "Ole", "--by", "Anna", pins="anna-1\n0000\n")
    assert "do not belong together" in say("audit", project, "--sign", "Ole", pins="1111\n")
    signed = say("audit", project, "--sign", "Ole", "--remark", "measured by me", pins="0000\n")
    assert "Ole (operator)" in signed and "measured by me" in signed
    assert "everybody may do everything" in say("people", project, "--reset", "PIN lost")
    assert verify(project).problems == ()
