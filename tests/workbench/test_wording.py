"""Nothing in the window speaks of files and options that only the command line has."""

from __future__ import annotations

import pytest

from core.errors import InputError
from core.files.atomic import ANOTHER_OUT
from core.messages import Command, Field, Message
from workbench.language import text_of


@pytest.mark.parametrize(
    ("key", "said"),
    [
        ("[camera_target]", "check the target"),
        ("laser_fan.lines", "check the number of lines under Laser"),
        ("target.circles", "check columns and rows of the target"),
        ("target.inner_corners", "check columns and rows of the target"),
        ("target.dictionary", "check markers of the target"),
    ],
)
def test_a_field_of_a_file_is_called_as_in_the_window(key: str, said: str) -> None:
    assert text_of(Message("test.field", "check {field}", field=Field(key))) == said


def test_a_command_is_not_told() -> None:
    todo = Message("test.scan", "measure the scan first{command}", command=Command("trisect scan SET --out DIR"))
    missing = InputError(Message("test.missing", "the file is missing"), where="cloud.ply", todo=todo)
    assert text_of(missing) == "cloud.ply: the file is missing; measure the scan first."


def test_advice_of_an_option_is_advice_of_the_windows_own() -> None:
    full = InputError(Message("test.full", "cannot be written"), where="x", todo=ANOTHER_OUT)
    assert text_of(full).endswith("copy the project to another disk and open it there.")
    assert str(full).endswith("choose another folder with --out.")
