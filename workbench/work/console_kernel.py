"""The process of the Python console: an IPython kernel that has a project open to be read. Knows nothing of Qt.

`python -m workbench.work.console_kernel CONNECTION PROJECT COLOURS`, of the extra `console`. Standard input says when a
calculation is to stop; at its end, which is that of the window, the process ends, whatever it does.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from pathlib import Path

import numpy as np
from ipykernel.kernelapp import IPKernelApp

from core.errors import InputError
from core.files.results.rig_history import own_folder
from core.pipeline.project.opened import OpenedProject, open_project
from workbench.work.wire import INTERRUPT


def main() -> None:
    """Run the IPython kernel of the console until the window closes the pipe."""
    connection, folder, colours = sys.argv[1:]
    threading.Thread(target=_listen, args=(threading.main_thread().ident,), daemon=True).start()
    os.chdir(Path.home())  # what is saved by name alone is not to lie in the project
    history = own_folder() / "console"
    history.mkdir(parents=True, exist_ok=True)
    os.environ["IPYTHONDIR"] = str(history)
    names: dict[str, object] = {"np": np, "open_project": open_project, "project": _opened(folder)}
    IPKernelApp.launch_instance(argv=["-f", connection, f"--InteractiveShell.colors={colours}"], user_ns=names)


def _opened(folder: str) -> OpenedProject | None:
    """The project; None if it went away meanwhile: the console has `open_project` all the same."""
    try:
        return open_project(folder)
    except InputError as error:
        sys.stderr.write(f"trisect: {error}\n")
        return None


def _listen(main_thread: int) -> None:
    """Stop the calculation, or the process, when the window says so."""
    while said := os.read(0, 1):
        if said != INTERRUPT:
            continue
        if hasattr(signal, "pthread_kill"):
            signal.pthread_kill(main_thread, signal.SIGINT)  # wakes what waits in the main thread, too
        else:
            signal.raise_signal(signal.SIGINT)
    os._exit(0)


if __name__ == "__main__":
    main()
