"""What changed, and why nothing is proven, is said before all else, once, and in red where there is a colour."""

import pytest

from core.cli import output
from core.findings.proof import OF_SCAN
from core.findings.table import gravest_first, is_grave
from core.messages import Message, plain

CHANGED, MOVED_WITHIN = OF_SCAN["rig_changed"].note, OF_SCAN["moved"].note
ASSUMED, POINTLESS = plain("Assumed is a plate."), plain("5 frames gave no points.")


def test_the_change_is_said_first_and_each_note_once():
    assert gravest_first((ASSUMED, POINTLESS, MOVED_WITHIN, ASSUMED, CHANGED, MOVED_WITHIN)) == (
        MOVED_WITHIN, CHANGED, ASSUMED, POINTLESS,
    )  # fmt: skip


def test_what_is_said_of_a_result_is_as_grave_as_what_is_said():
    assert is_grave(Message("report.note_of_result", "{name}: {note}", name="A", note=CHANGED))
    assert not is_grave(Message("report.note_of_result", "{name}: {note}", name="A", note=ASSUMED))


@pytest.mark.parametrize("surroundings", [{}, {"NO_COLOR": "1"}, {"piped": "1"}])
def test_the_command_line_says_it_in_red_on_a_screen_that_wants_colours(surroundings, capsys, monkeypatch):
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("TERM", "xterm-256color")
    if "piped" not in surroundings:
        monkeypatch.setenv("FORCE_COLOR", "1")  # as on a screen
    else:
        monkeypatch.delenv("FORCE_COLOR", raising=False)
    for name, value in surroundings.items():
        monkeypatch.setenv(name, value)
    output.print_rows([], (ASSUMED, CHANGED))
    first, second = capsys.readouterr().out.strip().splitlines()
    assert str(CHANGED) in first and str(ASSUMED) in second
    assert ("\x1b[31m" in first) is (not surroundings)
    assert "\x1b[31m" not in second
