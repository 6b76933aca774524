"""The bar of a whole job, as a terminal shows it."""

import io
import sys

from rich.console import Console

from core.cli import bar as module
from core.cli.bar import bar
from core.remaining import USUAL_S


class Terminal(io.StringIO):
    def isatty(self):
        return True

    @property
    def lines(self):
        return [line for line in self.getvalue().replace("\r", "\n").splitlines() if "0:00:0" in line]


def terminal(monkeypatch):
    made = Terminal()
    monkeypatch.setattr(sys, "stderr", made)
    monkeypatch.setattr(module, "Console", lambda stderr: Console(stderr=stderr, force_terminal=True, width=100))
    return made


def test_a_terminal_shows_one_bar_with_the_stage_and_the_time_left_of_the_whole_job(monkeypatch):
    shown = terminal(monkeypatch)
    with bar("run") as progress:
        progress("camera views", 0, 10)
        first = shown.lines[-1]
        progress("camera views", 10, 10)
        progress("plane poses", 0, 9)
        second = shown.lines[-1]
    assert "camera views" in first
    assert f"about {sum(USUAL_S['run'].values()):.0f} s left" in first
    assert "plane poses" in second
    assert "camera views" not in second


def test_of_a_job_that_is_not_known_a_terminal_shows_the_stage_and_no_time_that_nobody_knows(monkeypatch):
    shown = terminal(monkeypatch)
    with bar() as progress:
        progress("packing", 0, 5)
    assert "packing" in shown.getvalue()
    assert "left" not in shown.getvalue()
