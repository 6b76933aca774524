"""A virtual screen of one's own: windows of two test processes on one screen take the keyboard from each other."""

from __future__ import annotations

import os
import subprocess

WANTED = "TRISECT_VIRTUAL_SCREEN"
"""Environment variable: 1 opens a screen for every test process."""

SIZE = "1920x1080x24"


def open_screen() -> subprocess.Popen[bytes]:
    """Start a virtual X server on a free display, which it chooses itself, and point this process to it.

    Raises
    ------
    RuntimeError
        If the server ends before it is ready.
    """
    ready, told = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(told), "-screen", "0", SIZE, "-nolisten", "tcp"],
        pass_fds=(told,),
        stderr=subprocess.DEVNULL,
    )
    os.close(told)
    with os.fdopen(ready) as answer:
        display = answer.readline().strip()
    if not display:
        raise RuntimeError(f"Xvfb ended with code {server.wait()} before it was ready")
    os.environ["DISPLAY"] = f":{display}"
    os.environ["QT_QPA_PLATFORM"] = "xcb"
    return server
