"""How much of a job is left, from what its stages usually take.

Jobs report stages one after another, and how long the later ones take is not in any of them. So each stage's usual time
is known, from the sample or from the last run of the same job, and stretched by how those done so far compare with it.
"""

from __future__ import annotations

import math
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
    """Return the number, count and name of the page a job's stage is on; None for a job of one page."""
    done = {step.name: step.page for step in GRAPH if step.name in _steps_of(job)}
    pages = list(dict.fromkeys(done.values()))
    page = next((page for step, page in done.items() if stage in _STAGES[step]), None)
    return None if page is None or len(pages) == 1 else (pages.index(page) + 1, len(pages), page)


_TRUSTED = 0.05
"""From this share of a stage on that is not known, its own pace counts."""
_NOTICED_S = 0.5
"""A stage's own pace is told by no less time."""

_MACHINE, _STAGE = 1.5, 0.25
"""How far the pace of the machine, and that of a stage beside others, are from the usual ones at first: standard
deviations of natural logarithms. Stages of another kind of set differ by a quarter."""
_DRIFT = 0.02
"""By how much the machine's pace changes from report to report where nothing happens to it."""
_REPORT, _FEW = 0.25, 0.3
"""Scatter of one report's time: of each, and by how few there are (divided by the root of their number)."""
_SURPRISE = 2.0
"""Two reports in a row that are both too late, or both too soon, by so many standard deviations: other work on the
machine began, or ended."""
_SHORTEST_S = 1e-3
"""No report took less time than this, whatever the clock says."""


class _Pace:
    """Logarithms of how much slower than usual the machine and the present stage are, by a Kalman filter.

    Each report tells the sum of both; the stage's part stays as it is as long as the stage lasts. So a change within a
    stage is the machine's, which holds for the stages to come as well, and a change from stage to stage is shared.
    """

    def __init__(self) -> None:
        self.machine = self.stage = 0.0
        self._of_machine, self._of_stage, self._of_both = _MACHINE**2, _STAGE**2, 0.0
        self._surprise = math.inf  # nothing is known of the machine yet: the first report is believed

    @property
    def here(self) -> float:
        """How many times its usual time the present stage takes."""
        return math.exp(self.machine + self.stage)

    def begin_stage(self) -> None:
        """Another stage begins: nothing is known of its own part."""
        self.stage, self._of_stage, self._of_both = 0.0, _STAGE**2, 0.0

    def learn(self, ratio: float, reports: int) -> None:
        """One of so many `reports` of the stage took `ratio` times its usual time."""
        self._of_machine += _DRIFT**2
        off = math.log(ratio) - self.machine - self.stage
        scatter = _REPORT**2 + _FEW**2 / reports
        before, self._surprise = self._surprise, off / math.sqrt(self._variance + scatter)
        if abs(self._surprise) > _SURPRISE:
            if math.isinf(before) or (before * self._surprise > 0 and abs(before) > _SURPRISE):
                self._of_machine += off**2
            else:
                scatter += off**2  # one report alone may be late for many reasons
        whole = self._variance + scatter
        machine, stage = (self._of_machine + self._of_both) / whole, (self._of_stage + self._of_both) / whole
        self.machine += machine * off
        self.stage += stage * off
        both = self._of_both - machine * stage * whole
        self._of_machine -= machine**2 * whole
        self._of_stage -= stage**2 * whole
        self._of_both = both

    def later(self, late: float) -> float:
        """How many times their usual time later stages take, if this one's report is late by the factor `late`."""
        share = (self._of_machine + self._of_both) / self._variance
        return math.exp(self.machine + share * math.log(late))

    @property
    def _variance(self) -> float:
        return self._of_machine + self._of_stage + 2 * self._of_both


class Remaining:
    """Estimator of the time left of one job.

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
        self._done, self._done_s, self._reports = 0.0, 0.0, 1  # of this stage: share reported last, when, of how many
        self._step = 0.0  # the largest share that one report of this stage told; 0 before the first
        self._pace = _Pace()
        self.seconds: dict[str, float] = {}

    def report(self, stage: str, done: int, total: int) -> None:
        """Record that `done` of `total` of the job's `stage` are done, from which the time left is estimated."""
        if stage != self._stage:
            self._close()
            self._stage, self._begun = stage, self._clock()
            self._place = max(self._place, self._places.get(stage, -1))
            self._done, self._done_s, self._step = 0.0, 0.0, 0.0
            self._pace.begin_stage()
        self._reports = max(total, 1)
        if total and done / total != self._done:
            self._learn(done / total)
            self._step = max(self._step, done / total - self._done)
            self._done, self._done_s = done / total, self._in_stage

    def finish(self) -> dict[str, float]:
        """End the job, and return by stage the seconds it took, to be remembered."""
        self._close()
        self._stage = ""
        return self.seconds

    @property
    def share(self) -> float | None:
        """Share of the whole job that is done, 0 … 1, never decreasing; None if it is not known."""
        left = self.left
        if left is None:
            return None
        spent = sum(self.seconds.values()) + self._in_stage
        if spent + left > 0:
            self._shown = max(self._shown, spent / (spent + left))
        return self._shown

    @property
    def left(self) -> float | None:
        """Estimated time in s until the job is done; None while it cannot be estimated."""
        usual, waited = self._usual.get(self._stage, 0.0), self._in_stage - self._done_s
        if not usual:
            told = self._done > _TRUSTED and self._done_s > _NOTICED_S
            if not told and not self._usual:
                return None
            here = max(self._done_s * (1 / self._done - 1) - waited, 0.0) if told else 0.0
            return here + self._to_come(1.0)
        expected = usual * self._pace.here * min(self._step or 1.0, 1 - self._done)  # a report may tell many pieces
        late = waited / expected if waited > expected > 0 else 1.0
        here = max(usual * (1 - self._done) * self._pace.here * late - waited, 0.0)
        return here + self._to_come(late)

    def _to_come(self, late: float) -> float:
        """Seconds of the stages to come, where this one's report is late by the factor `late`."""
        return self._pace.later(late) * sum(s for stage, s in self._usual.items() if self._is_to_come(stage))

    @property
    def _in_stage(self) -> float:
        return self._clock() - self._begun

    def _learn(self, done: float) -> None:
        """The share `done` of this stage is reported."""
        usual = self._usual.get(self._stage, 0.0) * (done - self._done)
        if usual > 0:
            self._pace.learn(max(self._in_stage - self._done_s, _SHORTEST_S) / usual, self._reports)

    def _is_to_come(self, stage: str) -> bool:
        return (
            stage != self._stage
            and stage not in self.seconds
            and self._places.get(stage, len(self._places)) > self._place
        )

    def _close(self) -> None:
        if self._stage:
            self._learn(1.0)
            self.seconds[self._stage] = self.seconds.get(self._stage, 0.0) + self._in_stage


def in_words(seconds: float) -> str:
    """Write a duration roughly in words: "12 s", "2 min"."""
    if seconds < 60:
        return f"{max(1, round(seconds))} s"
    return f"{round(seconds / 60)} min"
