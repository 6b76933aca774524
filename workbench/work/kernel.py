"""The kernel of the Python console seen from the window: its process, and the messages of Jupyter's protocol.

Jupyter's own client for Qt reads its sockets in a Python thread that holds objects of Qt's. Here Qt tells in the GUI
thread when there is something to read, so the window stays without such threads. Of the extra `console`: import late.
"""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import zmq
from jupyter_client.channels import ZMQSocketChannel
from jupyter_client.client import KernelClient
from jupyter_client.connect import write_connection_file
from PySide6.QtCore import QObject, QSocketNotifier, QTimer, Signal
from qtconsole.kernel_mixins import QtKernelClientMixin
from qtconsole.util import SuperQObject
from traitlets import Type

from workbench.work import wire
from workbench.work.process import ChildProcess

TURN_S = 0.01
"""Messages are taken for so long in a row: a flood of them leaves the window its turns."""
PAUSE_MS = 1
"""And so long after that go on: what waits for 0 ms Qt does before anything else."""


class Channel(ZMQSocketChannel, SuperQObject):  # type: ignore[misc]
    """Socket to the kernel that emits each message in the GUI thread."""

    message_received = Signal(object)

    def start(self) -> None:
        """Start listening on the socket to the kernel."""
        self._more = QTimer(self, singleShot=True, interval=PAUSE_MS)
        self._more.timeout.connect(self._read)
        self._notifier = QSocketNotifier(self.socket.getsockopt(zmq.FD), QSocketNotifier.Type.Read, self)
        self._notifier.activated.connect(self._read)
        self._more.start()

    def send(self, message: dict[str, Any]) -> None:
        """Send a Jupyter message to the kernel."""
        super().send(message)
        self._more.start()  # sending may take the notice of an answer with it

    def stop(self) -> None:
        """Stop listening, and close the socket to the kernel."""
        if self.socket is not None:
            self._notifier.setEnabled(False)
            self._more.stop()
            self.close()

    def closed(self) -> bool:
        """Whether the socket to the kernel is closed."""
        return self.socket is None

    def flush(self, timeout: float = 1.0) -> None:
        """Handle all messages of the kernel that have arrived."""
        self._read()

    def _read(self) -> None:
        until = time.perf_counter() + TURN_S
        while self.socket is not None and self.socket.getsockopt(zmq.EVENTS) & zmq.POLLIN:
            if time.perf_counter() > until:
                self._more.start()
                return
            self.message_received.emit(self._recv())


class Heartbeat(SuperQObject):  # type: ignore[misc]
    """Substitute for Jupyter's thread that asks whether the kernel lives: Qt reports the process's end."""

    kernel_died = Signal(object)

    def __init__(self, *_: Any, **__: Any) -> None:
        super().__init__()
        self._alive = False

    def start(self) -> None:
        """Regard the kernel as alive from now on."""
        self._alive = True

    def stop(self) -> None:
        """Regard the kernel as stopped from now on."""
        self._alive = False

    pause = unpause = stop

    def is_alive(self) -> bool:
        """Whether the kernel is regarded as alive: after `start`, before `stop`."""
        return self._alive


class Client(QtKernelClientMixin, KernelClient):  # type: ignore[misc]
    """Client of the kernel for the console's widget."""

    iopub_channel_class = Type(Channel)
    shell_channel_class = Type(Channel)
    stdin_channel_class = Type(Channel)
    control_channel_class = Type(Channel)
    hb_channel_class = Type(Heartbeat)

    def execute(self, code: str, *args: Any, **kwargs: Any) -> str:
        """Send `code` to the kernel to be run, and return the message's id."""
        return str(super().execute(code, *args, **{**kwargs, "stop_on_error": False}))


class Kernel(ChildProcess):
    """Kernel process and the client connected to it: on this computer only, encrypted with keys of its own.

    Parameters
    ----------
    project
        The folder of the project that it has open.
    colours
        What IPython calls those of its messages: "linux" on dark ground, "lightbg" on light.
    """

    def __init__(self, project: Path, colours: str, parent: QObject) -> None:
        self._folder = wire.memory_folder()
        self.client = Client()
        public, secret = zmq.curve_keypair()
        path = str(Path(self._folder.name) / "connection.json")
        file, _ = write_connection_file(path, curve_publickey=public, curve_secretkey=secret)
        self.client.load_connection_file(file)
        super().__init__("workbench.work.console_kernel", [file, str(project), colours], parent)
        self.client.start_channels()

    def interrupt(self) -> None:
        """Interrupt the calculation that the kernel runs."""
        self._process.write(wire.INTERRUPT)

    def end(self) -> None:
        """Close the sockets to the kernel, and kill its process."""
        self._close_sockets()
        super().end()

    def _close_sockets(self) -> None:
        if self.client.channels_running:  # else ZeroMQ would wait for ever, at the end, for messages to be taken
            self.client.stop_channels()

    def _clean_up(self) -> None:
        self._close_sockets()
        self._folder.cleanup()
