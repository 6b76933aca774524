"""The live loop as a job of a lane. Runs in the lane's process; knows nothing of Qt."""

from __future__ import annotations

from core.pipeline.live import LiveEnded, LiveEvent, LiveRequest, LiveView, run_live
from workbench.worker import Channel


def run_live_job(request: LiveRequest, channel: Channel) -> LiveEnded:
    """Run the live loop until the window says Stop; pictures are sent only as fast as the window shows them."""

    def emit(event: LiveEvent) -> None:
        if isinstance(event, LiveView):
            channel.offer(event)
        else:
            channel.emit(event)

    return run_live(request, channel.command, emit, channel.ready)
