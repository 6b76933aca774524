"""Somebody at the frozen window: cancels a job, opens the sample, looks at the result in 3D. Fails if any of it fails.

`trisect-workbench --module bundle/try_window.py`, in the folder that is shipped, on a screen with OpenGL.
"""

import os
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtCore import QRect, QTimer
from PySide6.QtGui import QImage

import workbench.app as program
from workbench.main_window import MainWindow
from workbench.views.scene.ready import readiness
from workbench.views.scene.view import SceneView
from workbench.work import tasks

LOOK_MS = 50
"""How often it is looked whether what is waited for has come."""
PATIENCE_S = 240.0
"""Longer than the sample takes on a slow machine of two cores."""
DRAWN = 0.05
"""Share of the view's middle that is coloured, at least, where a cloud is seen: plates and scales are not so much."""
COLOURED = 60
"""Grey levels between the strongest and the weakest colour of a point that is coloured."""

Wanted = Callable[[], object]
failures: list[str] = []


def say(*words: object) -> None:
    """Tell what was seen."""
    print(*words, flush=True)


def visitor(window: MainWindow) -> Iterator[tuple[str, Wanted]]:
    """What is done, and after each deed what is waited for and how it is called."""
    bench, notices = window.bench, []
    bench.notices.added.connect(notices.append)
    yield "window is shown", window.isVisible
    yield "both children run", lambda: bench.measuring.pid and bench.quick.pid
    children = bench.measuring.pid, bench.quick.pid

    told: list[tuple[str, int, int]] = []
    window.projects.open_sample()
    yield "job runs", lambda: bench.measuring.current
    bench.measuring.current.progressed.connect(lambda *step: told.append(step))
    yield "job tells how far it is", lambda: len(told) > 2
    ended: list[Any] = []
    bench.measuring.task_ended.connect(ended.append)
    window.task_bar.cancel.click()
    yield "job is cancelled", lambda: ended and not bench.measuring.busy and not bench.quick.busy
    alive("a cancelled job leaves its process as it was", (bench.measuring.pid, bench.quick.pid) == children)
    alive("no project is open after a cancelled job", not bench.model.is_open)

    window.projects.open_sample()
    yield "sample opens", lambda: bench.model.is_open
    yield "sample opens at its result", lambda: window.current == "inspect"
    yield "3D is known", lambda: readiness().kind is not None
    alive(f"3D is drawn in the window, not as a picture ({readiness().kind})", readiness().kind == "embedded")
    yield "cloud is drawn by OpenGL in the window", lambda: any(map(is_drawn, window.findChildren(SceneView)))
    alive("children are those of the start", (bench.measuring.pid, bench.quick.pid) == children)
    for pid in children:
        alive(f"child {pid} runs", sys.platform != "linux" or Path(f"/proc/{pid}").exists())
    bad = [f"{notice.text} {notice.details}" for notice in notices if notice.level.name in ("ERROR", "WARNING")]
    alive(f"nothing is complained of: {bad}", not bad)


def is_drawn(view: SceneView) -> bool:
    """Whether a 3D view shows its cloud, by its own word and by its picture."""
    state = view.state()
    if not view.isVisible() or state.kind != "embedded" or not state.points or not state.complete:
        return False
    shown = view.screen().grabWindow(view.window().winId())  # of the screen: Qt's own pictures leave OpenGL out
    shown.save(os.environ.get("TRISECT_SHOT", "window.png"))
    corner = view.mapTo(view.window(), view.rect().center()) - view.rect().center() / 2
    image = shown.copy(QRect(corner, view.size() / 2)).toImage().convertToFormat(QImage.Format.Format_RGB32)
    pixels = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.width(), 4)[..., :3]
    return float(np.mean(np.ptp(pixels, axis=-1) > COLOURED)) > DRAWN


def alive(what: str, holds: bool) -> None:
    """Tell whether something holds, and remember if not."""
    say("yes" if holds else "NO", what)
    if not holds:
        failures.append(what)


def visit(window: MainWindow) -> None:
    """Do one deed after another, each when what it waits for has come."""
    deeds = visitor(window)
    began = time.monotonic()
    waited: tuple[str, Wanted] = next(deeds)
    timer = QTimer(window, interval=LOOK_MS)

    def look() -> None:
        nonlocal waited, began
        what, wanted = waited
        try:
            if not wanted():
                if time.monotonic() - began < PATIENCE_S:
                    return
                raise TimeoutError(f"{what}: not within {PATIENCE_S:.0f} s")
            say(f"yes {what} ({time.monotonic() - began:.1f} s)")
            began = time.monotonic()
            waited = next(deeds)
        except StopIteration:
            timer.stop()
            window.close()
        except Exception as error:  # noqa: BLE001  (whatever it is, it is told, and the window closes)
            timer.stop()
            failures.append(str(error))
            say("NO", repr(error))
            window.close()

    timer.timeout.connect(look)
    timer.start()


# A job that does not stop soon is ended with its process, as a busy machine would have it; here none may end.
tasks.STOP_WITHIN_MS = int(1000 * PATIENCE_S)
after_start = program._after_start


def then(window: MainWindow, path: Path | None) -> None:
    """What the program does once its window is shown, and then the visit."""
    after_start(window, path)
    visit(window)


program._after_start = then
code = program.main([])
say(f"exit code {code}, {len(failures)} failures", *failures)
sys.exit(1 if failures or code else 0)
