"""The program: arguments, theme, messages, the window.

What the window is made of takes a second or more to import, so it is imported once something is on the screen.
"""

from __future__ import annotations

import argparse
import gc
import os
import signal
import socket
import sys
from collections.abc import Callable, Sequence
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from PySide6.QtCore import QCoreApplication, QEvent, QLocale, QSocketNotifier, QTimer
from PySide6.QtGui import QFileOpenEvent, QIcon
from PySide6.QtWidgets import QApplication

from core import __version__
from core.code_cache import code_cache, note_on_cache, remove_temporary_cache
from core.errors import InputError
from core.held_files import PATIENCE_S
from core.sources import brings_code
from core.translations import PSEUDO, language, languages, preferred
from workbench.language import choose, text_of, tr
from workbench.no_display import told_without_display
from workbench.settings import THEMES, AppSettings
from workbench.theme import apply_colours, apply_sheet, take_sheet_off
from workbench.views.splash import Splash

if TYPE_CHECKING:
    from workbench.bench import Bench
    from workbench.main_window import MainWindow
    from workbench.pages.project.double_click import Outcome

WINDOW_PATIENCE_S = 0.2
"""How long in s the window waits for a file that another program holds: more would be seen as a standstill."""


class Application(QApplication):
    """Application that also opens files from the system (a double click on macOS arrives as an event)."""

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
            self.window.projects.open_dropped(Path(event.file()))
            return True
        return super().event(event)


def build_window(app: QApplication, bench: Bench, theme: str = "") -> MainWindow:
    """Apply the theme to the application and build its main window, which is not shown yet.

    The style sheet comes last: under one, Qt looks up the rules of all widgets anew each time a part is put into
    another, which takes longer than all the rest.
    """
    from workbench.main_window import MainWindow

    apply_colours(app, theme or bench.settings.theme)
    window = MainWindow(bench)
    apply_sheet(app)
    bench.settings.theme_changed.connect(window.apply_theme)
    app.styleHints().colorSchemeChanged.connect(window.follow_system)
    return window


def speak(app: QApplication, window: MainWindow, name: str, put: Callable[[], MainWindow]) -> None:
    """Replace the window by one in the language `name` at the same step; `put` builds and shows the new window.

    All texts are told when a widget is made, so it is the widgets that are made anew; project, undo, processes and
    messages are not the window's and stay.
    """
    step, quits = window.current, app.quitOnLastWindowClosed()
    app.setQuitOnLastWindowClosed(False)
    window.dismiss()

    def go_on() -> None:
        choose(language(name), app)
        take_sheet_off(app)  # see `build_window`
        new = put()
        new.model.opened.emit()
        if step:
            new.go_to(step)
        app.setQuitOnLastWindowClosed(quits)

    QTimer.singleShot(0, app, go_on)  # when the old one is gone


def main(argv: Sequence[str] | None = None) -> int:
    """Open the window as the command line `argv` asks (None: the program's own); return the exit code."""
    parser = argparse.ArgumentParser("trisect-workbench", description=tr("The Trisect inspection workbench."))
    parser.add_argument("path", nargs="?", type=Path, help=tr("a project or a recording set to open"))
    parser.add_argument("--theme", choices=THEMES, default="", help=tr("light, dark, or as the system is set"))
    parser.add_argument("--language", choices=(*languages(), PSEUDO), default="", help=tr("of the window's texts"))
    parser.add_argument("--version", action="version", version=f"trisect {__version__}")
    parser.add_argument(
        "--install-desktop", action="store_true", help=tr("have projects open by double click for this user, and end")
    )
    parser.add_argument("--uninstall-desktop", action="store_true", help=tr("take that back, and end"))
    given = parser.parse_args(argv)
    if given.install_desktop or given.uninstall_desktop:
        from workbench.pages.project import double_click

        return _associate(double_click.install if given.install_desktop else double_click.uninstall)
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C in the terminal ends it like a crash: the autosave is there
    PATIENCE_S.set(WINDOW_PATIENCE_S)
    by_surroundings = (os.environ.get("TRISECT_LANGUAGE", ""), QLocale.system().name())
    with told_without_display(lambda why: language(preferred((given.language, *by_surroundings)))(why)):
        app = Application(sys.argv[:1])
    settings = AppSettings()
    apply_colours(app, given.theme or settings.theme)
    splash = Splash(app.windowIcon(), app.applicationDisplayName())
    from workbench.bench import make_bench
    from workbench.notices import log_to_file

    log_file = log_to_file()
    bench = make_bench(settings)
    choose(language(preferred((given.language, bench.settings.language, *by_surroundings))), app)
    bench.notices.catch_everything()
    code_cache()  # of all its processes: they find here which one it is
    if (note := note_on_cache()) is not None:
        remove_cache_before_signals_end(app)
        if not brings_code():
            bench.notices.warning(text_of(note))

    def put() -> MainWindow:
        made = app.window = build_window(app, bench, given.theme)
        made.log_file = log_file
        made.language_wanted.connect(lambda name: speak(app, made, name, put))
        made.show()
        return made

    window = put()
    splash.finish()
    gc.freeze()  # what is there now stays: later collections need not go through it, and are short
    QTimer.singleShot(0, window, lambda: _after_start(window, given.path))
    try:
        return app.exec()
    finally:
        bench.close()
        bench.wait_until_closed()
        bench.notices.release()


def remove_cache_before_signals_end(app: QCoreApplication) -> None:
    """Install signal handlers that remove the temporary folder of compiled code before the program ends.

    Python hears of a signal once it runs: a socket wakes it where Qt waits.
    """

    def end(signum: int, _: object) -> None:
        remove_temporary_cache()
        signal.signal(signum, signal.SIG_DFL)
        signal.raise_signal(signum)

    heard, told = socket.socketpair()
    told.setblocking(False)
    awake = QSocketNotifier(heard.fileno(), QSocketNotifier.Type.Read, app)
    awake.activated.connect(lambda: heard.recv(1))
    signal.set_wakeup_fd(told.detach())
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):
        one = getattr(signal, name, None)
        if one is not None and signal.getsignal(one) is not signal.SIG_IGN:
            signal.signal(one, end)


def _associate(do: Callable[[], Outcome]) -> int:
    """Tell the system what opens projects, and say on the terminal what was done."""
    try:
        outcome = do()
    except InputError as error:
        _say(sys.stderr, text_of(error))
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
        window.projects.open_dropped(path)
    from workbench.views.scene import view as scene_view

    window.bench.measuring.prepare()
    window.bench.quick.prepare()
    scene_view.prepare_3d()


if __name__ == "__main__":
    sys.exit(main())
