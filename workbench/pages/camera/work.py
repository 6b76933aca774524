"""What is known of the camera's pictures: where the target was found, the solution, how good the views are."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from core.calibrate.camera.views import RecalledCamera, SeenViews, ViewsJudgement
from core.calibrate.results import CameraCalibration
from core.errors import InputError
from core.files.project.data import Project
from core.image.targets.target_view import OtherBoard
from core.messages import Message
from workbench.language import joined, sentence, text_of, tr
from workbench.pages.calibration.work import CalibrationWork, Key
from workbench.work import jobs


class CameraWork(CalibrationWork[SeenViews, CameraCalibration]):
    """Worker that finds the target in the pictures, solves and judges.

    `seen`, `calibration`, `judgement` are of the project as it is, or None.
    """

    STEP = "camera"
    FIND, SOLVE, FOUND = jobs.FIND_VIEWS, jobs.SOLVE_VIEWS, jobs.FOUND_VIEWS

    judgement: ViewsJudgement | None = None

    @property
    def seen(self) -> SeenViews | None:
        """Views found in the camera's pictures; None until the pictures have been searched."""
        return self.found

    @property
    def counted(self) -> tuple[int, int] | None:
        """Columns and rows of the board seen in the pictures if they differ from the target entered; else None."""
        rested_on, problem = self._refused
        refused = isinstance(problem, OtherBoard) and rested_on == self._found_key and self.found is None
        return problem.counted if refused else None

    def left_out(self) -> dict[str, Message]:
        return {view.name: view.reason for view in self.seen.lost if view.reason} if self.seen is not None else {}

    def _forget(self) -> None:
        super()._forget()
        self.judgement = None

    @staticmethod
    def name_of(path: Path) -> str:
        """Return the name in the project of the picture at `path`."""
        return f"camera/{path.name}"

    def _labels(self) -> tuple[str, str]:
        return tr("Camera"), tr("Solving the camera")

    def _can_search(self, project: Project) -> bool:
        return bool(project.sources.camera)

    def _in_words(self, problem: Any) -> str:
        """A problem as a sentence of its own; where it is, the page itself shows."""
        if not isinstance(problem, InputError) or problem.where not in ("", "camera"):
            return super()._in_words(problem)
        said = [text_of(part) for part in (problem.what, problem.todo) if str(part)]
        return sentence(joined(said, ";"))

    def _recall(self, folder: Path, project: Project) -> None:
        if not project.accepted.camera:
            self._ask_what_was_found(folder, project)
            return
        self._bench.run_quick(
            self,
            jobs.RECALL_CAMERA,
            folder,
            project,
            label=tr("Reading the calibration"),
            on_done=lambda recalled: self._recalled(folder, project, recalled),
            on_failed=lambda _: self._ask_what_was_found(folder, project),
        )

    def _recalled(self, folder: Path, project: Project, recalled: RecalledCamera) -> None:
        """The accepted calibration was read; where it is of the pictures in use, it need not be solved again."""
        if recalled.seen is None:
            self._ask_what_was_found(folder, project)
        else:
            self._take_up(folder, project, recalled.seen, recalled.calibration if recalled.as_it_is else None)

    def _calibration_changed(self) -> None:
        if self.seen is None:
            self.judgement = None
            return
        key = self._solve_key
        self._bench.run_quick(
            self,
            jobs.JUDGE_VIEWS,
            self.seen,
            self._model.project.options.excluded,
            self.calibration,
            label=tr("Judging the views"),
            on_done=lambda judgement: self._judged(key, judgement),
            replace_waiting=True,
        )

    def _judged(self, key: Key, judgement: ViewsJudgement) -> None:
        if key == self._solve_key:
            self.judgement = judgement
            self.changed.emit()
