"""`trisect record`: a part of a recording set from a camera, told on standard error and steered by Enter and Ctrl-C."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from queue import Empty, SimpleQueue

from rich.table import Table

from core.acquire.settings import SourceSettings
from core.acquire.source import SourceChoice, Step
from core.cli import output
from core.cli.interrupts import Interrupts, interruptible
from core.cli.language import text_of, tr
from core.cli.talk import print_always, print_line
from core.errors import InputError
from core.files.recording.recorder import Ending
from core.files.recording.recording_set import boards_beside
from core.files.recording.rig import read_rig, require_tables
from core.files.results.camera_file import read_camera
from core.files.step_graph import FILES
from core.messages import Message, plural_message, visible
from core.pipeline.live.commands import Capture, Command, LiveRequest, Stop
from core.pipeline.live.events import (
    CameraDetail,
    LiveAdvice,
    LiveAnswered,
    LiveAsk,
    LiveBack,
    LiveChecks,
    LiveEnded,
    LiveEvent,
    LiveNotice,
    LiveSaving,
    LiveStarted,
    LiveTaken,
    LiveUnplugged,
    LiveView,
    PlanesDetail,
    ScanDetail,
)
from core.pipeline.live.session import run_live
from core.pipeline.live.sources import SOURCES, list_sources, missing_driver
from core.pipeline.steps.workspace import read_calibration

STATUS_S = 5.0
"""No more often in s a scan tells how many frames it has, or what would expose stripes better."""

_TABLES = {
    "camera": ("camera_target",),
    "planes": ("laser_fan", "plane_target"),
    "check": ("laser_fan", "plane_target"),
    "scan": (),
}
"""Tables of rig.toml that a part needs."""


def request(
    folder: Path, step: Step, choice: SourceChoice, calibrations: Path | None, settings: SourceSettings, ending: Ending
) -> LiveRequest:
    """Make the request to record the part `step` of a recording set; `calibrations` is a folder of results or None.

    Raises
    ------
    core.errors.InputError
        If rig.toml or a calibration cannot be read, or the rig does not state the target, or the fan, of that part.
    """
    file = folder / "rig.toml"
    rig = read_rig(file)
    require_tables(rig, file, *_TABLES[step])
    camera = fan = None
    if calibrations is not None and step in ("scan", "check"):
        known = read_calibration(calibrations, has_fan=rig.has_fan)
        camera, fan = known.camera.camera, known.fan.fan
    elif calibrations is not None:
        camera = read_camera(calibrations / FILES["camera"]).camera
    boards = boards_beside(rig, plate=False) if step == "scan" else ()
    return LiveRequest(
        step, choice, settings, rig, folder / step, camera, fan, display_px=320, ending=ending, boards=boards
    )


class Recording:
    """Recording on a terminal: its messages, its questions to the user, and its end.

    Parameters
    ----------
    step
        What is recorded.
    pictures, seconds
        It ends after so many pictures, or so many s of a scan; where both are None, when nothing is missing (poses and
        views) or by Ctrl-C.
    by_itself
        What a person is asked to do counts as done at once, and nobody listens to keys.
    """

    def __init__(self, step: Step, pictures: int | None, seconds: float | None, *, by_itself: bool) -> None:
        self._step, self._pictures, self._seconds, self._by_itself = step, pictures, seconds, by_itself
        self._commands: deque[Command] = deque()
        self._keys: SimpleQueue[bool] = SimpleQueue()
        self._asked: LiveAsk | None = None
        self._stopping = self._is_enough = False
        self._began_s: float | None = None
        self._told_s = self._advised_s = -STATUS_S
        self._missing: tuple[Message, ...] = ()

    def run(self, wanted: LiveRequest) -> LiveEnded:
        """Record as requested until the end, Ctrl-C or SIGTERM; pictures recorded by then are kept."""
        with interruptible() as interrupts, self._ended_by(interrupts):
            if not self._by_itself:
                threading.Thread(target=self._listen, name="keys", daemon=True).start()
            return run_live(wanted, self._next, self._hear, lambda: True)

    @contextmanager
    def _ended_by(self, interrupts: Interrupts) -> Iterator[None]:
        """The first signal ends the recording in order, a second Ctrl-C gives the command up.

        Ctrl-C is the usual end of a recording; after any other one the command was interrupted.
        """

        def end(signum: int) -> bool:
            if self._stopping and signum == signal.SIGINT:
                return False
            self._stopping = True
            return True

        interrupts.in_order = end
        try:
            yield
        finally:
            interrupts.in_order = None

    def _listen(self) -> None:
        """Pass on Enter as True and the end of standard input as False; past Python's buffer, whose lock would stay."""
        while got := os.read(0, 4096):
            for _ in range(got.count(b"\n")):
                self._keys.put(True)
        self._keys.put(False)

    def _next(self) -> Command | None:
        if self._commands:
            return self._commands.popleft()
        if self._stopping or self._is_enough or self._is_over():
            return Stop()
        if self._asked is None and self._step == "scan":
            return None  # a key that is pressed too soon waits
        try:
            pressed = self._keys.get_nowait()
        except Empty:
            return None
        if pressed:
            return Capture() if self._asked is None else self._asked.answer
        self._keys.put(False)
        if self._asked is None:
            return None
        raise InputError(
            Message("live.nobody_answers", "somebody is asked to do something, and standard input has ended"),
            where=tr(self._step),
            todo=Message("advice.answer_by_itself", "give --yes if that counts as done at once"),
        )

    def _is_over(self) -> bool:
        began = self._began_s
        return began is not None and self._seconds is not None and time.monotonic() - began >= self._seconds

    def _hear(self, event: LiveEvent) -> None:
        match event:
            case LiveStarted(name, (width, height)):
                print_line(tr("{name}: {width} × {height} pixels", name=text_of(name), width=width, height=height))
            case LiveView():
                self._judge(event)
            case LiveTaken(name):
                print_line(tr("{name} taken", name=name))
            case LiveAsk(sentence, button, answer) if self._by_itself:
                print_line(text_of(sentence))
                self._commands.append(answer)
            case LiveAsk(sentence, button):
                self._asked = event
                print_always(tr("{sentence} Enter: {button}", sentence=text_of(sentence), button=tr(button)))
            case LiveAnswered():
                self._asked = None
            case LiveAdvice(Message() as sentence):
                if time.monotonic() - self._advised_s >= STATUS_S:
                    self._advised_s = time.monotonic()
                    print_line(text_of(sentence))
            case LiveNotice(sentence) | LiveUnplugged(sentence):
                print_line(text_of(sentence))
            case LiveBack():
                print_line(tr("The source is there again."))
            case LiveChecks(checks):
                for check in checks:
                    if check.state == "failed":
                        print_line(text_of(check.message))
            case LiveSaving(waiting) if waiting:
                print_line(text_of(_saving(waiting)))

    def _judge(self, view: LiveView) -> None:
        """See whether it is enough, and tell what is missing or how far a scan is."""
        if self._pictures is not None and view.recorded >= self._pictures:
            self._is_enough = True
        match view.detail:
            case ScanDetail(stage="scanning") as detail:
                now = time.monotonic()
                self._began_s = now if self._began_s is None else self._began_s
                if now - self._told_s >= STATUS_S:
                    self._told_s = now
                    print_line(_status(view, detail))
            case CameraDetail(missing=missing) | PlanesDetail(missing=missing) if self._step != "check":
                if missing != self._missing:
                    self._missing = missing
                    for sentence in missing:
                        print_line(text_of(sentence))
                if not missing and view.recorded and self._pictures is None:
                    self._is_enough = True


