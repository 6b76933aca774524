"""The window of the Python console: what is typed runs in a process of its own, which has the project open to be read.

The libraries are those of the extra `console`; they are imported when the window is first opened, one a turn of the
event loop, and hold no Python thread here (see `workbench.work.kernel`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QEvent, Qt, QTimer, Signal
from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import QLabel, QPushButton, QWidget

from workbench.language import tr
from workbench.theme import SOON_MS, is_dark
from workbench.views.layouts import Elided, enable, in_column, in_row, resize_on_screen

if TYPE_CHECKING:
    from workbench.work.kernel import Kernel

SIZE = (900, 640)
"""Width and height of the window at first, in pixels."""

LIBRARIES = (
    "asyncio",
    "tornado.ioloop",
    "zmq.asyncio",
    "traitlets.config",
    "jupyter_client.session",
    "IPython.core.history",
    "IPython.core.interactiveshell",
    "IPython.core.inputtransformer2",
    "qtconsole.console_widget",
    "qtconsole.rich_jupyter_widget",
    "workbench.work.kernel",
)
"""What is imported one after another: none of them takes the window longer than a tenth of a second."""

OPEN_ANEW = "project = project.opened_again()"


def console_missing() -> bool:
    """Whether the optional packages of the console (the extra `console`) are not installed."""
    return find_spec("qtconsole") is None


class ConsoleWindow(QWidget):
    """Window with the console of one project.

    Parameters
    ----------
    folder
        Of the project.
    save
        Puts on the disk what is to be read.
    """

    ended = Signal()
    """The window has been closed, and its process is ended."""

    kernel: Kernel | None = None
    console: Any = None
    """The widget of qtconsole's; None until it is imported."""

    def __init__(self, folder: Path, save: Callable[[], object], parent: QWidget) -> None:
        super().__init__(parent, Qt.WindowType.Window)
        self.setWindowTitle(tr("Python console: {project}", project=folder.name))
        resize_on_screen(self, *SIZE)
        self._folder, self._save = folder, save
        self._running, self._outdated, self._why_ended = 0, False, ""
        self._imports = iter(LIBRARIES)
        self._next = QTimer(self, singleShot=True, interval=SOON_MS)
        self._next.timeout.connect(self._import)
        self.state, self._place = Elided(), QLabel(tr("The console starts …"))
        self._place.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self.anew, self.interrupt, self.restart = (
            QPushButton(text) for text in (tr("Open anew"), tr("Stop"), tr("Restart"))
        )
        self.anew.clicked.connect(self._open_anew)
        self.interrupt.clicked.connect(self._interrupt)
        self.restart.clicked.connect(self._restart)
        row = in_row((self.state, 1), self.anew, self.interrupt, self.restart, margins=(8, 4, 8, 4))
        self._column = in_column(row, (self._place, 1), on=self, spacing=0)
        self._show_state()

    def begin(self) -> None:
        """Show the console window in front; its kernel is started the first time."""
        self.show()
        self.raise_()
        self.activateWindow()
        if self.console is None:
            self._next.start()

    def set_outdated(self, outdated: bool) -> None:
        """Show, or hide, that the project has changed since the console opened it."""
        self._outdated = outdated
        self._show_state()

    def end(self) -> None:
        """End the kernel's process and close the console window."""
        self._next.stop()
        kernel, self.kernel = self.kernel, None
        if kernel is not None:
            self.console.kernel_client = None
            kernel.end()
        self.hide()
        self.deleteLater()
        self.ended.emit()

    def closeEvent(self, event: QCloseEvent) -> None:
        super().closeEvent(event)
        self.end()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and self.console is not None:
            self._take_colours()

    def _take_colours(self) -> None:
        self.console.set_default_style(_colours())

    def _import(self) -> None:
        name = next(self._imports, "")
        if name:
            import_module(name)
            self._next.start()
            return
        from qtconsole.rich_jupyter_widget import RichJupyterWidget

        console = self.console = RichJupyterWidget(custom_interrupt=True, custom_restart=True)
        console.banner = tr(
            "project: what lies on the disk of this project, to be read (its camera, planes, cloud, mesh, gauge, "
            "inspection, characteristics, settings). np: NumPy. open_project(folder) opens another one.\n"
        )
        console.executing.connect(self._begun)
        console.executed.connect(self._done)
        console.custom_interrupt_requested.connect(self._interrupt)
        console.custom_restart_requested.connect(self._restart)
        for own in (console._completion_widget, console._call_tip_widget):
            own.setParent(
                console, own.windowFlags()
            )  # else it would go when garbage is collected, be it while Qt paints
        self._column.replaceWidget(self._place, console)
        self._place.deleteLater()
        self._take_colours()
        self._start()

    def _start(self) -> None:
        from workbench.work.kernel import Kernel

        self._save()
        self.kernel = Kernel(self._folder, _colours(), self.parent() or self)
        self.kernel.gone.connect(self._gone)
        self._running, self._why_ended = 0, ""
        self.console.setEnabled(False)
        self.console.kernel_client = self.kernel.client
        self.kernel.client.shell_channel.message_received.connect(self._answered)
        self.set_outdated(False)

    def _answered(self, message: Mapping[str, Any]) -> None:
        """The first command was for the number of the prompt: from now on it can be typed into."""
        if message["msg_type"] == "execute_reply" and not self.console.isEnabled():
            self.console.setEnabled(True)
            self.console.setFocus()
            self._show_state()

    def _restart(self) -> None:
        if self.kernel is not None:
            self.kernel.end()
        self._start()

    def _gone(self, why: str) -> None:
        self.console.kernel_client = None
        self.kernel, self._why_ended, self._running = None, why, 0
        self.console.setEnabled(False)
        self._show_state()

    def _interrupt(self) -> None:
        if self.kernel is not None:
            self.kernel.interrupt()

    def _open_anew(self) -> None:
        self._save()
        self.set_outdated(False)
        self.console.execute(OPEN_ANEW)

    def _begun(self, *_: Any) -> None:
        self._running += 1  # the next may begin before the answer to the one before has come
        self._show_state()

    def _done(self, *_: Any) -> None:
        self._running = max(self._running - 1, 0)
        self._show_state()

    def _show_state(self) -> None:
        ready = self.console is not None and (self.console.isEnabled() or self._why_ended)
        starts = "" if ready else tr("The console starts …")
        if self._why_ended:
            self.state.setText(
                tr("The console's process has ended ({why}); Restart starts another.", why=self._why_ended)
            )
        elif starts:
            self.state.setText(starts)
        elif self._outdated:
            self.state.setText(tr("The project has changed since it was opened here."))
        else:
            self.state.setText(tr("What is read here is what is on the disk; nothing is written to the project."))
        idle = tr("Nothing is being calculated.")
        ended = tr("The console's process has ended.") if self._why_ended else ""
        busy = tr("Wait for the calculation, or stop it.") if self._running else ""
        same = "" if self._outdated else tr("The project has not changed since it was opened here.")
        enable(self.anew, starts or ended or same or busy, tr("Read the project as it is on the disk now"))
        enable(self.interrupt, starts or ended or ("" if self._running else idle), tr("Stop the calculation"))
        enable(self.restart, starts, tr("End the console's process and start another; its variables are lost"))


def _colours() -> str:
    """What IPython calls the colours for the theme in use."""
    return "linux" if is_dark() else "lightbg"
