"""A live recording from the first frame to the last: read, record, look, show. Runs in a process of its own, no Qt.

Recording comes first: every frame of a scan goes to the disk before anything else is done with it. Looking at frames
is done beside it, by one thread, for as many of them as there is time for. Pictures are shown as fast as the window
shows them and no faster.
"""

from __future__ import annotations

from collections.abc import Callable

from core.errors import InputError
from core.files.atomic import make_folder
from core.files.recording.recorder import Recorder
from core.messages import Message
from core.pipeline.live.camera import LiveCamera
from core.pipeline.live.commands import (
    Command,
    LiveRequest,
)
from core.pipeline.live.context import LiveContext, LiveStep
from core.pipeline.live.events import (
    LiveEnded,
    LiveEvent,
)
from core.pipeline.live.loop import LiveLoop
from core.pipeline.live.planes import LivePlanes
from core.pipeline.live.scan import LiveScan
from core.pipeline.live.sources import make_source


def run_live(
    request: LiveRequest,
    commands: Callable[[], Command | None],
    emit: Callable[[LiveEvent], None],
    ready: Callable[[], bool],
) -> LiveEnded:
    """Record live until told to stop, or until the source is at its end.

    Parameters
    ----------
    request
        What to record, from where, into which folder.
    commands
        The next command, or None.
    emit
        Takes all events but the last, LiveEnded, which is returned.
    ready
        Whether the last LiveView has been shown: if not, there is no other.

    An InputError on the way (no such source, disk full) ends the recording and is told in LiveEnded; what is recorded
    by then is kept.
    """
    try:
        folder = make_folder(request.folder)
        if any(folder.iterdir()):
            raise InputError(
                Message("live.folder_not_empty", "there is something in the folder already"),
                where=folder,
                todo=Message("advice.name_new_folder", "name a new one"),
            )
        source = make_source(request.source, request.rig)
    except InputError as refused:
        return LiveEnded(request.folder, 0, 0, refused.message)
    context = LiveContext(request, source, emit)
    step = _step(context)
    loop = LiveLoop(context, step, commands, ready)
    error = None
    try:
        error = loop.run()
    finally:
        context.worker.close()
        source.close()
        error = _finished(step) or error
        if not any(folder.iterdir()):
            folder.rmdir()
    return LiveEnded(request.folder, context.recorded, loop.dropped, error)


def _finished(step: LiveStep) -> Message | None:
    """Have everything on the disk; what could not be written, or None."""
    try:
        step.finish()
    except InputError as problem:
        return problem.message
    return None


def _step(context: LiveContext) -> LiveStep:
    match context.request.step:
        case "camera":
            return LiveCamera(context)
        case "planes" | "check":
            return LivePlanes(context)
        case "scan":
            return LiveScan(context, Recorder(context.request.folder, ending=context.request.ending))
