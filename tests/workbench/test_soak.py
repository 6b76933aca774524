"""The soak, short: a real driver's emulated camera through the live scan page, every frame accounted for."""

import re
import subprocess
import sys

import pytest

pytestmark = pytest.mark.accuracy


def test_every_frame_of_a_camera_is_recorded_or_counted_and_the_window_never_freezes():
    pytest.importorskip("pypylon", reason="pypylon is not installed (pip install -e '.[basler]')")
    command = [sys.executable, "-m", "tests.soak", "--window", "--seconds", "4", "--scale", "0.25"]
    ran = subprocess.run(command, capture_output=True, text=True, check=False, timeout=150)
    print(ran.stdout)
    assert ran.returncode == 0, ran.stdout + ran.stderr  # counts, log, freezes
    recorded, overlays = (int(re.search(rf"(\d+) {what}", ran.stdout)[1]) for what in ("recorded", "overlays"))
    assert recorded > 20
    assert overlays > 0
