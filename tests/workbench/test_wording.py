"""Nothing in the window speaks of files and options that only the command line has."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import core
from workbench.wording import in_the_window

ROOM = Path(core.__file__).parent
COMMAND_LINE = re.compile(r"trisect \w+ SET|--out")


@pytest.mark.parametrize(
    ("said", "plainer"),
    [
        (
            "planes: only 2 of the 3 promised fan lines were seen; check laser_fan.lines in rig.toml, and that every "
            "line falls on the target in several poses.",
            "planes: only 2 of the 3 promised fan lines were seen; check the number of lines under Laser, and that "
            "every line falls on the target in several poses.",
        ),
        ("show more, and check its columns, rows and dictionary in rig.toml", "check its columns, rows and markers"),
        ("check the camera's calibration and the target's size in rig.toml", "and the target's size"),
        ("cloud.ply: the file is missing; measure the scan first: trisect scan SET --out DIR.", "the scan first."),
        ("x: cannot be written, because the disk is full; choose another folder with --out.", "open it there."),
        ("x: damaged; check rig.toml.", "x: damaged; check rig.toml."),
    ],
)
def test_the_command_lines_words_are_replaced(said: str, plainer: str) -> None:
    assert in_the_window(said).endswith(plainer)


def test_no_advice_in_core_keeps_an_option_of_the_command_line() -> None:
    advice = re.compile(r'(?<!")"([^"]*(?:--out|SET --)[^"]*)"(?!")')
    found = [
        text
        for path in ROOM.rglob("*.py")
        if path.relative_to(ROOM).parts[0] not in ("cli.py", "cli")
        for text in advice.findall(path.read_text(encoding="utf-8"))
    ]
    assert found
    assert not [text for text in found if COMMAND_LINE.search(in_the_window(text))]
