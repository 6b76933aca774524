"""Known artefacts: their registers, and what was measured compared with the certificate of one of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from PySide6.QtCore import QObject, Signal

from core.checks.artefact_check import KINDS, Artefact, ArtefactCheck, ArtefactKind
from core.files.project.keys import up_to_date
from core.files.results.rig_history import CheckChart
from workbench.bench import Bench
from workbench.language import text_of, tr
from workbench.pages.scan.stage import why_not_compare
from workbench.step_state import State
from workbench.work import jobs
from workbench.work.tasks import Task


class KnownArtefacts(QObject):
    """Artefacts of the user and the project, and their measurements with the accepted calibrations.

    `own` are the user's by their ids, as they were last read, `lengths` the names of what each kind can be compared
    with. `checks` are the results, of each artefact the one nearest in time to the recording, `charts` all of them with
    their limits. `problem` says why the last artefact was not kept, or the registers not read.
    """

    changed = Signal()

    def __init__(self, bench: Bench, measuring: Callable[[], bool], parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._bench, self._model, self._measuring = bench, bench.model, measuring
        self.own: Mapping[str, Artefact] = {}
        self.lengths: Mapping[ArtefactKind, tuple[str, ...]] = {}
        self.checks: tuple[ArtefactCheck, ...] = ()
        self.charts: tuple[CheckChart, ...] = ()
        self.problem, self._looked = "", ""
        self._task: Task | None = None

    @property
    def of_project(self) -> Mapping[str, Artefact]:
        """Artefacts in the project's own register, by id."""
        return {one.id: one for one in self._model.project.artefacts}

    @property
    def known(self) -> Mapping[str, Artefact]:
        """Artefacts of the user's and the project's register, by id; the project's comes first."""
        return {**self.own, **self.of_project}

    @property
    def cannot_compare(self) -> str:
        """Reason why nothing can be compared with an artefact now; "" if something can."""
        reasons = [self._why_not(step) for step in ("gauge", "inspection")]
        return reasons[0] if all(reasons) else ""

    def why_not(self, artefact: Artefact, characteristic: str) -> str:
        """Return the reason why a measured characteristic cannot be compared with `artefact` now; "" if it can.

        "" is the thickness.
        """
        if artefact.kind == "block" and not characteristic:
            return self._why_not("gauge")
        return self._why_not("inspection") or (
            ""
            if characteristic
            else tr(
                "None is measured ({length}): add one to the features of the part on the Inspect page.",
                length=tr(KINDS[artefact.kind]),
            )
        )

    def _why_not(self, step: str) -> str:
        """Why nothing of the thickness, "gauge", or of the plan, "inspection", can be compared."""
        project, results = self._model.project, self._model.results
        scan = self._model.states["scan"].state
        return why_not_compare(
            comparing=self._task is not None,
            measuring=self._measuring(),
            cannot_write=self._bench.cannot_write,
            measured=step in results,
            outdated=scan is State.OUTDATED or not up_to_date(step, project, results),
        )

    def compare(self, artefact: Artefact, characteristic: str = "") -> None:
        """Compare a measured characteristic with an artefact's certificate, and add the result to the rig's history."""
        folder, project = self._model.folder, self._model.project
        if folder is None or self.cannot_compare:
            return
        task: Task = self._bench.run_long(
            self,
            jobs.COMPARE_WITH_ARTEFACT,
            folder,
            project,
            artefact,
            characteristic,
            label=tr("Comparing with an artefact"),
            on_done=lambda check: self._ended(task, check),
            on_failed=lambda _: self._ended(task),
            on_cancelled=lambda: self._ended(task),
            offers={},
        )
        self._task = task
        self.changed.emit()

    def add(self, artefact: Artefact, *, own: bool) -> None:
        """Add an artefact to the user's register (`own`) or to the project's, which is undoable."""
        self.problem = ""
        if own:
            self._ask_for_own(jobs.KEEP_OWN_ARTEFACT, artefact)
            return
        project = self._model.project
        label = tr("add the artefact {id}", id=artefact.id)
        self._model.edit(label, replace(project, artefacts=(*project.artefacts, artefact)))

    def change(self, before: Artefact, after: Artefact | None, *, own: bool) -> None:
        """Replace the artefact `before` in its register by `after`, or remove it for None; undoable in the project."""
        self.problem = ""
        if own:
            self._ask_for_own(jobs.CHANGE_OWN_ARTEFACT, before.id, after)
            return
        project = self._model.project
        changed = {before.id: after}
        left = (changed.get(one.id, one) for one in project.artefacts)
        label = (
            tr("remove the artefact {id}", id=before.id)
            if after is None
            else tr("change the artefact {id}", id=before.id)
        )
        self._model.edit(label, replace(project, artefacts=tuple(one for one in left if one is not None)))

    def read(self) -> None:
        """Read the user's register, as it may have been edited, and the lengths that can be compared."""
        self.problem = ""
        self._ask_for_own(jobs.OWN_ARTEFACTS)
        if self._model.folder is None:
            return

        def done(lengths: Mapping[ArtefactKind, tuple[str, ...]]) -> None:
            self.lengths = lengths
            self.changed.emit()

        self._bench.quick.run(
            self,
            jobs.COMPARABLE_LENGTHS,
            self._model.folder,
            label=tr("Reading what was measured"),
            on_done=done,
            on_failed=self._refused,
            offers={},
        )

    def opened(self) -> None:
        """Stop comparing, and read what the project now open has measured with its calibrations."""
        if self._task is not None:
            self._task.cancel()
        self._task, self.checks, self.charts, self._looked, self.lengths = None, (), (), "", {}
        self.follow()

    def follow(self) -> None:
        """Read what was measured with the project's present calibrations, if these have changed."""
        folder, project = self._model.folder, self._model.project
        accepted = project.accepted
        wanted = f"{folder}|{accepted}|{project.rig.name}|{project.sources.scan}" if accepted.planes else ""
        if wanted == self._looked:
            return
        self._looked, self.checks, self.charts = wanted, (), ()
        if folder is None or not wanted:
            self.changed.emit()
            return

        def read(checks: tuple[ArtefactCheck, ...]) -> None:
            if self._looked == wanted:
                self.checks = checks
                self.changed.emit()

        def read_charts(charts: tuple[CheckChart, ...]) -> None:
            if self._looked == wanted:
                self.charts = charts
                self.changed.emit()

        asked: tuple[tuple[jobs.Job, Callable[[Any], None]], ...] = (
            (jobs.ARTEFACT_CHECKS, read),
            (jobs.ARTEFACT_CHARTS, read_charts),
        )
        for job, on_done in asked:
            self._bench.quick.run(
                self,
                job,
                folder,
                project,
                label=tr("Reading the history of the rig"),
                on_done=on_done,
                on_failed=lambda _: None,  # what is wrong is told when it is measured or compared
                offers={},
            )

    def _refused(self, problem: Any) -> None:
        self.problem = text_of(problem)
        self.changed.emit()

    def _ask_for_own(self, job: jobs.Job, *values: object) -> None:
        def read(own: Mapping[str, Artefact]) -> None:
            self.own = own
            self.changed.emit()

        self._bench.quick.run(
            self,
            job,
            *values,
            label=tr("Reading the register of artefacts"),
            on_done=read,
            on_failed=self._refused,
            offers={},
        )

    def _ended(self, task: Task, check: ArtefactCheck | None = None) -> None:
        if task is not self._task:
            return  # of the project before
        self._task = None
        if check is not None:
            notices = self._bench.notices
            (notices.info if check.verdict == "passed" else notices.warning)(text_of(check.sentence))
            self._looked = ""
            self.follow()
        self.changed.emit()
