"""A project in one file: all of it comes out again elsewhere, and nothing that was put in on the way."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from core.errors import InputError
from core.files.project.data import Accepted, Done, Project, ProjectFile, Sources, new_project
from core.files.project.folder import create_project, read_project, write_project
from core.files.project.keys import changed, finished, inputs_of
from core.files.project.lock import take_lock
from core.files.project.packing import CONTENTS, pack_project, unpack_project
from core.files.project.witness import TRAIL
from core.inspect.plan.feature_spec import Deviation, FeatureSpec


def measured(project: Project) -> ProjectFile:
    results: dict[str, Done] = {}
    for step in ("camera", "planes", "scan", "gauge", "report"):
        results[step] = finished(step, project, results)
    return ProjectFile(project, results)


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """One whose scan lies within it and whose other pictures lie outside, everything measured."""
    folder = tmp_path / "there" / "block"
    for place in (tmp_path / "set" / "camera", tmp_path / "set" / "planes", folder / "recordings" / "scan-1"):
        place.mkdir(parents=True)
        (place / "a.png").write_bytes(place.name.encode() * 1000)
    (folder / "results").mkdir()
    (folder / "results" / "gauge.json").write_text("{}")
    sources = Sources(str(tmp_path / "set" / "camera"), str(tmp_path / "set" / "planes"), "recordings/scan-1")
    made = replace(new_project("Block"), sources=sources, accepted=Accepted("c1", "f1"))
    create_project(folder, measured(made))
    return folder


def test_a_packed_project_comes_out_elsewhere_with_all_its_pictures_and_nothing_out_of_date(
    project: Path, tmp_path: Path
) -> None:
    lock = take_lock(project)
    packed = pack_project(project, tmp_path / "block.trisectz")
    lock.release()
    (tmp_path / "there").rename(tmp_path / "gone")
    (tmp_path / "set").rename(tmp_path / "gone set")
    out = unpack_project(packed.path, tmp_path / "here" / "block")
    before, after = files_in(tmp_path / "gone" / "block"), files_in(out)
    assert {name for name in before if after.get(name) != before[name]} - {TRAIL} == {"project.json"}
    added = {"recordings/packed/camera/a.png": b"camera" * 1000, "recordings/packed/planes/a.png": b"planes" * 1000}
    assert {name: after[name] for name in after if name not in before} == added
    assert packed.files == len(after)
    file = read_project(out)
    assert file.project.sources == Sources("recordings/packed/camera", "recordings/packed/planes", "recordings/scan-1")
    for step, done in file.results.items():
        assert not changed(done.rests_on, inputs_of(step, file.project, file.results)), step


def test_a_project_packed_into_its_own_folder_does_not_hold_itself(project: Path) -> None:
    first = pack_project(project, project / "block.trisectz")
    assert pack_project(project, project / "block.trisectz").files == first.files


@pytest.mark.parametrize("name", ["results/gauge.json", "recordings/scan-1/a.png", "project.json"])
def test_one_changed_byte_is_found(project: Path, tmp_path: Path, name: str) -> None:
    packed = pack_project(project, tmp_path / "block.trisectz").path

    def change(files: dict[str, bytes]) -> None:
        files[name] = bytes([files[name][0] ^ 1]) + files[name][1:]

    repacked(packed, change)
    with pytest.raises(InputError, match=f"{name} is not what it was when it was packed"):
        unpack_project(packed, tmp_path / "out")
    assert not (tmp_path / "out").exists()
    assert not list(tmp_path.glob("*.part")) + list(tmp_path.glob(".*.part"))


@pytest.mark.parametrize(
    "name", ["../evil", "/evil", "a/../../evil", "a//b", "c:evil", "a\\evil", "a/.lock.json", "NUL"]
)
def test_no_file_comes_out_beside_the_folder(project: Path, tmp_path: Path, name: str) -> None:
    packed = pack_project(project, tmp_path / "block.trisectz").path

    def add(files: dict[str, bytes]) -> None:
        listed = json.loads(files[CONTENTS])
        listed["files"][name] = {"bytes": 0, "sha256": "0" * 64}
        files[CONTENTS] = json.dumps(listed).encode()
        files[name] = b""

    repacked(packed, add)
    with pytest.raises(InputError):
        unpack_project(packed, tmp_path / "deep" / "out")
    assert not list(tmp_path.rglob("*evil*"))


def test_what_is_not_in_the_list_and_what_is_longer_than_said_is_refused(project: Path, tmp_path: Path) -> None:
    packed = pack_project(project, tmp_path / "block.trisectz").path
    repacked(packed, lambda files: files.update({"extra": b"x"}))
    with pytest.raises(InputError, match="its files are not those of"):
        unpack_project(packed, tmp_path / "out")
    packed = pack_project(project, tmp_path / "bomb.trisectz").path
    repacked(packed, lambda files: files.update({"results/gauge.json": b"0" * 30_000_000}))
    with pytest.raises(InputError, match="is longer than it is said to be"):
        unpack_project(packed, tmp_path / "out")


@pytest.mark.parametrize("share", [0.0, 0.3, 0.9, 0.999])
def test_a_file_cut_off_is_no_packed_project(project: Path, tmp_path: Path, share: float) -> None:
    packed = pack_project(project, tmp_path / "block.trisectz").path
    whole = packed.read_bytes()
    packed.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(InputError, match="no whole packed project"):
        unpack_project(packed, tmp_path / "out")


def test_a_folder_that_is_there_is_left_alone_and_no_project_is_not_packed(project: Path, tmp_path: Path) -> None:
    packed = pack_project(project, tmp_path / "block.trisectz").path
    with pytest.raises(InputError, match="is there already"):
        unpack_project(packed, project)
    with pytest.raises(InputError, match=r"there is no project\.json here"):
        pack_project(tmp_path / "set", tmp_path / "no.trisectz")
    assert not (tmp_path / "no.trisectz").exists()


def test_pictures_within_a_project_are_named_relative_to_it_however_it_was_made(tmp_path: Path) -> None:
    folder = tmp_path / "block"
    (folder / "set" / "scan").mkdir(parents=True)
    file = measured(replace(new_project("x"), sources=Sources(scan=str(folder / "set" / "scan"))))
    create_project(folder, file)
    kept = read_project(folder)
    assert kept.project.sources == Sources(scan="set/scan")
    assert not changed(kept.results["scan"].rests_on, inputs_of("scan", kept.project, kept.results))
    assert kept.results["scan"].key != file.results["scan"].key


def repacked(path: Path, change: Callable[[dict[str, bytes]], None]) -> None:
    with zipfile.ZipFile(path) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    change(files)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name, data)


def files_in(folder: Path) -> dict[str, bytes]:
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_a_name_that_is_no_text_is_told(project: Path, tmp_path: Path) -> None:
    (project / "results" / "ä.txt").write_text("x")
    packed = pack_project(project, tmp_path / "block.trisectz").path
    packed.write_bytes(packed.read_bytes().replace("ä.txt".encode(), b"\x91\x91.txt", 1))  # in the file's own head
    with pytest.raises(InputError, match="no whole packed project"):
        unpack_project(packed, tmp_path / "out")


def test_nominal_surfaces_and_the_template_with_its_logo_come_along_from_outside_and_nothing_is_out_of_date(
    project: Path, tmp_path: Path
) -> None:
    outside = tmp_path / "office"
    (outside / "pictures").mkdir(parents=True)
    (outside / "part.stl").write_bytes(b"outside")
    (outside / "pictures" / "logo.png").write_bytes(b"logo")
    (outside / "ours.toml").write_text('name = "A"\nlogo = "pictures/logo.png"\n')
    (project / "own.stl").write_bytes(b"within")
    names = (str(outside / "part.stl"), str(project / "own.stl"), str(tmp_path / "gone.stl"))
    features = tuple(
        FeatureSpec(f"skin{number}", "deviation", deviation=Deviation(name)) for number, name in enumerate(names)
    )
    made = read_project(project).project
    made = replace(
        made,
        inspection=replace(made.inspection, features=features),
        report=replace(made.report, template=str(outside / "ours.toml")),
    )
    file = measured(made)
    results = {**file.results, "inspection": finished("inspection", made, file.results)}
    file = replace(file, results={**results, "report": finished("report", made, results)})
    write_project(project, file)
    packed = pack_project(project, tmp_path / "block.trisectz").path
    outside.rename(tmp_path / "closed")
    out = unpack_project(packed, tmp_path / "here")
    back = read_project(out)
    found = [feature.deviation.nominal for feature in back.project.inspection.features if feature.deviation]
    assert [(out / name).read_bytes() for name in found[:2]] == [b"outside", b"within"]
    assert found[1:] == ["own.stl", names[2]]
    template = out / back.project.report.template
    assert template.read_text().startswith('name = "A"')
    assert (template.parent / "pictures" / "logo.png").read_bytes() == b"logo"
    assert set(back.results) == set(file.results)
    for step, done in back.results.items():
        assert not changed(done.rests_on, inputs_of(step, back.project, back.results)), step
