"""Whatever path a command is given, it ends in one sentence that is no fault of the program."""

import errno
import io
import os
from itertools import product

import platformdirs
import pytest

from core.cli.app import whole_command
from core.pipeline.executors import THREADS, executor_of
from tests.simulated import trisect

GROUP = whole_command()[0]


def commands(group, words=()):
    """Every command below a group, by its words."""
    for name, command in group.commands.items():
        if hasattr(command, "commands"):
            yield from commands(command, (*words, name))
        else:
            yield (*words, name), command


def takes_paths(param):
    return "pathlib.Path" in str(param.type_descriptor.annotation)


def is_argument(param):
    return param.param_type_name == "argument"


CASES = [
    pytest.param(words, command, param.name, odd, id=f"{' '.join(words)}-{param.name}-{odd}")
    for (words, command), odd in product(commands(GROUP), ("too long", "loop", "pipe", "empty"))
    for param in command.params
    if takes_paths(param) and (words, odd) != (("demo",), "empty")  # that is here, where it would measure
]


@pytest.fixture
def odd_path(tmp_path):
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    os.mkfifo(tmp_path / "pipe")
    return {"too long": "x" * 300, "empty": ""}.get


def value_of(param, folder):
    """A value of a parameter that is wanted and is not what the test is about."""
    if takes_paths(param):
        return str(folder)
    choices = getattr(param.type_descriptor.annotation, "__members__", None)
    return str(next(iter(choices.values()))) if choices else "1"


@pytest.mark.parametrize(("words", "command", "name", "odd"), CASES)
def test_it_is_told_in_a_sentence_and_is_no_fault(
    words, command, name, odd, odd_path, simulated, tmp_path, monkeypatch
):
    monkeypatch.setattr(platformdirs, "user_log_dir", lambda *_, **__: str(tmp_path / "logs"))
    monkeypatch.setattr("sys.stdin", io.StringIO())
    monkeypatch.setattr("core.simulate.sample.sample_set", lambda progress: simulated)  # `demo` would render its own
    monkeypatch.setattr("core.cli.measuring.executor_of", lambda *_: executor_of(THREADS))  # `batch`: processes
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "folder"
    folder.mkdir()
    given = []
    for param in command.params:
        if param.name != name and not param.required:
            continue
        value = odd_path(odd, str(tmp_path / odd)) if param.name == name else value_of(param, folder)
        given += [value] if is_argument(param) else [param.opts[0], value]
    said = trisect(*words, *given)
    assert said.code in (0, 1, 2), said.err
    assert "Traceback" not in said.err


def test_a_fault_of_the_disk_within_a_command_names_its_file(tmp_path, monkeypatch):
    def fail(*_args, **_more):
        raise OSError(errno.EACCES, "Permission denied", str(tmp_path / "rig.toml"))

    monkeypatch.setattr("core.cli.results.import_camera", fail)
    said = trisect("import-camera", tmp_path / "c.yml", "--out", tmp_path)
    assert said.code == 2
    assert said.sentence == f"trisect: {tmp_path / 'rig.toml'}: cannot be read (Permission denied)."
