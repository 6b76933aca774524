"""One sentence where no window can be opened: Qt ends the process itself then, in its own words."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from PySide6.QtCore import QMessageLogContext, QtMsgType, qInstallMessageHandler

from core.messages import Message

EXIT_CODE = 2
"""As of any other bad input."""
UNREACHABLE = ("could not connect to display", "Failed to create wl_display")
"""What Qt says, of X11 and of Wayland, where there is no display."""
LIBRARIES = "libegl1 libgl1 libxcb-cursor0 libxcb-icccm4 libxcb-keysyms1"


@contextmanager
def told_without_display(words: Callable[[Message], str]) -> Iterator[None]:
    """Print one sentence by `words` and end the process if Qt cannot open windows while the block makes them ready."""
    heard: list[str] = []

    def hear(kind: QtMsgType, _: QMessageLogContext, text: str) -> None:
        if kind is not QtMsgType.QtFatalMsg:
            heard.append(text)
            return
        if sys.stderr is not None:
            sys.stderr.write(f"{words(reason([*heard, text]))}\n")
            sys.stderr.flush()
        os._exit(EXIT_CODE)  # after this Qt would abort, which looks like a crash

    before = qInstallMessageHandler(hear)
    try:
        yield
    finally:
        qInstallMessageHandler(before)
    if heard and sys.stderr is not None:
        sys.stderr.write("\n".join(heard) + "\n")


def reason(heard: Sequence[str]) -> Message:
    """Make the sentence on why no window can be opened, from what Qt said before it gave up."""
    if any(sign in text for text in heard for sign in UNREACHABLE):
        return Message(
            "window.no_display",
            "The window cannot be opened, for there is no display: start it on a desktop, or through ssh -X; "
            "without a screen, trisect run SET --out DIR measures.",
        )
    return Message(
        "window.no_platform",
        "The window cannot be opened, for Qt cannot draw here ({reason}): install what it needs "
        "(Debian, Ubuntu: apt install {libraries}).",
        reason=" ".join(heard[0].split()),
        libraries=LIBRARIES,
    )
