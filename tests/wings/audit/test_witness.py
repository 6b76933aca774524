"""What is written into a project is in its audit trail; where nobody puts it there nothing is written."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from core.door import WITHOUT
from core.errors import InputError
from core.files.project.data import ProjectFile, Sources, new_project
from core.files.project.folder import create_project, read_project, write_project
from core.files.project.next_part import next_part
from core.files.project.packing import pack_project, unpack_project
from core.files.project.witness import Written, evidence_of, witnessed
from core.pipeline.project.report import with_words
from core.report.pdf import build_report
from core.wing import wings
from core.wings.audit.people import Rules, person, read_rules, write_rules
from core.wings.audit.trail import append, read_trail
from tests.report.report_samples import block_content
from tests.report.test_report_inspection import words
from tests.simulated import contents, trisect
from tests.wings.strangers import Install, install, look_again

__all__ = ["install"]

WITNESS = """
from contextlib import contextmanager
from core.files.project.witness import Witness
from core.wing import Wing

SEEN = []

@contextmanager
def sees(folder, written):
    SEEN.append(written.what)
    try:
        yield
    finally:
        SEEN.append("done")

WITNESS = Witness(sees, lambda folder: None)
WING = Wing("eyes", witness="lab_eyes:WITNESS")
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    create_project(tmp_path / "block", ProjectFile(new_project("Block")))
    return tmp_path / "block"


@pytest.fixture
def wing_gone(monkeypatch: pytest.MonkeyPatch, project: Path) -> Iterator[None]:
    """The project was made with the wing, which is not there any more."""
    monkeypatch.setenv(WITHOUT, "audit")
    look_again()
    yield
    monkeypatch.undo()
    look_again()


def outside(project: Path) -> ProjectFile:
    """The project with pictures that lie outside of it."""
    pictures = project.parent / "pictures"
    pictures.mkdir()
    (pictures / "a.png").write_bytes(b"a")
    return ProjectFile(replace(new_project("Block"), sources=Sources(camera=str(pictures))))


def renamed(project: Path) -> ProjectFile:
    file = read_project(project)
    return replace(file, project=replace(file.project, info=replace(file.project.info, part="B")))


def test_a_packed_project_has_the_trail_with_what_packing_changed(project: Path, tmp_path: Path) -> None:
    write_project(project, outside(project))
    before = read_trail(project).entries
    out = unpack_project(pack_project(project, tmp_path / "a.trisectz").path, tmp_path / "out")
    after = read_trail(out)
    assert after.entries[:-1] == before and not after.problems
    assert (after.entries[-1].what, after.entries[-1].why) == ("saved", "packed")
    assert after.entries[-1].state == hashlib.sha256((out / "project.json").read_bytes()).hexdigest()


def test_the_people_go_along_with_their_roles_so_that_limits_stay_closed(project: Path, tmp_path: Path) -> None:
    people = Rules((person("Ada", "administrator", "1234"), person("Bo", "operator", "5678")), reasons=True)
    write_rules(project, people)
    to = next_part(project, tmp_path / "Block 2", "2", "Bo", by=people.people[1])
    assert read_rules(to) == people
    assert read_trail(to).problems == ()


def test_what_fails_within_is_told_to_the_witness_and_goes_on(install: Install, project: Path) -> None:
    install("lab-eyes", {"lab_eyes": WITNESS}, {"trisect.wings": {"eyes": "lab_eyes:WING"}})
    import lab_eyes  # type: ignore[import-not-found]

    write_project(project, renamed(project))
    with pytest.raises(KeyError), witnessed(project, Written("measured")):
        raise KeyError
    assert lab_eyes.SEEN == ["saved", "done", "measured", "done"]


