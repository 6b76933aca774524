"""The 3D libraries are imported beside the window, which does not wait for them at its end."""

import subprocess
import sys
import textwrap

PARTS, PART_S = 40, 1.0
"""An import that takes 40 s, as of many modules on a slow disk."""
TIMEOUT_S = 20.0
"""Half of it: a busy machine may take seconds to start Python and Qt."""


def test_the_program_ends_while_the_3d_libraries_are_still_being_imported(tmp_path):
    for part in range(PARTS):
        follows = f"import slow_{part + 1}" if part + 1 < PARTS else ""
        (tmp_path / f"slow_{part}.py").write_text(f"import time\ntime.sleep({PART_S})\n{follows}\n")
    program = textwrap.dedent(
        f"""
        import sys
        from PySide6.QtCore import QTimer
        from PySide6.QtWidgets import QApplication
        from workbench.views.scene import ready

        sys.path.insert(0, {str(tmp_path)!r})
        ready.SURFACES = "slow_0"
        app = QApplication([])
        ready.readiness()._import("pictures")
        QTimer.singleShot(100, app.quit)
        app.exec()
        print("left")
        """
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=TIMEOUT_S)
    assert (done.returncode, done.stdout, done.stderr) == (0, "left\n", "")


def test_libraries_that_cannot_be_imported_leave_the_program_without_3d(tmp_path, qtbot, monkeypatch, caplog):
    from workbench.views.scene import ready

    (tmp_path / "broken_3d.py").write_text("raise RuntimeError('no driver')\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(ready, "SURFACES", "broken_3d")
    known = ready.Readiness(None)
    with qtbot.waitSignal(known.known):
        known._import("pictures")
    assert known.kind == "none"
    assert "cannot be imported" in caplog.text and "no driver" in caplog.text


def test_an_import_that_was_stopped_halfway_promises_no_3d(tmp_path, qtbot, monkeypatch):
    from workbench.views.scene import ready

    (tmp_path / "slow_3d.py").write_text("import time\ntime.sleep(0.2)\nimport rest_of_3d\n")
    (tmp_path / "rest_of_3d.py").write_text("")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(ready, "SURFACES", "slow_3d")
    known = ready.Readiness(None)
    with qtbot.assertNotEmitted(known.known, wait=1000):
        known._import("pictures")
        known.stop()
    assert known.kind is None
    assert known._thread is None
