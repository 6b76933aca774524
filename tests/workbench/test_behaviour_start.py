"""The window is there soon, on any computer."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
AT_MOST_S = 20.0
"""Of processor time, which other work on the machine hardly changes; usual are 3 to 5 s."""


@pytest.mark.parametrize(
    "opengl",
    [
        pytest.param("", id="as it is"),
        # the program of tests/workbench/test_behaviour_crash.py runs without, too
        pytest.param("1", id="no OpenGL", marks=pytest.mark.accuracy),
    ],
)
def test_the_program_starts_soon_imports_nothing_that_can_wait_and_ends_well(tmp_path: Path, opengl: str) -> None:
    environment = os.environ | {
        "HOME": str(tmp_path),
        "XDG_CONFIG_HOME": str(tmp_path / "config"),
        "XDG_STATE_HOME": str(tmp_path / "state"),
        "TRISECT_NO_OPENGL": opengl,
    }
    program = subprocess.run(
        [sys.executable, "-m", "tests.workbench.driven", "start"],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert program.returncode == 0, program.stderr
    said = dict(line.partition(" ")[::2] for line in program.stdout.splitlines())
    assert said["modules"] == ""
    assert float(said["seconds"]) < AT_MOST_S
    assert "Traceback" not in program.stderr
    (log,) = tmp_path.rglob("workbench.log") if list(tmp_path.rglob("workbench.log")) else (None,)
    assert log is None or "ERROR" not in log.read_text(encoding="utf-8")


def test_something_is_on_the_screen_before_what_takes_long_is_imported(tmp_path: Path) -> None:
    program = """
import sys
from PySide6.QtWidgets import QApplication
import workbench.app as program

class Stopped(Exception):
    pass

class Watched(program.Splash):
    def paintEvent(self, event):
        super().paintEvent(event)
        slow = ("workbench.main_window", "workbench.bench", "scipy", "numpy", "pyqtgraph", "pydantic", "cv2")
        print("drawn", self.isVisible(), *(name for name in slow if name in sys.modules))

    def finish(self):
        windows = [type(one).__name__ for one in QApplication.topLevelWidgets() if one.isVisible() and one is not self]
        print("replaced by", *windows)
        super().finish()
        print("gone", not self.isVisible())
        raise Stopped

program.Splash = Watched
try:
    program.main([])
except Stopped:
    pass
"""
    surroundings = {"HOME": str(tmp_path), "XDG_CONFIG_HOME": str(tmp_path), "XDG_STATE_HOME": str(tmp_path)}
    ran = subprocess.run(
        [sys.executable, "-c", program],
        cwd=ROOT,
        env=os.environ | surroundings,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    said = ran.stdout.splitlines()
    assert said[0] == "drawn True", ran.stderr
    assert said[-2:] == ["replaced by MainWindow", "gone True"]


@pytest.mark.skipif(sys.platform == "win32", reason="a program is ended without a word there")
@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_ended_by_a_signal_it_leaves_no_temporary_folder_of_saved_code(tmp_path: Path, name: str) -> None:
    program = f"""
import signal
signal.signal(signal.{name}, signal.default_int_handler)  # some who run tests ignore it
from PySide6.QtCore import QCoreApplication, QTimer
from core.code_cache import code_cache
from workbench.app import remove_cache_before_signals_end

app = QCoreApplication()
code_cache()
remove_cache_before_signals_end(app)
QTimer.singleShot(0, lambda: print("waits", flush=True))
app.exec()
"""
    (tmp_path / "no folder").write_text("")
    (tmp_path / "temporary").mkdir()
    surroundings = {"NUMBA_CACHE_DIR": str(tmp_path / "no folder"), "TMPDIR": str(tmp_path / "temporary")}
    without = {key: value for key, value in os.environ.items() if key != "TRISECT_TEMPORARY_CACHE"}
    with subprocess.Popen(
        [sys.executable, "-c", program], cwd=ROOT, env=without | surroundings, stdout=subprocess.PIPE, text=True
    ) as window:
        assert window.stdout is not None
        assert window.stdout.readline() == "waits\n"
        assert [path.name[:17] for path in (tmp_path / "temporary").iterdir()] == ["trisect-compiled-"]
        window.send_signal(getattr(signal, name))
        try:
            assert window.wait(60) == -getattr(signal, name)
        finally:
            window.kill()
    assert list((tmp_path / "temporary").iterdir()) == []
