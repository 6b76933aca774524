"""What every presenter is given: the project, the lanes work goes to, the messages, the user's settings."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from PySide6.QtCore import QObject

from workbench.language import text_of, tr
from workbench.notices import Notices
from workbench.project_model import ProjectModel
from workbench.settings import AppSettings
from workbench.work import jobs
from workbench.work.tasks import Lane, Task

WRITING = frozenset(
    {
        *(jobs.FIND_VIEWS, jobs.ACCEPT_CAMERA, jobs.FIND_POSES, jobs.ACCEPT_PLANES, jobs.MEASURE_SCAN, jobs.WATCH_SCAN),
        *(jobs.CHECK_RIG, jobs.COMPARE_WITH_ARTEFACT, jobs.MEASURE_PROFILES, jobs.MEASURE_GAUGE),
        *(jobs.MEASURE_FEATURES, jobs.MEASURE_ALL, jobs.MAKE_REPORT, jobs.CHOOSE_TEMPLATE),
        *(jobs.ADD_RECORDING, jobs.KEEP_IMPORTED_CAMERA),
    }
)
"""Jobs that put something into the folder of the open project: none is done where another program has it open.

A wing says of its own with `writes` that they do."""

COMPILES_S = 160.0
"""Processor seconds that the first start compiles where no code came with the program; told in whole minutes."""


@dataclass(frozen=True, eq=False, slots=True)
class Bench:
    """Settings, project, notices and lanes shared by all pages. `measuring` runs the long jobs, `quick` what the
    eye waits for, `live` the live source.
    """

    model: ProjectModel
    notices: Notices
    settings: AppSettings
    measuring: Lane
    quick: Lane
    live: Lane

    @property
    def cannot_write(self) -> str:
        """Reason why nothing can be measured into the open project; "" if it can."""
        read_only = tr("The project is read-only: go on in a copy (File, Save a copy).")
        return self.unwitnessed or (read_only if self.model.is_read_only else "")

    @property
    def unwitnessed(self) -> str:
        """Reason why the open project cannot be changed, in no copy either, as a wing is not there; "" if it can."""
        refused = None if self.model.folder is None else self.model.why_wing_missing(self.model.folder)
        return "" if refused is None else text_of(refused)

    def run_long(self, receiver: QObject, job: jobs.Job, *args: Any, label: str, **more: Any) -> Task:
        """Run a long `job(*args)` in the worker process, its progress in the status bar; a notice shows an error."""
        return self._run(self.measuring, receiver, job, *args, label=label, **more)

    def run_quick(self, receiver: QObject, job: jobs.Job, *args: Any, label: str, **more: Any) -> Task:
        """Run a short `job(*args)` in its own process, where long jobs do not delay it; a notice shows an error."""
        return self._run(self.quick, receiver, job, *args, label=label, **more)

    def _run(
        self,
        lane: Lane,
        receiver: QObject,
        job: jobs.Job,
        *args: Any,
        on_failed: Callable[[Any], None] | None = None,
        writes: bool = False,
        **more: Any,
    ) -> Task:
        def failed(problem: Any) -> None:
            self.notices.failed(problem, job)
            if on_failed is not None:
                on_failed(problem)

        if (writes or job in WRITING) and (refused := self.model.why_read_only()) is not None:
            job, args, more["offers"] = jobs.REFUSE, (refused,), {}
        return lane.run(receiver, job, *args, on_failed=failed, **more)

    def close(self) -> None:
        """Kill all worker processes, without waiting until they are gone."""
        for lane in (self.measuring, self.quick, self.live):
            lane.close()

    def wait_until_closed(self) -> None:
        """Wait until all killed worker processes are gone; call it after the event loop has ended."""
        for lane in (self.measuring, self.quick, self.live):
            lane.wait_until_closed()


def make_bench(settings: AppSettings | None = None) -> Bench:
    """Make the bench: project, settings, notices, and worker processes that start when first needed."""
    measuring = (jobs.MEASURE_SCAN,)
    return Bench(
        ProjectModel(),
        Notices(),
        settings or AppSettings(),
        Lane("measuring", warm=measuring, ahead=jobs.COMPILE_AHEAD),
        Lane("quick", warm=measuring),
        Lane("live", warm=(jobs.RUN_LIVE,)),
    )
