"""How what went wrong with a job is told."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication

from core.errors import InputError
from workbench.wording import in_the_window
from workbench.worker import Failure

ENDED = "ProcessEnded"
"""The kind of failure of a job whose process is gone."""


def sentence(problem: InputError | Failure) -> str:
    """The one sentence that tells a failed task to the technician."""
    if not isinstance(problem, Failure):
        return in_the_window(str(problem))
    if problem.kind == ENDED:
        return _tr("The process that does this ended unexpectedly. What was recorded and measured before is kept.")
    return _tr("Something went wrong in the program; your work is kept. Details: {0}").format(problem)


def details(problem: InputError | Failure) -> str:
    """What may be copied beside the sentence."""
    return problem.details if isinstance(problem, Failure) else ""


def _tr(text: str) -> str:
    return QCoreApplication.translate("Tasks", text)
