"""The help of every command fits a terminal of 80 columns, and nothing in it is cut."""

import re

import pytest

from core.cli import language
from core.cli.app import whole_command
from tests.simulated import trisect

COLUMNS = 80
COMMANDS = sorted(whole_command()[0].commands)


@pytest.mark.parametrize("spoken", ["en", "de"])
def test_no_line_is_wider_and_no_word_cut(monkeypatch, spoken):
    monkeypatch.setenv("COLUMNS", str(COLUMNS))
    wide, cut = [], []
    for command in COMMANDS:
        lines = trisect("--language", spoken, command, "--help").out.splitlines()
        wide += [(command, line) for line in lines if len(line) > COLUMNS]
        cut += [(command, line) for line in lines if re.search(r"[\w.…/-]…(?!/)", line)]
        assert len(lines) > 5
    language.choose([])
    assert wide == [] and cut == []


def test_a_choice_is_named_by_one_word_and_its_values_in_the_help(monkeypatch):
    monkeypatch.setenv("COLUMNS", str(COLUMNS))
    said = " ".join(trisect("run", "--help").out.replace("│", " ").split())
    assert "--method METHOD network: all sweeps" in said and "--channel CHANNEL Look at" in said
    for value in ("three-crossings", "red-green", "green-red", "blue-red"):
        assert value in said
