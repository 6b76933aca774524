"""Decisions that the pages of both calibrations share: pictures, which of them count, accept or reject."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar, Literal

from core.files.project.data import Project
from core.image.targets.target_view import TargetView
from core.pipeline.live.events import LiveEnded, LiveTaken
from workbench.bench import Bench
from workbench.language import tr
from workbench.pages.calibration.acceptance import Acceptance
from workbench.pages.calibration.current_picture import CurrentPicture
from workbench.pages.calibration.history import StoredCalibrations
from workbench.pages.calibration.stage import Facts, Stage, WhyNot, disabled_reasons, stage_of
from workbench.pages.calibration.target import TargetChoice
from workbench.pages.calibration.work import CalibrationWork
from workbench.pages.live.presenter import LivePresenter
from workbench.pages.presenter import StepPresenter
from workbench.pages.sources import folder_of, put_source
from workbench.step_state import State
from workbench.work.jobs import Job


class CalibrationPresenter(StepPresenter):
    """Presenter of a calibration: pictures found, solved and judged, and what is accepted.

    A subclass says in `KEEP` which job keeps an accepted one, brings its `work`, `look`, `history` and `target`, and
    says what differs in words.
    """

    step: Literal["camera", "planes"]
    KEEP: ClassVar[Job]

    work: CalibrationWork[Any, Any]
    look: CurrentPicture
    history: StoredCalibrations
    target: TargetChoice

    def __init__(self, bench: Bench) -> None:
        super().__init__(bench)
        self.live = LivePresenter(bench, self.step, self)
        self.live.there = self.views_that_count
        self.live_views: list[tuple[str, Any]] = []
        """Name and small picture of each that was taken since the live source was started."""
        self.acceptance = Acceptance(bench, self.step, self.KEEP, self)
        self.live.changed.connect(self.changed)
        self.live.started.connect(self._live_started)
        self.live.taken.connect(self._live_taken)
        self.live.ended.connect(self._live_ended)
        self.acceptance.changed.connect(self.changed)
        bench.measuring.task_ended.connect(self._job_ended)

    def _connect(self) -> None:
        """To be called by a subclass once its `work`, `look` and `history` are there."""
        self.work.changed.connect(self._work_changed)
        self.history.changed.connect(self.changed)
        self.acceptance.kept.connect(self.history.refresh)

    # ---- what differs

    @property
    @abstractmethod
    def candidate(self) -> str:
        """Id of the calibration that is shown, accepted or not; "" for none."""

    @abstractmethod
    def _is_current(self) -> bool:
        """Whether the accepted calibration is what the project gives now."""

    @abstractmethod
    def _missing(self) -> dict[Stage, str]:
        """What is missing at each stage before the next step makes sense; nothing where it is accepted."""

    @abstractmethod
    def _accepted_already(self) -> str:
        """Why the accepted calibration cannot be accepted."""

    @abstractmethod
    def _names(self, count: int) -> str:
        """So many pictures, in words."""

    @abstractmethod
    def _source_label(self) -> str:
        """What the edit is called that chooses the pictures."""

    @abstractmethod
    def _made(self) -> tuple[Any, ...]:
        """What keeping the calibration takes."""

    @abstractmethod
    def views(self) -> tuple[Any, ...]:
        """List the views or poses with the quality that the calibration shown gives them."""

    @abstractmethod
    def views_that_count(self) -> tuple[TargetView, ...]:
        """List the targets found in the pictures, without pictures left out by hand."""

    # ---- state

    @property
    def current(self) -> str:
        """Name of the picture that is looked at; "" for none."""
        return self.look.current

    @property
    def stage(self) -> Stage:
        """How far the calibration is: no pictures, searching, solved, accepted, …."""
        return stage_of(self._facts())

    def _facts(self) -> Facts:
        work, project = self.work, self.project
        return Facts(
            needed=self.is_needed,
            live=self.live.running,
            searching=work.searching,
            solving=work.solving,
            accepted=self.acceptance.accepted,
            candidate=self.candidate,
            current=self._is_current(),
            rejected=self.acceptance.is_rejected(self.candidate),
            camera_missing=self.step == "planes" and not project.accepted.camera,
            failed=bool(work.problem),
            source=bool(getattr(project.sources, self.step)),
            empty=work.pictures == (),
            calibration=work.calibration is not None,
            keeping=self.acceptance.keeping,
            read_only=self.model.is_read_only,
        )

    @property
    def is_needed(self) -> bool:
        """Whether the rig has what is calibrated here."""
        return self.state.state is not State.NOT_NEEDED

    @property
    def is_done(self) -> bool:
        """Whether a calibration is accepted, and nothing it depends on has changed since."""
        return self.state.state is State.DONE

    def blocker(self) -> str:
        return self._missing().get(self.stage, "")

    @property
    def cannot_search(self) -> str:
        """Reason why the target cannot be searched in the pictures now; "" if it can."""
        return self._sentence(disabled_reasons(self._facts()).run)

    @property
    def cannot_accept(self) -> str:
        """Reason why the calibration cannot be accepted now; "" if it can."""
        return self._sentence(disabled_reasons(self._facts()).accept)

    @property
    def is_working(self) -> bool:
        return self.work.searching or self.work.solving or self.acceptance.keeping

    @property
    def waits_to_be_accepted(self) -> bool:
        return not self.cannot_accept

    @property
    def cannot_reject(self) -> str:
        """Reason why the calibration cannot be rejected now; "" if it can."""
        return self._sentence(disabled_reasons(self._facts()).reject)

    def _sentence(self, why: WhyNot) -> str:
        missing = self._missing()
        return {
            WhyNot.NOTHING: "",
            WhyNot.LIVE: tr("Stop the live source first."),
            WhyNot.READ_ONLY: self.bench.cannot_write,
            WhyNot.NOT_NEEDED: self.state.sentence,
            WhyNot.NO_CAMERA: tr("Accept a camera calibration first."),
            WhyNot.NO_SOURCE: tr("Choose or record pictures first."),
            WhyNot.SEARCHING: missing[Stage.SEARCHING],
            WhyNot.SOLVING: missing[Stage.SOLVING],
            WhyNot.NO_CALIBRATION: tr("There is no calibration yet."),
            WhyNot.ACCEPTED: self._accepted_already(),
            WhyNot.REJECTED: tr("This calibration is rejected already."),
        }[why]

    # ---- pictures

    def choose(self, name: str) -> None:
        """Show the picture called `name`."""
        if name != self.current:
            self.look.current = name
            self.look.refresh()
            self.changed.emit()

    def quality_of(self, name: str) -> Any:
        """Return the view or pose called `name` with its quality; None if the calibration has none."""
        return next((view for view in self.views() if view.name == name), None)

    def short(self, name: str) -> str:
        """Return the name of a picture without the folder of its step: "view03.png"."""
        return name.removeprefix(f"{self.step}/")

    def stored(self, name: str) -> str:
        """Return the name of a picture with the folder of its step: "camera/view03.png"."""
        return f"{self.step}/{self.short(name)}"

    @property
    def folder(self) -> Path | None:
        """Folder of the step's pictures; None if none is chosen."""
        return folder_of(self.model, self.step)

    def use_folder(self, folder: Path) -> None:
        """Make `folder` the source of the step's pictures, and search the target in them."""
        self.live.stop()
        put_source(self.model, self.step, folder, self._source_label())
        self.work.search()

    def set_used(self, names: Sequence[str], used: bool) -> None:
        """Use the pictures called `names`, or leave them out; undoable. Live ones are discarded."""
        if self.live.running:
            if not used:
                for name in names:
                    self.live.discard(self.short(name))
                self.live_views = [view for view in self.live_views if view[0] not in names]
                self.changed.emit()
            return
        stored = {self.stored(name) for name in names}
        excluded = self.project.options.excluded
        what = self.short(names[0]) if len(names) == 1 else self._names(len(names))
        label = tr("let {what} count", what=what) if used else tr("leave out {what}", what=what)
        self._exclude(excluded - stored if used else excluded | stored, label)

    def _exclude(self, excluded: frozenset[str], label: str, merge_key: str = "") -> None:
        options = replace(self.project.options, excluded=frozenset(excluded))
        self.model.edit(label, replace(self.project, options=options), merge_key)

    # ---- what the user does

    def accept(self) -> None:
        """Accept the calibration that is shown; undoable."""
        if not self.cannot_accept:
            self.acceptance.accept(*self._made())

    def reject(self) -> None:
        """Reject the calibration that is shown; undoable."""
        if not self.cannot_reject:
            self.acceptance.reject(self.candidate)

    def do_run(self) -> None:
        """Search the target in all pictures, then solve the calibration; called by shortcut."""
        if not self.cannot_search:
            self.work.search()

    def do_accept(self) -> None:
        """Accept the calibration that is shown; called by shortcut."""
        self.accept()

    def do_live(self) -> None:
        """Start the live source, or stop it; called by shortcut."""
        self.live.toggle()

    def do_capture(self) -> None:
        """Take the live picture; called by shortcut."""
        self.live.capture()

    # ---- what happens elsewhere

    def opened(self) -> None:
        self.look.forget()
        self.acceptance.forget()
        self.work.opened()
        self.history.forget()
        self.history.refresh()

    def project_changed(self, before: Project, after: Project) -> None:
        if getattr(before.sources, self.step) != getattr(after.sources, self.step):
            self.look.forget()
        self.work.follow()

    def _job_ended(self, _: object) -> None:
        """A long job is over: it may have searched these pictures, too."""
        self.work.recall()

    def _work_changed(self) -> None:
        self.look.follow()
        self.changed.emit()

    def _live_started(self) -> None:
        self.live_views.clear()

    def _live_taken(self, taken: LiveTaken) -> None:
        name = taken.name if self.step == "planes" else self.stored(taken.name)
        self.live_views.append((name, taken.thumbnail))

    def _live_ended(self, ended: LiveEnded) -> None:
        if ended.recorded and self.folder == ended.folder:
            self.work.search()
