"""The real program, started as its users start it, with somebody in it who does what a test asks for.

`python -m tests.workbench.driven DEED [PROJECT [SCENE]]`; every line it writes is a fact: "edited", "recorded 12".
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from PySide6.QtCore import QTimer

import workbench.app as program
from workbench.main_window import MainWindow
from workbench.project_model import AUTOSAVE_MS
from workbench.views import ask

HEAVY = ("numba", "matplotlib", "pyvista", "vtkmodules", "reportlab", "pypdfium2", "pypylon", "trimesh")
"""What the window can do without until somebody measures or looks at something in 3D; as `core.pipeline.steps`."""


def say(*words: object) -> None:
    """A fact for whoever reads standard output."""
    print(*words, flush=True)


def edit(window: MainWindow, *_: str) -> None:
    """Change the project, do not save it, and say when the change should be safe."""
    project = window.model.project
    window.model.edit("change part", replace(project, info=replace(project.info, part="Edited, not saved")))
    QTimer.singleShot(2 * AUTOSAVE_MS, lambda: say("edited"))


def record(window: MainWindow, scene: str) -> None:
    """Edit, then record a scan of the simulated rig, and say how many frames the window was told of."""
    edit(window)
    window.go_to("scan")
    live: Any = window.presenters["scan"].live  # type: ignore[attr-defined]
    live.settings.set_id(scene)
    live.view.connect(lambda view: say("recorded", view.recorded))
    start_when_possible(live)


def start_when_possible(live: Any) -> None:
    """Start as soon as the page lets one."""
    live.start()
    if not live.running:
        QTimer.singleShot(50, lambda: start_when_possible(live))


def tell_of_start(window: MainWindow, *_: str) -> None:
    """The window is there and answers: how much processor time that took."""
    say("seconds", round(time.process_time(), 2))
    window.close()


def tell_of_modules() -> None:
    """What had to be imported for the window."""
    say("modules", *sorted(name for name in sys.modules if name in HEAVY or name.startswith("core.pipeline.steps")))


DEEDS: dict[str, Callable[..., None]] = {"edit": edit, "record": record, "start": tell_of_start}


def main() -> int:
    """Run the program and do the deed once it is there."""
    deed, project, more = DEEDS[sys.argv[1]], sys.argv[2:3], sys.argv[3:]
    after_start = program._after_start

    def then(window: MainWindow, path: Path | None) -> None:
        if deed is tell_of_start:
            tell_of_modules()  # before the program begins, in idle time, with what can wait
        after_start(window, path)
        deed(window, *more)

    program._after_start = then
    ask.ask = lambda *_, **__: 0  # nobody is there to be asked: the first answer, as to take back unsaved work
    return program.main(project)


if __name__ == "__main__":
    sys.exit(main())
