"""The whole job of a project in one go: whatever is not up to date is done, up to the first decision for a person.

It gives what pressing every button in turn gives, byte for byte. Calibrations are accepted by themselves, unless they
are bad.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext, suppress
from dataclasses import dataclass, replace
from pathlib import Path

from core.calibrate.camera.picture_residuals import bad_fit
from core.errors import InputError
from core.files.project.data import Project, ProjectFile
from core.files.project.folder import results_folder
from core.files.project.keys import finished, left_to_do
from core.files.recording.recording_set import require_scan
from core.files.step_graph import FILES, Step, do_steps
from core.messages import Message
from core.pipeline.project.calibration import (
    accept_camera,
    accept_planes,
    find_poses,
    find_views,
    solve_poses,
    solve_views,
)
from core.pipeline.project.inspection import measure_features
from core.pipeline.project.interim_check import check_rig
from core.pipeline.project.measuring import measure_gauge, measure_scan
from core.pipeline.project.report import make_report
from core.pipeline.project.workspace import project_set
from core.pipeline.steps.gauge_step import missing_thickness
from core.pipeline.steps.report_step import prepare_report
from core.pipeline.steps.scan.pictures import SeenScan, begin_looking
from core.pipeline.taken_over import TAKEN_OVER
from core.progress import Progress, silent
from core.second_process import SecondProcess, second_process

Watch = Callable[[ProjectFile], None]
SHARED = {"planes", "scan"}
"""The steps that are worth a second process."""


@dataclass(frozen=True, slots=True)
class Stop:
    """Reason why measuring a whole project stopped, and the page where the user has to decide or repair something."""

    page: str
    why: Message


@dataclass(frozen=True, slots=True)
class WholeJob:
    """Result of measuring a whole project: the project as it is then, and where it stopped (None: it did not)."""

    file: ProjectFile
    stop: Stop | None


def measure_all(
    folder: Path,
    file: ProjectFile,
    language: str = "en",
    progress: Progress = silent,
    watch: Watch | None = None,
) -> WholeJob:
    """Do every step of a project that is not up to date, from its pictures to its report, until one needs the user.

    It stops where somebody has to decide: at a calibration that is bad, was rejected, or rests on a minority of its
    poses; after a check that is not passed; where a thickness or a feature that is asked for could not be measured;
    and at a step that cannot be done. What was done until then is kept. Called again with the result, it goes on.

    Parameters
    ----------
    folder, file
        The project, and what is done of it already.
    language
        Of the report, where the project states none.
    progress
        Called with what is being done; may raise Cancelled.
    watch
        Given the project after each step that was done.
    """
    shared = not SHARED.isdisjoint(left_to_do(file.project, file.results))
    with second_process(TAKEN_OVER) if shared else nullcontext() as beside:
        work = _Work(folder, file, progress, watch or (lambda _: None), language)
        work.go_beside(beside)
        stop = do_steps(work)
    return WholeJob(work.file, stop)


class _Work:
    """The project while its steps are done: what each does is the method of its name, and says whether to stop."""

    _beside: SecondProcess | None = None
    _seen: Callable[[], SeenScan] | None = None

    def __init__(self, folder: Path, file: ProjectFile, progress: Progress, watch: Watch, language: str) -> None:
        self.file = file
        self._language = language
        self._folder, self._progress, self._watch = folder, progress, watch

    def go_beside(self, beside: SecondProcess | None) -> None:
        """Leave part of the work to a second process, if there is one.

        It begins with the pictures of the scan where the light planes are calibrated first, and no earlier scan is
        there whose features may do.
        """
        self._beside = beside
        asked = {"planes", "scan"} <= {*left_to_do(self._project, self.file.results)}
        if asked and not (results_folder(self._folder) / FILES["scan"]).exists():
            with suppress(InputError):  # said at its step
                recording_set = project_set(self._folder, self._project)
                require_scan(recording_set)
                self._seen = begin_looking(recording_set, self._project.options.for_scan, self._progress, beside)

    def is_due(self, step: Step) -> bool:
        """Whether a step is left to do, now that those before it have been done."""
        return step.name in left_to_do(self.file.project, self.file.results)

    def do(self, step: Step) -> Stop | None:
        try:
            stop: Stop | None = getattr(self, step.name)()
        except InputError as error:
            return Stop(step.page, error.message)
        return stop

    @property
    def _project(self) -> Project:
        return self.file.project

    def camera(self) -> Stop | None:
        project = self._project
        camera = solve_views(self._folder, project, find_views(self._folder, project, self._progress), self._progress)
        bad = bad_fit(camera)
        if bad is not None:
            return Stop("camera", bad)
        return self._accept("camera", accept_camera(self._folder, project, camera))

    def planes(self) -> Stop | None:
        project = self._project
        poses = find_poses(self._folder, project, self._progress, self._beside)
        fan = solve_poses(self._folder, project, poses, self._progress)
        return self._accept("planes", accept_planes(self._folder, project, fan, poses))

    def check(self) -> Stop | None:
        check = check_rig(self._folder, self._project, self._progress)
        self._done("check")
        return None if check.passed else Stop("scan", check.sentence)

    def scan(self) -> Stop | None:
        if self._beside is not None:
            self._beside.submit(prepare_report, None)
        seen, self._seen = self._seen, None
        summary = measure_scan(self._folder, self._project, self._progress, seen=seen, beside=self._beside)
        self._done("scan", *(("gauge",) if summary.gauge is not None else ()), gone=("gauge",))
        missing = missing_thickness(self._project.rig, summary.no_gauge)
        return None if missing is None else Stop("inspect", missing)

    def gauge(self) -> Stop | None:
        measure_gauge(self._folder, self._project, self._progress)
        self._done("gauge")
        return None

    def inspection(self) -> Stop | None:
        shown = measure_features(self._folder, self._project, self._progress)
        self._done("inspection")
        for one in shown.features:
            if one.problem is not None:
                why = Message(
                    "whole.feature_not_measured",
                    "{name} could not be measured: {why}",
                    name=one.name,
                    why=one.problem,
                )
                return Stop("inspect", why)
        return None

    def report(self) -> Stop | None:
        make_report(self._folder, self._project.printed_in(self._language), self._progress, self._beside)
        self._done("report")
        return None

    def _accept(self, step: str, id_: str) -> Stop | None:
        if id_ in self._project.rejected:
            why = Message(
                "whole.calibration_was_rejected",
                "These pictures give a calibration that was rejected before: accept it after all, leave out pictures, "
                "or take others.",
            )
            return Stop(step, why)
        project = replace(self._project, accepted=replace(self._project.accepted, **{step: id_}))
        self.file = replace(self.file, project=project)
        self._done(step)
        return None

    def _done(self, *steps: str, gone: tuple[str, ...] = ()) -> None:
        """These steps have been done; the results of those that are `gone` are no longer there, if not done anew."""
        results = {name: done for name, done in self.file.results.items() if name not in gone}
        for step in steps:
            results[step] = finished(step, self._project, results)
        self.file = replace(self.file, results=results)
        self._watch(self.file)
