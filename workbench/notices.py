"""The only messages: what the window tells the technician, kept in a list and in a log file.

Exceptions that nobody foresaw, in any thread, and Qt's own warnings end here as well. The hooks may run on any thread,
so all they do is emit a signal.
"""

from __future__ import annotations

import logging
import sys
import threading
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum
from logging.handlers import RotatingFileHandler
from pathlib import Path
from types import TracebackType
from typing import Any

import platformdirs
from PySide6.QtCore import QMessageLogContext, QObject, QtMsgType, Signal, qInstallMessageHandler

from workbench.language import text_of, tr
from workbench.work.worker import Failure

log = logging.getLogger("trisect.workbench")

KEPT = 500
"""So many notices are kept in the list; the log file has them all."""


class Level(StrEnum):
    """Gravity of a notice."""

    INFO = "info"
    WARNING = "warning"
    ERROR = "error"


@dataclass(frozen=True, slots=True)
class Notice:
    """Notice: a sentence, and details to copy."""

    level: Level
    text: str
    details: str = ""
    at: datetime = field(default_factory=lambda: datetime.now().astimezone())
    job: str = ""
    """Which job could not be done, if this tells of one; it is no longer so when that job begins anew."""


class Notices(QObject):
    """List of all notices of this session, newest last."""

    added = Signal(object)
    _raised = Signal(str, str, str)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.all: list[Notice] = []
        self._raised.connect(lambda level, text, details: self.add(Level(level), text, details))
        self._restore: list[Callable[[], object]] = []

    def add(self, level: Level, text: str, details: str = "", *, job: str = "") -> None:
        """Add a notice with its level, text and details for copying; call it in the GUI thread only."""
        notice = Notice(level, text, details, job=job)
        self.all.append(notice)
        del self.all[:-KEPT]
        log.log(_LOG_LEVEL[level], "%s%s", text, f"\n{details}" if details else "")
        self.added.emit(notice)

    def info(self, text: str, details: str = "") -> None:
        """Add a notice of the level "info": something that is good to know."""
        self.add(Level.INFO, text, details)

    def warning(self, text: str, details: str = "") -> None:
        """Add a notice of the level "warning": something to look at."""
        self.add(Level.WARNING, text, details)

    def error(self, text: str, details: str = "") -> None:
        """Add a notice of the level "error": something has stopped a job."""
        self.add(Level.ERROR, text, details)

    def failed(self, problem: Exception | Failure, job: str = "") -> None:
        """Add a notice of the error that stopped a job; `job` is the name of that job."""
        self.add(Level.ERROR, text_of(problem), problem.details if isinstance(problem, Failure) else "", job=job)

    def raised(self, kind: type[BaseException], value: BaseException, trace: TracebackType | None) -> None:
        """Add a notice of an exception that no code caught, of any thread; the program goes on."""
        details = "".join(traceback.format_exception(kind, value, trace))
        text = tr("Something went wrong in the program; your work is kept. Details: {details}", details=kind.__name__)
        self._raised.emit(Level.ERROR, text, details)

    def catch_everything(self) -> None:
        """Show uncaught exceptions of all threads and Qt's warnings as notices, until `release`."""
        if self._restore:
            return
        before = sys.excepthook, threading.excepthook, sys.unraisablehook
        sys.excepthook = self.raised
        threading.excepthook = lambda args: self.raised(
            args.exc_type, args.exc_value or args.exc_type(), args.exc_traceback
        )
        sys.unraisablehook = lambda args: self.raised(
            args.exc_type, args.exc_value or args.exc_type(), args.exc_traceback
        )
        qt_before = qInstallMessageHandler(_qt_message)

        def restore() -> None:
            sys.excepthook, threading.excepthook, sys.unraisablehook = before
            qInstallMessageHandler(qt_before)

        self._restore.append(restore)

    def release(self) -> None:
        """Restore the exception and message handlers that `catch_everything` replaced."""
        while self._restore:
            self._restore.pop()()


def log_to_file(folder: Path | None = None) -> Path | None:
    """Write the log to a file of limited size in the user's log folder; return it, or None if that is impossible."""
    folder = folder or Path(platformdirs.user_log_dir("trisect", appauthor=False))
    try:
        folder.mkdir(parents=True, exist_ok=True)
        handler = RotatingFileHandler(
            folder / "workbench.log", maxBytes=1_000_000, backupCount=3, encoding="utf-8", delay=True
        )
    except OSError as error:
        log.warning("no log file: %s", error)
        return None
    handler.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(name)s %(message)s"))
    root = logging.getLogger("trisect")
    root.setLevel(logging.INFO)
    root.propagate = False
    root.addHandler(handler)
    return folder / "workbench.log"


def _qt_message(kind: QtMsgType, context: QMessageLogContext, text: str | None) -> None:
    log.log(_QT_LEVEL.get(kind, logging.WARNING), "Qt: %s (%s)", text, getattr(context, "category", ""))


_LOG_LEVEL = {Level.INFO: logging.INFO, Level.WARNING: logging.WARNING, Level.ERROR: logging.ERROR}
_QT_LEVEL: dict[Any, int] = {
    QtMsgType.QtDebugMsg: logging.DEBUG,
    QtMsgType.QtInfoMsg: logging.INFO,
    QtMsgType.QtWarningMsg: logging.WARNING,
    QtMsgType.QtCriticalMsg: logging.ERROR,
}
