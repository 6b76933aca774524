"""What every presenter is given: the project, the lanes work goes to, the messages, the user's settings."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from workbench import jobs
from workbench.notices import Notices
from workbench.problems import details, sentence
from workbench.processes import ONE_THREAD
from workbench.project_model import ProjectModel
from workbench.settings import AppSettings
from workbench.tasks import Lane, Task


@dataclass(frozen=True, eq=False, slots=True)
class Bench:
    """Shared by all pages. `measuring` runs the long jobs, `quick` what the eye waits for, `live` the live source."""

    model: ProjectModel
    notices: Notices
    settings: AppSettings
    measuring: Lane
    quick: Lane
    live: Lane

    def measure(self, job: jobs.Job, *args: Any, label: str, on_done: Callable[[Any], None], **more: Any) -> Task:
        """Run a long job whose progress the status bar shows; what goes wrong becomes a notice."""
        return self._run(self.measuring, job, args, label, on_done, more)

    def glance(self, job: jobs.Job, *args: Any, label: str, on_done: Callable[[Any], None], **more: Any) -> Task:
        """Run a short job whose result is shown at once; what goes wrong becomes a notice."""
        return self._run(self.quick, job, args, label, on_done, more)

    def _run(
        self,
        lane: Lane,
        job: jobs.Job,
        args: tuple[Any, ...],
        label: str,
        on_done: Callable[[Any], None],
        more: dict[str, Any],
    ) -> Task:
        on_failed = more.pop("on_failed", None)

        def failed(problem: Any) -> None:
            self.notices.error(sentence(problem), details(problem))
            if on_failed is not None:
                on_failed(problem)

        return lane.run(job, *args, label=label, on_done=on_done, on_failed=failed, **more)

    def close(self) -> None:
        """End all processes."""
        for lane in (self.measuring, self.quick, self.live):
            lane.close()


def make_bench(settings: AppSettings | None = None) -> Bench:
    """A bench with lanes that are started when first used."""
    measuring = (jobs.MEASURE_SCAN,)
    return Bench(
        ProjectModel(),
        Notices(),
        settings or AppSettings(),
        Lane("measuring", warm=measuring, ahead=jobs.COMPILE_AHEAD),
        Lane("quick", warm=measuring),
        Lane("live", warm=(jobs.RUN_LIVE,), environment=ONE_THREAD),
    )
