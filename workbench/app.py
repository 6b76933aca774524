"""The program: arguments, theme, messages, the window."""

from __future__ import annotations

import argparse
import signal
import sys
from collections.abc import Callable, Sequence
from importlib.resources import files
from pathlib import Path
from typing import TextIO

from PySide6.QtCore import QEvent, QLocale, QTimer, QTranslator
from PySide6.QtGui import QFileOpenEvent, QIcon
from PySide6.QtWidgets import QApplication

from core import __version__
from core.errors import InputError
from workbench import association
from workbench.bench import Bench, make_bench
from workbench.garbage import GarbageCollector
from workbench.main_window import MainWindow
from workbench.notices import log_to_file
from workbench.processes import share_python_willingly
from workbench.settings import THEMES
from workbench.theme import apply_colours, apply_sheet, apply_theme
from workbench.views import scene_view


class Application(QApplication):
    """Opens what the system hands over, too (a double click on macOS arrives as an event)."""

    def __init__(self, argv: list[str]) -> None:
        super().__init__(argv)
        self.setApplicationName("trisect")
        self.setApplicationDisplayName("Trisect")
        self.setApplicationVersion(__version__)
        self.setDesktopFileName("trisect")
        self.setWindowIcon(QIcon(str(files("resources") / "icons" / "trisect.svg")))
        self.window: MainWindow | None = None

    def event(self, event: QEvent) -> bool:
        if isinstance(event, QFileOpenEvent) and self.window is not None:
            self.window.doors.open_dropped(Path(event.file()))
            return True
        return super().event(event)


def build_window(app: QApplication, bench: Bench, theme: str = "") -> MainWindow:
    """Dress the application and build its window, not yet shown.

    The style sheet comes last: under one, Qt looks up the rules of all widgets anew each time a part is put into
    another, which takes longer than all the rest.
    """
    apply_colours(app, theme or bench.settings.theme)
    window = MainWindow(bench)
    apply_sheet(app)
    bench.settings.theme_changed.connect(lambda name: apply_theme(app, name))
    app.styleHints().colorSchemeChanged.connect(lambda _: apply_theme(app, bench.settings.theme))
    return window


def main(argv: Sequence[str] | None = None) -> int:
    """Open the workbench; returns the exit code."""
    parser = argparse.ArgumentParser("trisect-workbench", description="The Trisect inspection workbench.")
    parser.add_argument("path", nargs="?", type=Path, help="a project or a recording set to open")
    parser.add_argument("--theme", choices=THEMES, default="", help="light, dark, or as the system is set")
    parser.add_argument("--version", action="version", version=f"trisect {__version__}")
    parser.add_argument(
        "--install-desktop", action="store_true", help="have projects open by double click for this user, and end"
    )
    parser.add_argument("--uninstall-desktop", action="store_true", help="take that back, and end")
    given = parser.parse_args(argv)
    if given.install_desktop or given.uninstall_desktop:
        return _associate(association.install if given.install_desktop else association.uninstall)
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C in the terminal ends it like a crash: the autosave is there
    share_python_willingly()
    app = Application(sys.argv[:1])
    garbage = GarbageCollector(app)
    translator = QTranslator()
    if translator.load(QLocale(), "trisect", "_", str(files("resources") / "translations")):
        app.installTranslator(translator)
    log_file = log_to_file()
    bench = make_bench()
    bench.notices.catch_everything()
    window = app.window = build_window(app, bench, given.theme)
    window.log_file = log_file
    window.show()
    garbage.spare_what_is_there()
    QTimer.singleShot(0, lambda: _after_start(window, given.path))
    try:
        return app.exec()
    finally:
        bench.close()
        garbage.stop()
        bench.notices.release()


def _associate(do: Callable[[], association.Outcome]) -> int:
    """Tell the system what opens projects, and say on the terminal what was done."""
    try:
        outcome = do()
    except InputError as error:
        _say(sys.stderr, str(error))
        return 2
    _say(sys.stdout, outcome.sentence, *map(str, outcome.files))
    return 0


def _say(stream: TextIO | None, *lines: str) -> None:
    """On the terminal, if there is one: a program with a window may have none."""
    if stream is not None:
        stream.write("\n".join(lines) + "\n")


def _after_start(window: MainWindow, path: Path | None) -> None:
    """Once the window is there: open what was asked for, start the processes, import what the 3D view needs."""
    if path is not None:
        window.doors.open_dropped(path)
    window.bench.measuring.warm_up()
    window.bench.quick.warm_up()
    scene_view.warm_up()


if __name__ == "__main__":
    sys.exit(main())
