"""What is known of the camera's pictures: found, solved, judged; kept for every state that undo may come back to."""

from __future__ import annotations

from collections import OrderedDict
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Signal

from core.calibrate.results import CameraCalibration
from core.calibrate.seen_views import RecalledCamera, SeenViews
from core.calibrate.views_judgement import ViewsJudgement
from core.errors import InputError
from core.files.project import Project
from core.files.project_keys import rests_on
from workbench import jobs
from workbench.bench import Bench
from workbench.pages.sources import folder_of
from workbench.tasks import Task

FOUND_BY = ("pictures of the camera target", "camera target", "colour channel")
"""What finding the target rests on; solving rests on the left-out views and the settings too."""

KEPT = 12
"""So many solutions are kept for undo and redo."""

AT_ONCE = 6
"""So many thumbnails are made in one go, so that what the eye waits for comes between."""

Key = tuple[str, ...]


class CameraWork(QObject):
    """Finds the target in the pictures, solves and judges.

    `seen`, `calibration`, `judgement` are of the project as it is, or None; while a new solution is on its way
    (`solving`) the last one stands. `problem` says why there is none.
    """

    changed = Signal()
    searched = Signal()

    def __init__(self, bench: Bench, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._bench, self._model = bench, bench.model
        self._forget()

    def _forget(self) -> None:
        self.pictures: tuple[Path, ...] | None = None
        self.seen: SeenViews | None = None
        self.calibration: CameraCalibration | None = None
        self.judgement: ViewsJudgement | None = None
        self.problem = ""
        self.solving = False
        self.search_task: Task | None = None
        self.thumbnails: dict[str, Any] = {}
        self._seen: dict[Key, SeenViews] = {}
        self._solved: OrderedDict[Key, tuple[CameraCalibration | None, str]] = OrderedDict()
        self._found_key: Key = ()
        self._solve_key: Key = ()
        self._listed = self._thumbnails_of = ""

    @property
    def searching(self) -> bool:
        """Whether the target is being looked for."""
        return self.search_task is not None

    def opened(self) -> None:
        """Another project: forget, list its pictures, and take up what has been found in them."""
        if self.search_task is not None:
            self.search_task.cancel()
        self._forget()
        folder, project = self._model.folder, self._model.project
        if folder is None:
            return
        self.follow()
        if not project.accepted.camera:
            self._take_up_found(folder, project)
            return
        self._bench.glance(
            jobs.RECALL_CAMERA,
            folder,
            project,
            label=self.tr("Reading the calibration"),
            on_done=lambda recalled: self._recall(folder, project, recalled),
            on_failed=lambda _: self._take_up_found(folder, project),
        )

    def follow(self) -> None:
        """The project is another: show what is known for it, and solve again if its pictures are known."""
        project = self._model.project
        self._list_pictures(project)
        found, solve = _found_key(project), _solve_key(project)
        if found != self._found_key:
            self._found_key, self._solve_key = found, ()
            self.seen = self._seen.get(found)
            if self.seen is None:
                self.calibration, self.judgement, self.problem = None, None, ""
        if self.seen is not None and solve != self._solve_key:
            self._solve_key = solve
            self._solve(self.seen, solve)
        self.changed.emit()

    def search(self) -> None:
        """Find the target in all pictures, then solve."""
        folder, project = self._model.folder, self._model.project
        if folder is None or self.searching or not project.sources.camera:
            return
        key = _found_key(project)
        self.problem = ""
        self.search_task = self._bench.measure(
            jobs.FIND_VIEWS,
            folder,
            project,
            label=self.tr("Camera"),
            on_done=lambda seen: self._searched(folder, key, seen),
            on_failed=lambda problem: self._search_failed(key, problem),
            on_cancelled=lambda: self._search_failed(key, ""),
        )
        self.changed.emit()

    def _searched(self, folder: Path, key: Key, seen: SeenViews) -> None:
        self.search_task = None
        if folder == self._model.folder:
            self._seen[key] = seen
            for solved in [one for one in self._solved if one[: len(key)] == key]:
                del self._solved[solved]
            self._found_key = ()
            self._listed = ""
            self.follow()
            self.searched.emit()
        self.changed.emit()

    def _search_failed(self, key: Key, problem: Any) -> None:
        self.search_task = None
        if key == self._found_key:
            self.problem = _in_words(problem)
        self.changed.emit()

    def _solve(self, seen: SeenViews, key: Key) -> None:
        if key in self._solved:
            self._solved.move_to_end(key)
            self._show(key)
            return
        self.solving = True
        self._bench.quick.run(
            jobs.SOLVE_VIEWS,
            self._model.folder,
            self._model.project,
            seen,
            label=self.tr("Solving the camera"),
            on_done=lambda calibration: self._solved_for(key, calibration, ""),
            on_failed=lambda problem: self._solved_for(key, None, _in_words(problem)),
            replace_waiting=True,
        )

    def _solved_for(self, key: Key, calibration: CameraCalibration | None, problem: str) -> None:
        self._solved[key] = calibration, problem
        while len(self._solved) > KEPT:
            self._solved.popitem(last=False)
        if key == self._solve_key:
            self._show(key)
            self.changed.emit()

    def _show(self, key: Key) -> None:
        self.calibration, self.problem = self._solved[key]
        self.solving = False
        seen = self.seen
        if seen is None:
            return
        self._bench.glance(
            jobs.JUDGE_VIEWS,
            seen,
            self._model.project.options.excluded,
            self.calibration,
            label=self.tr("Judging the views"),
            on_done=lambda judgement: self._judged(key, judgement),
            replace_waiting=True,
        )

    def _judged(self, key: Key, judgement: ViewsJudgement) -> None:
        if key == self._solve_key:
            self.judgement = judgement
            self.changed.emit()

    def _recall(self, folder: Path, project: Project, recalled: RecalledCamera) -> None:
        """The accepted calibration was read; where it is of the pictures in use, it can be solved again at once."""
        if recalled.seen is None:
            self._take_up_found(folder, project)
            return
        if recalled.as_it_is and folder == self._model.folder:
            self._solved[_solve_key(project)] = recalled.calibration, ""
        self._take_up(folder, project, recalled.seen)

    def _take_up_found(self, folder: Path, project: Project) -> None:
        """What was found in the pictures when they were searched last, though nothing made of it was accepted."""
        if not project.sources.camera or folder != self._model.folder:
            return
        self._bench.quick.run(
            jobs.FOUND_VIEWS,
            folder,
            project,
            label=self.tr("Reading what was found"),
            on_done=lambda seen: self._take_up(folder, project, seen),
        )

    def _take_up(self, folder: Path, project: Project, seen: SeenViews | None) -> None:
        key = _found_key(project)
        if folder == self._model.folder and seen is not None and key not in self._seen:
            self._seen[key] = seen
            self._found_key = ()
            self.follow()

    def _list_pictures(self, project: Project) -> None:
        stored, folder = project.sources.camera, folder_of(self._model, "camera")
        wanted = f"{stored}|{project.rig.channel}"
        if wanted == self._listed:
            return
        if wanted != self._thumbnails_of:
            self.pictures, self.thumbnails = None, {}
        self._listed = self._thumbnails_of = wanted
        if folder is None:
            self.pictures = ()
            return

        def listed(paths: tuple[Path, ...]) -> None:
            if self._listed == wanted:
                self.pictures = paths
                self._make_thumbnails(wanted, list(paths))
                self.changed.emit()

        self._bench.glance(jobs.LIST_PICTURES, folder, label=self.tr("Listing pictures"), on_done=listed, offers={})

    def _make_thumbnails(self, wanted: str, left: list[Path]) -> None:
        now, later = left[:AT_ONCE], left[AT_ONCE:]
        if not now or wanted != self._listed:
            return

        def made(pictures: tuple[Any, ...]) -> None:
            if wanted != self._listed:
                return
            self.thumbnails.update(
                {f"camera/{path.name}": picture for path, picture in zip(now, pictures, strict=True)}
            )
            self.changed.emit()
            self._make_thumbnails(wanted, later)

        self._bench.glance(
            jobs.THUMBNAILS, now, self._model.project.rig.channel, label=self.tr("Small pictures"), on_done=made
        )


def _found_key(project: Project) -> Key:
    keys = rests_on("camera", project, {})
    return tuple(keys[name] for name in FOUND_BY)


def _solve_key(project: Project) -> Key:
    keys = rests_on("camera", project, {})
    kept = [value for name, value in keys.items() if name not in (*FOUND_BY, "accepted camera calibration")]
    return (*_found_key(project), *kept)


def _in_words(problem: Any) -> str:
    """A problem as a sentence of its own; where it is, the page itself shows."""
    if not isinstance(problem, InputError) or problem.where not in ("", "camera"):
        return str(problem)
    text = f"{problem.what}; {problem.todo}." if problem.todo else f"{problem.what}."
    return text[:1].upper() + text[1:]
