"""Ctrl-C, SIGTERM and SIGHUP: whichever comes, a command ends in order, and its exit code says which it was."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

from core.cli.options import ExitCode
from core.errors import Cancelled

CODES = {
    getattr(signal, name): code
    for name, code in (
        ("SIGINT", ExitCode.INTERRUPTED),
        ("SIGTERM", ExitCode.TERMINATED),
        ("SIGHUP", ExitCode.HUNG_UP),
        ("SIGBREAK", ExitCode.TERMINATED),
    )
    if hasattr(signal, name)
}
"""What a command leaves with, by the signal that ended it; Windows has SIGINT and SIGBREAK."""


class Interrupts:
    """Record of the signal that has asked a command to end; 0 if none has."""

    def __init__(self) -> None:
        self.signal = 0
        self.in_order: Callable[[int], bool] | None = None
        """Where a command ends by itself when it is told of a signal: whether it does by this one."""

    def check(self) -> None:
        """Raise Cancelled if a signal has asked the command to end."""
        if self.signal:
            raise Cancelled

    @property
    def code(self) -> ExitCode:
        """Exit code of a command that a signal has ended."""
        return CODES.get(self.signal, ExitCode.INTERRUPTED)

    def interrupt(self, signum: int, frame: FrameType | None) -> None:
        """Handle a signal: record it, and raise KeyboardInterrupt.

        A terminal that is closed sends SIGHUP twice: while a command ends in order only Ctrl-C cuts that short.
        """
        if self.signal and signum != signal.SIGINT:
            return
        if self.in_order is not None and self.in_order(signum):
            self.signal = 0 if signum == signal.SIGINT else signum
            return
        self.signal = self.signal or signum
        raise KeyboardInterrupt


_taken: Interrupts | None = None


@contextmanager
def interruptible() -> Iterator[Interrupts]:
    """Make a context that records signals which end the command, and raises KeyboardInterrupt; nesting is allowed.

    Python drops an exception that falls into a finaliser or a callback of compiled code, and the job would go on.
    """
    global _taken
    if _taken is not None or threading.current_thread() is not threading.main_thread():
        yield _taken or Interrupts()  # signals reach the main thread only
        return
    _taken = made = Interrupts()
    before = {one: signal.signal(one, made.interrupt) for one in CODES if not _is_left_out(one)}
    try:
        yield made
    finally:
        _taken = None
        for one, handler in before.items():
            signal.signal(one, handler or signal.SIG_DFL)


def _is_left_out(one: signal.Signals) -> bool:
    """Whether a signal does not concern the command: `nohup` has it ignore SIGHUP."""
    return one != signal.SIGINT and signal.getsignal(one) is signal.SIG_IGN
