"""Processes of the window: a QProcess each, and what goes through the pipes of those that run jobs.

All of it happens in the GUI thread: Qt reads the pipes, and tells when a whole message may be there. No Python thread
of the window ever holds an object of Qt's, so the garbage collector may run whenever Python likes.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from typing import Any

from PySide6.QtCore import QObject, QProcess, QProcessEnvironment, Qt, QTimer, Signal

from core.processes import module_command
from workbench.work import wire
from workbench.work.jobs import Job
from workbench.work.wire import HEAD, Kind

ENDS_WITHIN_MS = 3000
"""A process that was killed is gone after milliseconds; the program's end waits for it no longer than this."""


class ChildProcess(QObject):
    """Python process that ends with this one: its standard input is a pipe from here, which it reads until the end.

    `gone` comes once, with why: the process could not be started, or ended by itself. After `end` it does not come.

    Parameters
    ----------
    module, arguments
        One of the program's modules, run as `python -m module arguments` would.
    """

    gone = Signal(str)

    def __init__(self, module: str, arguments: Sequence[str], parent: QObject) -> None:
        super().__init__(parent)
        self._ended = False
        self._process = QProcess(self)
        self._process.setProcessChannelMode(QProcess.ProcessChannelMode.ForwardedErrorChannel)
        self._process.setProcessEnvironment(_environment())
        # Queued: within its own signal Qt would tell of nothing new, and a question in between would stop the lane.
        self._process.readyReadStandardOutput.connect(self._read, Qt.ConnectionType.QueuedConnection)
        self._process.finished.connect(self._finished, Qt.ConnectionType.QueuedConnection)
        self._process.errorOccurred.connect(self._failed, Qt.ConnectionType.QueuedConnection)
        program, *rest = module_command(module, *arguments)
        self._process.start(program, rest)

    @property
    def pid(self) -> int:
        """Process id in the operating system; 0 if the process does not run."""
        return self._process.processId()

    @property
    def is_over(self) -> bool:
        """Whether the process has ended or could not be started."""
        return self._process.state() == QProcess.ProcessState.NotRunning

    def end(self) -> None:
        """Kill the process without waiting for its end; this object then deletes itself."""
        if self._ended:
            return
        self._ended = True
        if self._process.state() == QProcess.ProcessState.NotRunning:
            self._finished()
        else:
            self._process.kill()

    def wait(self) -> None:
        """Wait until a process that was killed is gone; for the program's end, when no event comes."""
        if self._process.state() != QProcess.ProcessState.NotRunning:
            self._process.waitForFinished(ENDS_WITHIN_MS)
        self._clean_up()

    def _read(self) -> None:
        """Take what the process has written; nothing is wanted of it here."""
        self._process.readAllStandardOutput()

    def _clean_up(self) -> None:
        """Remove what the process needed on the disk."""

    def _failed(self, error: QProcess.ProcessError) -> None:
        if error is QProcess.ProcessError.FailedToStart:
            self._finished()

    def _finished(self, *_: Any) -> None:
        self._read()
        told, self._ended = self._ended, True
        self._clean_up()
        if not told:
            self.gone.emit(self._process.errorString())
        self.deleteLater()


class WorkerProcess(ChildProcess):
    """Process that runs jobs, from its start to its end.

    `received` brings the kind of each message, the number of its job, and its body, to be read with `wire.value_of` or
    `wire.forget`; it does not come after `end`.
    """

    received = Signal(int, int, object)

    def __init__(self, name: str, warm: tuple[Job, ...], ahead: Job | None, parent: QObject) -> None:
        self._folder = wire.memory_folder()
        super().__init__("workbench.work.worker", [name, self._folder.name], parent)
        self._head: tuple[int, int, int] | None = None
        self._more = QTimer(self)
        self._more.setSingleShot(True)
        self._more.setInterval(0)
        self._more.timeout.connect(self._read)
        self.send(Kind.SETUP, 0, (warm, ahead))

    def send(self, kind: Kind, number: int, value: Any = None) -> None:
        """Send the worker a message of a kind on job `number`; it is written when the pipe is free."""
        self._process.write(wire.frame(kind, number, value))

    def _clean_up(self) -> None:
        self._folder.cleanup()

    def _read(self) -> None:
        """Tell of every whole message; its receiver may open a dialog, in which this is called again."""
        while not self._ended:
            if self._head is None and self._process.bytesAvailable() >= HEAD.size:
                self._head = HEAD.unpack(self._process.read(HEAD.size).data())
            if self._head is None or self._process.bytesAvailable() < self._head[2]:
                return
            kind, number, size = self._head
            self._head = None
            body = self._process.read(size).data()
            if self._process.bytesAvailable():
                self._more.start()  # what is there already is told of by no signal of Qt's, if a question comes now
            self.received.emit(kind, number, body)


def _environment() -> QProcessEnvironment:
    """The environment of this process, where Python finds what it finds here."""
    all_ = QProcessEnvironment.systemEnvironment()
    all_.insert("PYTHONPATH", os.pathsep.join(path for path in sys.path if path))
    return all_
