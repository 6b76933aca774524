"""Whatever happens, the command line says one sentence, and leaves with a code that means what it says."""

import json
from pathlib import Path

import platformdirs
import pytest

from core.cli import results
from core.cli.output import print_rows
from core.errors import LONGEST, InputError
from core.messages import Message, plain, visible
from tests.simulated import trisect


@pytest.fixture(autouse=True)
def logs(tmp_path, monkeypatch):
    monkeypatch.setattr(platformdirs, "user_log_dir", lambda *_, **__: str(tmp_path / "logs"))
    return tmp_path / "logs"


@pytest.fixture
def fault(monkeypatch):
    def fail(*_):
        raise ZeroDivisionError("float\x1b[31m division")

    monkeypatch.setattr(results, "import_camera", fail)


def test_what_nobody_foresaw_leaves_with_a_sentence_a_report_and_a_code_of_its_own(fault, logs, tmp_path):
    said = trisect("import-camera", tmp_path / "c.yml", "--out", tmp_path)
    assert said.code == 70
    assert "a fault of the program kept it from going on (ZeroDivisionError); please send the report" in said.sentence
    (report,) = logs.iterdir()
    assert str(report) in said.sentence
    text = report.read_text()
    assert "Traceback" in text
    assert "import-camera" in text
    assert "float\\x1b[31m division" in text


def test_the_same_for_machines(fault, tmp_path):
    said = trisect("import-camera", tmp_path / "c.yml", "--out", tmp_path, "--json")
    assert said.code == 70
    assert json.loads(said.out)["code"] == "cli.fault"


def test_where_no_report_can_be_written_the_sentence_stands_alone(fault, logs, tmp_path):
    logs.write_text("in the way")
    said = trisect("import-camera", tmp_path / "c.yml", "--out", tmp_path)
    assert (said.code, said.sentence.count("report")) == (70, 0)


@pytest.mark.parametrize("name", ["a\x1b[2Jb", "a\rb", "a\nb", "a\u202eb", "a\x9bb", "a\udcffb"])
def test_a_name_is_written_without_its_control_characters(name):
    told = str(InputError(Message("x.y", "there is no {name}", name=name), where=Path(name), todo=plain(name)))
    assert visible(told) == told
    assert "ab" not in told


def test_a_sentence_has_an_end():
    told = str(InputError("why " * 500, where=Path("/somewhere" * 300 + "/file.toml"), todo="do " * 500))
    assert len(told) <= LONGEST
    assert "/file.toml: " in told
    assert told.endswith(".")
    short = InputError("a reason", where=Path("/some" * 50 + "/file.toml"))
    assert str(short) == f"{'/some' * 50}/file.toml: a reason."


@pytest.mark.parametrize("word", ["/{}", "(/{}", "[/{}"])
def test_a_sentence_that_is_too_long_by_any_number_of_characters_has_an_end(word):
    for more in range(LONGEST + 50):
        told = str(
            InputError(f"there is no scan ({word.format('x' * more)})", where=word.format("y" * 80), todo="scan")
        )
        assert len(told) <= LONGEST
        assert told.endswith("scan.")


def test_our_own_words_are_never_cut():
    reasons = tuple(
        Message(
            "x.reason", "{pose}: {reason}", pose=f"pose{k:02d}", reason=Message("x.why", "no stripe was found " * 4)
        )
        for k in range(3)
    )
    what = Message(
        "x.none", "only one pose can be used ({reasons:;}), as {name} says", reasons=reasons, name="no " * 99
    )
    told = str(InputError(what, where="planes", todo=Message("x.todo", "look at the pictures " * 3)))
    assert len(told) > LONGEST
    assert told.count("no stripe was found") == 12
    assert told.count("look at the pictures") == 3
    assert "as no no" in told and "no …" in told, "a text from outside is cut, between two words"


def test_names_are_never_read_as_markup(capsys):
    print_rows([("frame [/b]", "[/b] \x1b[31m:smile: [red]x")], [plain("[/i] note")], {"cloud": Path("[/b]") / "c.ply"})
    said = capsys.readouterr().out
    assert "frame [/b]" in said
    assert "[/b] \\x1b[31m:smile: [red]x" in said
    assert "note: [/i] note" in said
    assert "[/b]: c.ply" in said


@pytest.mark.parametrize("words", [("[/b]",), ("run", "[/b]"), ("run", "x", "--[/b]"), ("run", "x\x1b[31m")])
def test_a_wrong_command_line_is_told_without_markup(words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said = trisect(*words)
    assert said.code == 2
    assert "Traceback" not in said.err
    assert "\x1b" not in said.err