def test_nothing_is_written_past_a_witness_that_cannot_be_loaded(install: Install, project: Path) -> None:
    install("lab-eyes", {"lab_eyes": WITNESS.replace("SEEN = []", "raise OSError")}, {})
    wing = "from core.wing import Wing\nWING = Wing('eyes', witness='lab_eyes:WITNESS')"
    install("lab-wing", {"lab_wing": wing}, {"trisect.wings": {"eyes": "lab_wing:WING"}})
    before = read_project(project)
    with pytest.raises(InputError, match=r"eyes of the package lab-wing 1\.2 failed: OSError"):
        write_project(project, renamed(project))
    assert read_project(project) == before


CHANGES: dict[str, Callable[[Path], object]] = {
    "save": lambda project: write_project(project, renamed(project)),
    "results": lambda project: witnessed(project, Written("measured")).__enter__(),
    "next part": lambda project: next_part(project, project.parent / "2", "2", "Ada"),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_without_the_wing_a_project_with_a_trail_is_read_and_not_changed(
    wing_gone: None, project: Path, change: Callable[[Path], object]
) -> None:
    before = contents(project.parent)
    assert read_project(project).project.info.name == "Block" and evidence_of(project) == ()
    with pytest.raises(InputError) as told:
        change(project)
    assert str(told.value) == (
        f"{project}: nothing of it can be changed, as its changes stand in audit.jsonl, which is written by the wing "
        "audit, which is not there; take it out of TRISECT_WITHOUT_WINGS."
    )
    assert contents(project.parent) == before


@pytest.mark.parametrize("name", ["eyes", "audit"])
def test_without_the_wing_a_witness_of_a_stranger_does_not_open_a_project_with_a_trail(
    install: Install, project: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.setattr("core.wing.OURS", "tests.wings.audit.no_wings")
    stranger = WITNESS.replace('"eyes"', f'"{name}"')
    install("lab-eyes", {"lab_eyes": stranger}, {"trisect.wings": {name: "lab_eyes:WING"}})
    before = contents(project)
    assert [wing.name for wing in wings()] == [name]
    with pytest.raises(InputError, match="which is written by the wing audit"):
        write_project(project, renamed(project))
    assert contents(project) == before


def test_without_the_wing_a_project_is_packed_where_the_pack_says_the_same(
    wing_gone: None, project: Path, tmp_path: Path
) -> None:
    out = unpack_project(pack_project(project, tmp_path / "a.trisectz").path, tmp_path / "out")
    assert contents(out) == contents(project)


def test_without_the_wing_a_project_made_then_has_no_trail_and_is_changed(wing_gone: None, tmp_path: Path) -> None:
    new = tmp_path / "new"
    create_project(new, ProjectFile(new_project("New")))
    write_project(new, renamed(new))
    assert not (new / "audit.jsonl").exists() and read_project(new).project.info.part == "B"
    write_project(new, outside(new))
    unpack_project(pack_project(new, tmp_path / "n.trisectz").path, tmp_path / "out")


def test_a_report_names_the_last_entry_but_those_of_reports_and_without_the_wing_says_that_it_is_missing(
    project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made, content = read_project(project).project, block_content()
    entry = read_trail(project).entries[-1]
    append(project, "reported")
    (evidence,) = with_words(content, project, made).evidence
    assert (str(evidence.text), evidence.sha256) == (
        "Audit trail of the project, SHA-256 of entry 1:", entry.hash,
    )  # fmt: skip
    assert entry.hash in words(build_report(with_words(content, project, made)))
    monkeypatch.setenv(WITHOUT, "audit")
    look_again()
    alone = with_words(content, project, made)
    monkeypatch.undo()
    look_again()
    assert alone.evidence == () and [str(one) for one in alone.notes[len(content.notes) :]] == [
        "The hash of the project's audit trail is not printed, as the wing audit is not there."
    ]


def test_without_the_wing_its_commands_say_which_wing_they_are_of(wing_gone: None, project: Path) -> None:
    said = trisect("verify", project)
    assert said.code == 2 and 'the command "verify" is of the wing audit, which is not there' in said.err
