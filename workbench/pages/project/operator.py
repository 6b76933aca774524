"""Operator mode: one part after the other with four buttons; plan, limits and settings cannot be changed in it."""

from __future__ import annotations

from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from PySide6.QtCore import QObject, Signal

from core.files.project.keys import left_to_do
from workbench.bench import Bench
from workbench.language import tr
from workbench.pages.sources import put_source
from workbench.pages.whole import MeasuringAll
from workbench.step_state import State
from workbench.work import jobs

if TYPE_CHECKING:
    from core.inspect.characteristic import Characteristic
    from core.inspect.result_list import ResultList
    from core.pipeline.project.placing import Placing


class Stage(StrEnum):
    """Stage of the part."""

    PICTURES = "pictures"
    """Its pictures are to be chosen."""
    READY = "ready"
    MEASURING = "measuring"
    STOPPED = "stopped"
    DONE = "done"


@dataclass(frozen=True, slots=True)
class OperatorFacts:
    """Facts from which the stage and the four buttons follow."""

    pictures: bool
    """Pictures of a scan are chosen."""
    left: AbstractSet[str]
    """The steps that are not up to date."""
    running: bool
    """The part is being measured."""
    busy: bool
    """Something else runs: a long job, a live source, a recording."""
    stopped: str
    """Why the last attempt ended before the report, or ""."""
    report: bool
    """There is a report, of this or of an earlier state."""
    cannot_measure: str
    """Why *Measure everything* cannot be done, or ""."""
    read_only: str
    """Why nothing can be written into the project, or ""."""


class OperatorButtons(NamedTuple):
    """Reason for each disabled button, or ""."""

    next_part: str
    measure: str
    report: str
    stop: str


def stage_of(facts: OperatorFacts) -> Stage:
    """Derive how far the part is in operator mode (`Stage`) from the states of its steps."""
    if facts.running:
        return Stage.MEASURING
    if "scan" in facts.left and not facts.pictures:
        return Stage.PICTURES
    if facts.stopped:
        return Stage.STOPPED
    return Stage.READY if facts.left else Stage.DONE


def operator_buttons(facts: OperatorFacts) -> OperatorButtons:
    """Derive why each of the four buttons is disabled; "" for each that is enabled."""
    stage = stage_of(facts)
    runs = tr("The part is being measured.") if facts.running else ""
    busy = runs or (tr("Wait until what is running has ended.") if facts.busy else "")
    measure = facts.read_only if stage is Stage.PICTURES else facts.cannot_measure
    return OperatorButtons(
        next_part=busy,
        measure=busy or measure,
        report=runs or ("" if facts.report else tr("There is no report yet: measure the part.")),
        stop="" if facts.running or facts.busy else tr("Nothing is running."),
    )


class OperatorMode(QObject):
    """Operator mode: whether it is on, the stage of the open project's part, and its result."""

    changed = Signal()

    def __init__(self, bench: Bench, whole: MeasuringAll) -> None:
        super().__init__()
        self._bench, self._model, self._whole = bench, bench.model, whole
        self.on = False
        self.found: ResultList | None = None
        self.placing: Placing | None = None
        """Where the part lay, or while it is not measured the one before it under the same rig."""
        self._placed_under = ""
        self._asked: tuple[object, ...] = ()
        whole.changed.connect(self.changed)
        self._model.results_changed.connect(self.look)
        self._model.opened.connect(self.look)
        for lane in (bench.measuring, bench.live):
            lane.task_started.connect(self._task)
            lane.task_ended.connect(self._task)

    @property
    def facts(self) -> OperatorFacts:
        """Present state of the project from which stage and buttons of the operator mode are derived."""
        model, report = self._model, self._model.states["report"].state
        return OperatorFacts(
            pictures=bool(model.project.sources.scan),
            left=frozenset(left_to_do(model.project, model.results)),
            running=self._whole.running,
            busy=self._bench.measuring.busy or self._bench.live.busy or model.is_recording,
            stopped=self._whole.why_stopped,
            report=report in (State.DONE, State.OUTDATED),
            cannot_measure=self._whole.cannot_start,
            read_only=self._bench.cannot_write,
        )

    @property
    def stage(self) -> Stage:
        """How far the part is: pictures missing, ready, measuring, stopped or done."""
        return stage_of(self.facts)

    @property
    def buttons(self) -> OperatorButtons:
        """Reason why each of the four buttons is disabled; "" if it is enabled."""
        return operator_buttons(self.facts)

    @property
    def worst(self) -> Characteristic | None:
        """Characteristic with the worst verdict, which the page shows large; None without results."""
        return next(iter(self.found.worst_first), None) if self.found is not None else None

    def turn(self, on: bool) -> None:
        """Switch the operator mode on or off."""
        self.on = on
        self.look()

    def take_pictures(self, folder: Path) -> None:
        """Use the pictures in `folder` as the scan of the part, and measure it."""
        put_source(self._model, "scan", folder, tr("pictures of the scan"))
        self.measure()

    def measure(self) -> None:
        """Do every step that is not up to date, from the camera to the report, in the background."""
        self._whole.start()

    def look(self) -> None:
        """Read the results of the part in the background, if there are newer ones."""
        folder, results = self._model.folder, self._model.results
        asked = (folder, *((step, done.key, done.at) for step, done in sorted(results.items())))
        if self._model.is_open and self._model.project.accepted.planes != self._placed_under:
            self.placing = None
        if folder is None or not self.on or "scan" not in results:
            self.found, self._asked = None, ()
        elif asked != self._asked:
            self.found, self._asked = None, asked
            self._bench.run_quick(
                self,
                jobs.LISTED_RESULTS,
                folder,
                label=tr("Reading the results"),
                on_done=lambda found: self._take(asked, found),
                replace_waiting=True,
            )
            self._bench.run_quick(
                self,
                jobs.PLACING,
                folder,
                self._model.project,
                label=tr("Reading the results"),
                on_done=lambda placing: self._place(asked, placing),
                replace_waiting=True,
            )
        self.changed.emit()

    def _task(self, _: object) -> None:
        self.changed.emit()

    def _place(self, asked: tuple[object, ...], placing: Any) -> None:
        if asked == self._asked:
            self.placing, self._placed_under = placing, self._model.project.accepted.planes
            self.changed.emit()

    def _take(self, asked: tuple[object, ...], found: Any) -> None:
        if asked == self._asked:
            self.found = found
            self.changed.emit()
