"""Jobs for the tests of lanes; they run in another process.

Each of many processes imports this module: what takes long to import is imported by the job that needs it.
"""

from __future__ import annotations

import os
import sys
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from core.errors import InputError
from core.progress import Progress

if TYPE_CHECKING:
    from core.files.project.data import Project


def double(value: int, progress: Progress) -> int:
    progress("doubling", 1, 1)
    return 2 * value


def refuse(progress: Progress) -> None:
    raise InputError("the board has 8 × 6 corners, not 9 × 6", where="view03.png", todo="check rig.toml")


def crash(progress: Progress) -> None:
    raise ZeroDivisionError("nothing goes into nothing")


def remember(value: int, memory: dict[str, int]) -> int | None:
    before = memory.get("value")
    memory["value"] = value
    return before


def die(progress: Progress) -> None:
    os._exit(3)


def count_until_cancelled(progress: Progress) -> None:
    for i in range(10_000):
        progress("counting", i, 10_000)
        time.sleep(0.01)


def deaf(progress: Progress) -> None:
    time.sleep(60)


def past_its_last_look(progress: Progress) -> str:
    time.sleep(0.3)
    return "written"


def unsendable(progress: Progress) -> Any:
    return lambda: None


def watched(count: int, progress: Progress, watch: Any) -> int:
    for i in range(count):
        watch(i)
    return count


def echo(channel: Any) -> list[Any]:
    heard: list[Any] = []
    while True:
        command = channel.command()
        if command == "stop":
            return heard
        if command is not None:
            heard.append(command)
            channel.offer(command)
        time.sleep(0.005)


def surroundings(progress: Progress) -> tuple[str, bool]:
    import sys

    return os.environ.get("OPENBLAS_NUM_THREADS", ""), "PySide6.QtWidgets" in sys.modules


def pieces() -> Any:
    """Work to be done ahead, a fifth of a second each."""
    return [lambda: _piece()] * 50, False


def first_pieces() -> Any:
    """The same for the first time, and few."""
    return [lambda: _piece()] * 3, True


def _piece() -> None:
    time.sleep(0.2)
    _DONE.append(1)


_DONE: list[int] = []


def pieces_done(progress: Progress) -> int:
    return len(_DONE)


def picture(megabytes: int, progress: Progress) -> Any:
    return {"picture": np.full((megabytes, 1 << 20), 7, np.uint8), "small": np.arange(5)}


def pictures_for_ever(channel: Any) -> None:
    while True:
        channel.emit(np.zeros(1 << 21, np.uint8))
        time.sleep(0.001)


def pictures_shown(count: int, channel: Any) -> None:
    large = np.zeros((10, 1 << 20), np.uint8)
    for _ in range(count):
        while not channel.ready():
            time.sleep(0.002)
        channel.offer(large)


def prints(progress: Progress) -> int:
    print("printed")
    os.write(1, b"written to the first descriptor\n")
    return len(sys.stdin.read())


def until_the_window_is_gone(place: str, channel: Any) -> None:
    Path(place, "began").write_text(str(os.getpid()))
    try:
        while True:
            channel.command()
            time.sleep(0.01)
    finally:
        Path(place, "kept").write_text("")


def leaves_threads_that_compute() -> None:
    import cv2

    def compute() -> None:
        picture = np.zeros((300, 300), np.uint8)
        while True:
            cv2.GaussianBlur(picture, (9, 9), 2.0)

    for _ in range(4):
        threading.Thread(target=compute, daemon=True).start()


def project_to_measure(speaks: str, has_fan: bool, progress: Progress) -> Project:
    from core.files.project.data import new_project

    return new_project("Sample")
