"""What VTK has to say goes to Python's logging, not to the console."""

from __future__ import annotations

import logging

from vtkmodules.vtkCommonCore import vtkCommand, vtkLogger, vtkObject, vtkOutputWindow

_log = logging.getLogger("vtk")
_observed: list[vtkOutputWindow] = []


def route_messages() -> None:
    """Route errors and warnings; once is enough, in the GUI thread, before anything is made."""
    if _observed:
        return
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    window = vtkOutputWindow.GetInstance()
    window.AddObserver(int(vtkCommand.ErrorEvent), _error)
    window.AddObserver(int(vtkCommand.WarningEvent), _warning)
    _observed.append(window)


def _error(_sender: vtkObject, _event: str, text: str) -> None:
    _log.error("%s", text.strip())


def _warning(_sender: vtkObject, _event: str, text: str) -> None:
    _log.warning("%s", text.strip())


for _observer in (_error, _warning):
    setattr(_observer, "CallDataType", "string0")  # noqa: B010  how VTK is told to pass the text on
