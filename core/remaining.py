"""How much of a job is left, from what its stages usually take.

Jobs report stages one after another, and how long the later ones take is not in any of them. So each stage's usual time
is known, from the sample or from the last run of the same job, and stretched by how those done so far compare with it.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from types import MappingProxyType

from core.files.step_graph import GRAPH, IN_PROJECT

_STAGES: Mapping[str, Mapping[str, tuple[float, float | None]]] = {
    "camera": {"camera views": (0.63, 0.9), "Calibrating the camera": (0.25, 0.4)},
    "planes": {"plane poses": (5.0, 3.1), "fan poses": (0.5, 0.3)},
    "scan": {
        "reference": (0.15, None),
        "frames": (2.7, None),
        "crossings": (0.1, 0.1),
        "network": (1.1, 1.2),
        "calibration uncertainty": (0.25, 0.45),
        "normals": (0.5, 0.4),
        "mesh": (0.2, None),
    },
    "gauge": {"faces": (0.5, 0.5)},
    "inspection": {"features": (0.3, 0.3)},
    "report": {"report": (1.2, 1.2)},
}
"""Seconds of each stage of a step, in their order: in one process, and with a second one beside it, None where that one
does all of the stage. They are the sample's, measured on two cores; only the shares matter."""


_SET = ("gauge", *(step.name for step in GRAPH if not step.on_request))
"""What is done of a recording set."""

_STEPS: Mapping[str, tuple[str, ...]] = {
    "run": _SET,
    "camera": ("camera",),
    "planes": ("planes",),
    "scan": ("scan",),
    "measure_scan": ("scan", "gauge"),
    "measure_watched": ("scan", "gauge"),
    "make_report": ("report",),
    "measure_set": _SET,
    "measure_all": tuple(step.name for step in IN_PROJECT),
}
"""What each job does: functions that the window asks for, and commands."""

_BESIDE = ("run", "measure_all")
"""Jobs that have a second process beside them."""


def _steps_of(job: str) -> tuple[str, ...]:
    """Its steps in the order of work, but for those that take no time."""
    return tuple(step.name for step in GRAPH if step.name in _STEPS.get(job, ()) and step.name in _STAGES)


def _stages_of(job: str) -> dict[str, float]:
    """Seconds of the stages of a job, in the order of work."""
    stages = [stage for step in _steps_of(job) for stage in _STAGES[step].items()]
    return {name: seconds for name, both in stages if (seconds := both[job in _BESIDE]) is not None}


USUAL_S: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        **{job: _stages_of(job) for job in _STEPS},
        "find_views": {"camera views": 0.63},
        "solve_views": {"Calibrating the camera": 0.25},
        "find_poses": {"plane poses": 5.0},
        "solve_poses": {"fan poses": 0.2},
    }
)
"""Seconds of each stage, in their order, by the name of the job."""

COUNTED = ("camera views", "plane poses", "fan poses", "frames")
"""Stages whose progress is a number of pictures."""


def page_of(job: str, stage: str) -> tuple[int, int, str] | None:
    """Page of a job's stage: its number from 1, of how many, its name; None where the job has one alone."""
    done = {step.name: step.page for step in GRAPH if step.name in _steps_of(job)}
    pages = list(dict.fromkeys(done.values()))
    page = next((page for step, page in done.items() if stage in _STAGES[step]), None)
    return None if page is None or len(pages) == 1 else (pages.index(page) + 1, len(pages), page)


_TRUSTED = 0.05
"""From this share of a stage on its own pace counts."""
_AS_USUAL = 0.02
"""Share of a job that is taken for as fast as usual, before anything of it is known."""
_NOTICED_S = 0.5
"""A stage's own pace is told by no less time."""


class Remaining:
    """Follows one job.

    Parameters
    ----------
    usual
        Seconds of each stage, in their order; a stage that others have overtaken is not waited for.
    remembered
        The same of the last time, as far as there was one.
    clock
        Seconds; for tests.
    """

    def __init__(
        self,
        usual: Mapping[str, float],
        remembered: Mapping[str, float] | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._usual, self._clock = {**usual, **(remembered or {})}, clock
        self._places = {stage: place for place, stage in enumerate(usual)}
        self._place = -1
        self._stage, self._begun, self._shown = "", clock(), 0.0
        self._done, self._done_s = 0.0, 0.0  # of this stage: the share reported last, and when that was
        self.seconds: dict[str, float] = {}

    def tell(self, stage: str, done: int, total: int) -> None:
        """The job's progress."""
        if stage != self._stage:
            self._close()
            self._stage, self._begun = stage, self._clock()
            self._place = max(self._place, self._places.get(stage, -1))
            self._done, self._done_s = 0.0, 0.0
        if total and done / total != self._done:
            self._done, self._done_s = done / total, self._in_stage

    def finish(self) -> dict[str, float]:
        """The job is done: seconds of each stage, to be remembered."""
        self._close()
        self._stage = ""
        return self.seconds

    @property
    def share(self) -> float | None:
        """How much of the whole job is done, 0 … 1, and never less than was said before; None if it is not known."""
        left = self.left
        if left is None:
            return None
        spent = sum(self.seconds.values()) + self._in_stage
        if spent + left > 0:
            self._shown = max(self._shown, spent / (spent + left))
        return self._shown

    @property
    def left(self) -> float | None:
        """Seconds left, or None while nothing can be said."""
        usual, in_stage, pace = self._usual.get(self._stage), self._in_stage, self._pace
        told = self._done > _TRUSTED and self._done_s > _NOTICED_S
        if usual is None and not told and not self._usual:
            return None
        by_usual = max((usual or 0.0) * pace - in_stage, 0.0)
        by_itself = max(self._done_s / self._done - in_stage, 0.0) if told else by_usual
        trust = 1.0 if usual is None else self._done**0.5
        of_stage = trust * by_itself + (1 - trust) * by_usual
        return of_stage + pace * sum(seconds for stage, seconds in self._usual.items() if self._is_to_come(stage))

    @property
    def _in_stage(self) -> float:
        return self._clock() - self._begun

    @property
    def _pace(self) -> float:
        """How much slower than usual the job is until now."""
        took = {stage: seconds for stage, seconds in self.seconds.items() if stage in self._usual}
        usual = sum(self._usual[stage] for stage in took)
        first = _AS_USUAL * sum(self._usual.values())
        spent, expected = sum(took.values()) + first, usual + first
        here = self._usual.get(self._stage, 0.0)
        if here and self._done:
            spent, expected = spent + self._done_s, expected + here * self._done
        elif here and self._in_stage > here * spent / expected:
            spent, expected = spent + self._in_stage, expected + here
        return spent / expected if expected else 1.0

    def _is_to_come(self, stage: str) -> bool:
        return (
            stage != self._stage
            and stage not in self.seconds
            and self._places.get(stage, len(self._places)) > self._place
        )

    def _close(self) -> None:
        if self._stage:
            self.seconds[self._stage] = self.seconds.get(self._stage, 0.0) + self._in_stage


def in_words(seconds: float) -> str:
    """A rough duration as one says it: "12 s", "2 min"."""
    if seconds < 60:
        return f"{max(1, round(seconds))} s"
    return f"{round(seconds / 60)} min"
