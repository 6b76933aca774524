"""Results of another set are not replaced without a word; those of the same set are made anew as ever."""

import hashlib
from dataclasses import replace
from pathlib import Path

import pytest

from core.errors import InputError
from core.files.recording.recording_set import open_set
from core.files.results.run_file import write_run
from core.pipeline.run import _require_own_results
from core.pipeline.steps.workspace import Workspace
from tests.simulated import copy_of, trisect


def digests(folder: Path) -> dict[str, str]:
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.iterdir() if path.is_file()}


@pytest.fixture
def other(tiny_set: Path, tmp_path: Path) -> Path:
    """A set with the same calibration pictures and another scan."""
    folder = copy_of(tiny_set, tmp_path / "other" / tiny_set.name)
    for frame in (folder / "scan").iterdir():
        frame.write_bytes(frame.read_bytes() + b"\0")
    return folder


def test_another_set_is_refused_and_no_result_is_touched(tiny_measured: Path, other: Path, tmp_path: Path) -> None:
    out = copy_of(tiny_measured, tmp_path / "out")
    before = digests(out)
    said = trisect("run", other, "--out", out)
    assert said.code == 2 and digests(out) == before
    assert f"out: it has the results of other pictures, of the set {other.name}; name another --out" in said.sentence


def test_the_same_pictures_are_the_same_set_wherever_they_lie_and_whatever_rig_toml_says(
    tiny_measured: Path, tiny_set: Path, tmp_path: Path
) -> None:
    out, moved = copy_of(tiny_measured, tmp_path / "out"), copy_of(tiny_set, tmp_path / "renamed")
    (moved / "rig.toml").write_text((moved / "rig.toml").read_text() + "\n[air]\nscanned_celsius = 21.0\n")
    next(iter(sorted((moved / "scan").iterdir()))).unlink()
    _require_own_results(Workspace.open(open_set(moved), out), over_simulated=False)


def test_the_demo_replaces_another_simulated_set_and_nothing_else(
    tiny_measured: Path, other: Path, tmp_path: Path
) -> None:
    work = Workspace.open(open_set(other), copy_of(tiny_measured, tmp_path / "out"))
    _require_own_results(work, over_simulated=True)
    write_run(work.path("run"), replace(work.record(), simulated=None))
    with pytest.raises(InputError):
        _require_own_results(work, over_simulated=True)


def test_a_folder_within_a_set_names_the_folder_above(tiny_set: Path, tmp_path: Path) -> None:
    said = trisect("run", tiny_set / "scan", "--out", tmp_path / "out")
    assert said.code == 2 and not (tmp_path / "out" / "run.json").exists()
    what = "this is a folder within a recording set, not the set"
    wanted = f"{tiny_set / 'scan'}: {what}; name the folder above it, {tiny_set}"
    assert wanted in said.sentence