def show(ended: LiveEnded, *, as_json: bool) -> None:
    """Print how many pictures were recorded and lost, and where; with `as_json`, as one JSON object.

    Raises
    ------
    core.errors.InputError
        If the recording ended too early; what was recorded by then is kept.
    """
    if as_json and ended.error is None:
        output.print_json({"folder": str(ended.folder), "pictures": ended.recorded, "lost": ended.dropped})
    elif ended.recorded and not as_json:
        output.print_rows(
            [
                (tr("recorded"), str(ended.recorded)),
                (tr("lost"), str(ended.dropped)),
                (tr("written"), str(ended.folder)),
            ]
        )
    if ended.error is not None:
        raise InputError(ended.error)


def show_sources(*, as_json: bool) -> None:
    """Print the cameras and other sources that can be recorded from, and what to install for the others."""
    rows: list[tuple[str, Message | str, str]] = []
    for name, source in SOURCES.items():
        rows.append((name, missing_driver(name) or source.title, ""))
        rows += [(name, one.name, one.choice.id) for one in list_sources(name)]
    if as_json:
        values = [{"source": kind, "name": str(called), "device": device} for kind, called, device in rows]
        output.print_json({"sources": values})
        return
    table = Table("--source", tr("name"), "--device", box=None, padding=(0, 2, 0, 0))
    for kind, called, device in rows:
        table.add_row(kind, visible(text_of(called)), visible(device))
    output.console().print(table)


def _saving(waiting: int) -> Message:
    return plural_message("live.saving", "{n} frame waits for the disk", "{n} frames wait for the disk", n=waiting)


def _status(view: LiveView, detail: ScanDetail) -> str:
    told_of = tr(
        "{frames} frames, {rate:.1f} a second, {lost} lost",
        frames=view.recorded, rate=view.rate_hz, lost=view.dropped,
    )  # fmt: skip
    if not detail.cells.any():  # without calibrations nothing is measured
        return told_of
    return f"{told_of}; {tr('{share:.0%} of what was lit is measured', share=detail.share)}"
