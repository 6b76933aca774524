"""A window and a source for live recordings that follow a script: no clock, no camera."""

import pickle
import time
from collections import deque
from pathlib import Path

from core.acquire.source import Capabilities, Ended, Frame, Lasers, SourceChoice, SourceSettings, Unplugged
from core.errors import InputError
from core.files.recording.rig import Rig
from core.pipeline.live import session as live
from core.pipeline.live.commands import LiveRequest
from core.pipeline.live.events import LiveView


class ScriptedSource:
    """Pictures from `picture_of(lasers, number)`, one each `pace_s`; after `frames` that count it has ended.

    Frames count for which `counts(lasers)`; unplugged when the numbers in `unplug_at` would come, and back after `away`
    tries to open it.
    """

    name = "Scripted camera"

    def __init__(self, picture_of, frames=1000, *, switches=True, unplug_at=(), away=1, pace_s=0.002, counts=None):
        self.picture_of, self.frames, self.switches, self.pace_s = picture_of, frames, switches, pace_s
        self.unplug_at, self.away, self.missing = set(unplug_at), away, 0
        self.lit = Lasers(fan=False, hand=False)
        self.number = self.counted = self.since_open = 0
        self.counts = counts or (lambda lasers: True)
        self.is_open = False
        self.calls = []

    @property
    def capabilities(self):
        return Capabilities(exposure_ms=(0.1, 100.0))

    def open(self):
        if self.missing:
            self.missing -= 1
            raise InputError("no such camera", where=self.name)
        self.is_open, self.since_open = True, 0

    def configure(self, settings):
        if settings.gain_db == 80:
            raise InputError("this camera has no gain", where=self.name)
        self.calls.append(settings)

    def prepare(self, step):
        self.calls.append(step)

    def lasers(self, lasers):
        self.calls.append(lasers)
        if self.switches:
            self.lit = lasers
        return self.switches

    def read(self, timeout_s):
        assert self.is_open
        time.sleep(self.pace_s)
        if self.counted in self.unplug_at:
            self.unplug_at.remove(self.counted)
            self.is_open, self.missing = False, self.away
            raise Unplugged("the cable was pulled", where=self.name)
        if self.counted >= self.frames or self.number > 3_000:
            raise Ended
        picture = self.picture_of(self.lit, self.number)
        frame = Frame(picture, self.since_open, self.number / 10, 0)
        self.number += 1
        self.counted += self.counts(self.lit)
        self.since_open += 1
        return frame

    def close(self):
        self.is_open = False


class Window:
    """Hears all events, checks that each can be sent to another process, and answers by rules.

    `rules` are functions of an event that give a command, or None.
    """

    def __init__(self, *rules, ready=True):
        self.rules, self.events, self.commands = rules, [], deque()
        self.ready = ready if callable(ready) else lambda: ready

    def hear(self, event):
        pickle.dumps(event)
        self.events.append(event)
        for rule in self.rules:
            if (answer := rule(event)) is not None:
                self.commands.append(answer)

    def next_command(self):
        return self.commands.popleft() if self.commands else None

    def all(self, kind):
        return [event for event in self.events if isinstance(event, kind)]

    @property
    def details(self):
        return [view.detail for view in self.all(LiveView) if view.detail is not None]


def record(monkeypatch, source, window, step, rig: Rig, folder: Path, **choices):
    """A whole live recording with a scripted source."""
    monkeypatch.setattr(live, "make_source", lambda choice, rig: source)
    monkeypatch.setattr(live, "RETRY_S", 0.05)
    settings = choices.pop("settings", SourceSettings())
    request = LiveRequest(step, SourceChoice("scripted"), settings, rig, folder, **choices)
    pickle.dumps(request)
    return live.run_live(request, window.next_command, window.hear, window.ready)


def answer_to(kind, command):
    """A rule: each event of this kind is answered so."""
    return lambda event: command if isinstance(event, kind) else None


def after(count, kind, command):
    """A rule: the event of this kind that comes as number `count` is answered so."""
    seen = [0]

    def rule(event):
        if isinstance(event, kind):
            seen[0] += 1
            if seen[0] == count:
                return command
        return None

    return rule
