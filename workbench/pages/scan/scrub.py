"""Going through the frames of a recording: which one is looked at, and what every stage makes of it."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QObject, Signal

from core.scan.preview.shown import FrameStages
from workbench.bench import Bench
from workbench.language import text_of, tr
from workbench.pages.scan.work import ScanWork
from workbench.work import jobs


class FrameScrub(QObject):
    """Current frame of the recording and its stages.

    Frames are looked at only while somebody wants to see them (`active`); while they are gone through fast, those in
    between are passed over. `stages` stand until those of the next frame are there: `current` may be ahead of them.
    """

    changed = Signal()

    def __init__(self, bench: Bench, work: ScanWork, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._bench, self._model, self._work = bench, bench.model, work
        self._active = False
        self.forget()

    def forget(self) -> None:
        """Drop the current frame and its stages, as another recording is used."""
        self.current, self.problem = "", ""
        self._chosen = False
        self.stages: FrameStages | None = None
        self._wanted: tuple[Any, ...] = ()

    @property
    def index(self) -> int:
        """Index of the current frame in the recording; −1 if there is none."""
        names = self._work.names
        return names.index(self.current) if self.current in names else -1

    @property
    def up_to_date(self) -> bool:
        """Whether the stages that are known are those of the current frame."""
        return self.stages is not None and self.stages.name == self.current

    def set_active(self, active: bool) -> None:
        """Set whether frames are shown now, so that their stages have to be computed."""
        self._active = active
        self.follow()

    def choose(self, name: str) -> None:
        """Make the frame called `name` the current one."""
        if name in self._work.names and name != self.current:
            self.current, self._chosen = name, True
            self.follow()
            self.changed.emit()

    def go_to(self, index: int) -> None:
        """Make the frame with this index the current one."""
        names = self._work.names
        if names:
            self.choose(names[min(max(index, 0), len(names) - 1)])

    def step(self, by: int) -> None:
        """Move `by` frames forward, or backward if negative."""
        self.go_to(self.index + by)

    def follow(self) -> None:
        """Compute the current frame's stages again, as frames or calibrations have changed."""
        names = self._work.names
        if self.current not in names:
            self.forget()
        if not self._chosen:
            self.current = self._telling()
        wanted = self._key()
        if not self._active or not self.current or wanted == self._wanted:
            return
        self._wanted = wanted
        self._bench.quick.run(
            self,
            jobs.SHOW_FRAME,
            self._model.folder,
            self._model.project,
            self.current,
            label=tr("Looking at a frame"),
            on_done=lambda stages: self._seen(wanted, stages, ""),
            on_failed=lambda problem: self._seen(wanted, None, text_of(problem)),
            replace_waiting=True,
        )

    def _telling(self) -> str:
        """The frame to begin with: the one that meets most of the fan, as far as that is known; else the middle one."""
        names, records = self._work.names, self._work.records()
        used = [records[name] for name in names if name in records and records[name].used]
        if not used:
            return names[len(names) // 2] if names else ""
        return max(used, key=lambda frame: (frame.fan_lines_met, frame.fan_crossings, frame.points)).name

    def _seen(self, wanted: tuple[Any, ...], stages: FrameStages | None, problem: str) -> None:
        if wanted[1:] == self._wanted[1:]:  # of this recording; also those passed on the way are shown
            self.stages, self.problem = stages, problem if wanted == self._wanted else ""
            self.changed.emit()

    def _key(self) -> tuple[Any, ...]:
        """What the stages rest on, the frame first."""
        project, done = self._model.project, self._model.results.get("scan")
        options = project.options
        return (
            self.current,
            self._model.folder,
            project.sources.scan,
            project.rig.channel_of("scan"),
            project.accepted,
            options.stripe,
            options.excluded_in("scan"),
            done.key if done is not None else "",
        )
