"""What commands say on standard error off a terminal, `--quiet` and `--verbose`, exit codes, and completion."""

import io
import json
import os
import re
import subprocess
import sys

import pytest

from core.cli import main
from core.cli.bar import bar
from core.cli.options import EPILOG, ExitCode
from core.files.recording.recording_set import open_set
from core.pipeline import batch
from core.pipeline.steps.gauge_step import gauge_step
from core.pipeline.steps.workspace import Workspace
from tests.simulated import copy_of, trisect

TWO_STAGES = (("camera views", 0, 2), ("camera views", 1, 2), ("frames", 0, 1))


def test_off_a_terminal_each_stage_is_a_line_when_it_begins(capfd):
    with bar("run") as progress:
        for told in TWO_STAGES:
            progress(*told)
        assert capfd.readouterr().err == "camera views …\nframes …\n"
    assert capfd.readouterr().err == ""


def test_a_stage_that_was_long_is_told_with_how_long_it_took(capfd, monkeypatch):
    times = iter([0.0, 0.0, 0.0, 12.34, 12.34, 12.5])
    monkeypatch.setattr("core.cli.bar.time.monotonic", lambda: next(times))
    with bar("run") as progress:
        for told in TWO_STAGES:
            progress(*told)
    said = capfd.readouterr().err
    assert re.search(r"^camera views: \d+\.\d s$", said, re.MULTILINE)
    assert "\r" not in said


@pytest.mark.parametrize("executor", ["threads", "processes"])
def test_off_a_terminal_a_batch_tells_each_set_when_its_stages_end(tiny_set, tmp_path, capfd, executor):
    sets = [copy_of(tiny_set, tmp_path / name) for name in ("one", "two")]
    for picture in (picture for folder in sets for picture in (folder / "planes").glob("*.png")):
        picture.write_bytes(b"damaged, so that it ends after the camera")
    where = ("--out", tmp_path / "out", "--executor", executor, "--workers", "1")
    said = trisect("batch", *sets, *where, "--language", "de")
    told = said.err + capfd.readouterr().err  # another process tells it itself
    assert said.code == 2, told
    for name in ("one", "two"):
        assert re.search(rf"^{name}, Kameraansichten: \d+,\d s$", told, re.MULTILINE), told
    if executor == "threads":
        assert trisect("--quiet", "batch", sets[0], *where).err == ""


@pytest.mark.parametrize("words", [("{}", "gauge"), ("gauge", "{}")])
@pytest.mark.parametrize(("option", "shown"), [("--quiet", []), ("-q", []), ("--verbose", ["s"]), ("-v", ["s"])])
def test_how_much_is_said_is_an_option_of_every_command_and_of_the_program(
    tiny_set, tiny_measured, tmp_path, words, option, shown
):
    rest = (tiny_set, "--out", copy_of(tiny_measured, tmp_path / "out"))
    said = trisect(*(word.format(option) for word in words), *rest)
    assert said.code in (0, 1), said.err
    assert "thickness" in said.out
    assert bool(re.search(r"^faces: .* s$", said.err, re.MULTILINE)) == bool(shown)
    assert shown or said.err == ""


def test_every_file_that_is_read_is_a_line_if_that_is_wanted(tiny_set, tmp_path):
    said = trisect("--verbose", "camera", tiny_set, "--out", tmp_path)
    assert said.code == 0, said.err
    lines = [line for line in said.err.splitlines() if line.startswith("file read: ")]
    assert len(lines) == len(set(lines))
    inputs = json.loads((tmp_path / "run.json").read_text())["inputs"]
    assert {f"file read: {tiny_set / name}" for name in inputs} <= set(lines)
    assert "file read" not in trisect("report", tiny_set, "--out", tmp_path).err


def test_the_last_of_both_counts(tiny_set, tiny_measured, tmp_path):
    out = copy_of(tiny_measured, tmp_path / "out")
    assert trisect("--verbose", "gauge", tiny_set, "--out", out, "--quiet").err == ""


def test_even_a_quiet_command_tells_why_it_is_refused(tmp_path):
    said = trisect("run", tmp_path / "none", "--out", tmp_path / "out", "--quiet")
    assert (said.code, "there is no such folder" in said.sentence) == (2, True)


def test_a_part_that_was_measured_without_a_thickness_has_an_exit_code_of_its_own(
    tiny_set, tiny_measured, tmp_path, monkeypatch
):
    folder, out = copy_of(tiny_set, tmp_path / "set"), copy_of(tiny_measured, tmp_path / "out")
    rig = folder / "rig.toml"
    table = "[gauge]\nupper_polygon_px = [[0, 0], [3, 0], [3, 3]]\nlower_polygon_px = [[4, 4], [7, 4], [7, 7]]\n"
    rig.write_text(rig.read_text().partition("[gauge]")[0] + table)
    said = trisect("gauge", folder, "--out", out)
    assert (said.code, bool(said.sentence)) == (3, True)
    monkeypatch.setattr(batch, "run", lambda *_: gauge_step(Workspace.open(open_set(folder), out)))
    said = trisect("batch", folder, "--out", tmp_path / "many", "--executor", "threads", "--workers", "1")
    assert said.code == 3, said.err


def test_the_help_ends_with_every_exit_code():
    assert set(map(int, re.findall(r"\d+", EPILOG))) == set(ExitCode)


def completed(words):
    """What bash would offer, and the modules that were imported for it."""
    program = "import sys, atexit; atexit.register(lambda: print('numba' in sys.modules, file=sys.stderr))\n"
    surroundings = {"_TRISECT_COMPLETE": "complete_bash", "COMP_WORDS": words, "COMP_CWORD": str(words.count(" "))}
    ran = subprocess.run(
        [sys.executable, "-c", f"{program}from core.cli import main; main()"],
        env=os.environ | surroundings, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert ran.stderr.strip() == "False"
    return ran.stdout.split()


def test_a_shell_completes_commands_and_options_without_numba():
    assert {"run", "batch"} <= set(completed("trisect "))
    assert completed("trisect run --ex") == ["--exclude"]


def test_the_script_of_a_shell_is_shown(monkeypatch):
    monkeypatch.setattr("shellingham.detect_shell", lambda: ("bash", "/bin/bash"))  # not the one that runs the tests
    assert "_TRISECT_COMPLETE=complete_bash" in trisect("--show-completion", "bash").out


def test_what_the_encoding_of_a_file_lacks_is_replaced(tiny_set, tiny_measured, tmp_path, monkeypatch):
    out, file = copy_of(tiny_measured, tmp_path / "out"), io.BytesIO()
    monkeypatch.setattr("sys.stdout", io.TextIOWrapper(file, encoding="ascii"))
    with pytest.raises(SystemExit) as left:
        main(["planes", str(tiny_set), "--out", str(out)])
    assert left.value.code in (None, 0) and b"?" in file.getvalue()
