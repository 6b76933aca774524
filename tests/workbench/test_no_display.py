"""Without a display the window says so in one sentence and leaves as after any other bad input."""

import os
import subprocess
import sys

import pytest

from core.messages import ENGLISH
from workbench.no_display import LIBRARIES, reason

PLATFORM = ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM", "XDG_SESSION_TYPE", "TRISECT_LANGUAGE", "LC_ALL", "LANG")


@pytest.mark.skipif(sys.platform != "linux", reason="only there a desktop may be missing")
@pytest.mark.parametrize("stated", [{}, {"DISPLAY": ":977"}, {"QT_QPA_PLATFORM": "xcb"}])
def test_one_sentence_says_what_is_missing_and_what_to_do(stated):
    env = {name: value for name, value in os.environ.items() if name not in PLATFORM} | stated
    said = subprocess.run([sys.executable, "-m", "workbench"], capture_output=True, text=True, env=env, timeout=60)
    assert (said.returncode, said.stdout) == (2, "")
    assert said.stderr.startswith("The window cannot be opened, for ") and said.stderr.count("\n") == 1
    assert "qt.qpa" not in said.stderr


def test_a_missing_library_is_no_missing_display():
    missing = 'Could not load the Qt platform plugin "xcb" in "" even though it was found.'
    said = ENGLISH(reason([missing, "This application failed to start"]))
    assert missing.rstrip(".") in said and LIBRARIES in said and "no display" not in said
    assert "there is no display" in ENGLISH(reason(["qt.qpa.xcb: could not connect to display :1", missing]))
