"""What is known of a calibration's pictures: found, solved; kept for every state that undo may come back to."""

from __future__ import annotations

from abc import abstractmethod
from collections import OrderedDict
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Generic, Literal, TypeVar

from PySide6.QtCore import QObject, Signal

from core.files.project.data import Project
from core.files.project.keys import ACCEPTED, FOUND_BY, inputs_of
from core.messages import Message
from workbench.bench import Bench
from workbench.language import text_of, tr
from workbench.pages.sources import folder_of
from workbench.work import jobs
from workbench.work.jobs import Job
from workbench.work.tasks import Task

AT_ONCE = 6
"""So many thumbnails are made in one go, so that what the eye waits for comes between."""

KEPT = 12
"""So many solutions are kept for undo and redo."""

Key = tuple[str, ...]
Found = TypeVar("Found")
Solution = TypeVar("Solution")


class StepPictures(QObject):
    """Pictures of a step: `paths`, None until they are listed; `thumbnails` by the name that `named` gives a path.

    A path whose name is "" is no picture of its own and is left out.
    """

    changed = Signal()

    def __init__(
        self,
        bench: Bench,
        step: Literal["camera", "planes"],
        named: Callable[[Path], str],
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._bench, self._model, self._step, self._named = bench, bench.model, step, named
        self.forget()

    def forget(self) -> None:
        """Drop the list of pictures and thumbnails, as another project is open."""
        self.paths: tuple[Path, ...] | None = None
        self.thumbnails: dict[str, Any] = {}
        self._listed = self._thumbnails_of = ""
        self._told: set[str] = set()

    def follow(self) -> None:
        """List the step's pictures in the background, unless the list is of this project's state already."""
        project, folder = self._model.project, folder_of(self._model, self._step)
        of = f"{getattr(project.sources, self._step)}|{project.rig.channel_of(self._step)}|{project.rig.mosaic}"
        if of == self._listed:
            return
        if of != self._thumbnails_of:
            self.paths, self.thumbnails = None, {}
        self._listed = self._thumbnails_of = of
        if folder is None:
            self.paths = ()
            return

        def listed(paths: Sequence[Path]) -> None:
            if self._listed == of:
                self.paths = tuple(path for path in paths if self._named(path))
                self._make_thumbnails(of, self.paths)
                self.changed.emit()

        label = tr("Listing pictures")
        self._bench.run_quick(self, jobs.LIST_PICTURES, folder, label=label, on_done=listed, offers={})
        self._bench.run_quick(self, jobs.NOT_READ, folder, label=label, on_done=self._tell_left_out, offers={})

    def _tell_left_out(self, notes: Sequence[Message]) -> None:
        """Say once which files of the folder are of a kind that is not read."""
        for told in map(text_of, notes):
            if told not in self._told:
                self._told.add(told)
                self._bench.notices.warning(told)

    def list_again(self) -> None:
        """List the pictures in the folder again; the old list stays until the new one is ready."""
        self._listed = ""
        self.follow()

    def _make_thumbnails(self, of: str, left: tuple[Path, ...]) -> None:
        now, later = left[:AT_ONCE], left[AT_ONCE:]
        if not now or of != self._listed:
            return

        def made(pictures: Sequence[Any]) -> None:
            if of == self._listed:
                self.thumbnails.update({self._named(p): picture for p, picture in zip(now, pictures, strict=True)})
                self.changed.emit()
                self._make_thumbnails(of, later)

        self._bench.run_quick(
            self,
            jobs.THUMBNAILS,
            list(now),
            self._model.project.rig.channel_of(self._step),
            self._model.project.rig.mosaic,
            label=tr("Small pictures"),
            on_done=made,
        )


class CalibrationWork(QObject, Generic[Found, Solution]):
    """Worker that finds the content of one step's pictures (`Found`), and solves (`Solution`).

    `found` and `calibration` are of the project as it is, or None; while a new solution is on its way (`solving`) the
    last one stands. `problem` says why there is none. What finding rests on is `FOUND_BY`; solving rests on all of the
    step's other keys, too, but for `ACCEPTED`.
    """

    changed = Signal()
    searched = Signal()

    STEP: Literal["camera", "planes"]
    FIND: Job
    SOLVE: Job
    FOUND: Job
    """Says what was found in the pictures when they were searched last."""

    def __init__(self, bench: Bench, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._bench, self._model = bench, bench.model
        self._pictures = StepPictures(bench, self.STEP, self.name_of, self)
        self._pictures.changed.connect(self.changed)
        self._forget()

    def _forget(self) -> None:
        self.found: Found | None = None
        self.calibration: Solution | None = None
        self.problem = ""
        self.solving = False
        self.search_task: Task | None = None
        self._refused: tuple[Key, Any] = (), None
        """What the last search that failed rested on, and what it failed with."""
        self._found: dict[Key, Found] = {}
        self._solved: OrderedDict[Key, tuple[Solution | None, str]] = OrderedDict()
        self._found_key: Key = ()
        self._solve_key: Key = ()
        self._pictures.forget()

    @staticmethod
    @abstractmethod
    def name_of(path: Path) -> str:
        """Return the name in the project of the picture at `path`; "" for the second picture of a pose."""

    @abstractmethod
    def _recall(self, folder: Path, project: Project) -> None:
        """Ask for what was found in the pictures, and made of it, before the project was opened."""

    @abstractmethod
    def _can_search(self, project: Project) -> bool:
        """Whether all that finding needs is there."""

    @abstractmethod
    def _labels(self) -> tuple[str, str]:
        """What the tasks that find and solve are called."""

    @abstractmethod
    def left_out(self) -> dict[str, Message]:
        """Return the reason, by picture name, why a picture shows nothing usable."""

    def _in_words(self, problem: Any) -> str:
        return text_of(problem)

    def _calibration_changed(self) -> None:
        """Another calibration is shown, or none."""

    @property
    def pictures(self) -> tuple[Path, ...] | None:
        """Paths of the step's pictures; None until they are listed."""
        return self._pictures.paths

    @property
    def thumbnails(self) -> dict[str, Any]:
        """Thumbnails of the step's pictures, by picture name."""
        return self._pictures.thumbnails

    @property
    def searching(self) -> bool:
        """Whether the target is being searched in the pictures."""
        return self.search_task is not None

    def opened(self) -> None:
        """Drop all results, list the pictures of the project now open, and read its earlier results."""
        if self.search_task is not None:
            self.search_task.cancel()
        self._forget()
        if self._model.is_open:
            self.follow()
            self.recall()

    def recall(self) -> None:
        """Read earlier results of the search from the project, unless they are known or being read."""
        folder, project = self._model.folder, self._model.project
        if folder is not None and self.found is None and not self.searching:
            self._recall(folder, project)

    def follow(self) -> None:
        """Show the results that are known for the changed project, and solve again if the search is done."""
        project = self._model.project
        self._pictures.follow()
        found, solve = self.found_key(project), self.solve_key(project)
        if found != self._found_key:
            self._found_key, self._solve_key = found, ()
            self.found = self._found.get(found)
            if self.found is None:
                self.calibration, self.problem = None, ""
                self._calibration_changed()
        if self.found is None:
            self.solving = False
        elif solve != self._solve_key:
            self._solve_key = solve
            self._solve(solve)
        self.changed.emit()

    def search(self) -> None:
        """Search the target in all pictures in the background, then solve the calibration."""
        folder, project = self._model.folder, self._model.project
        if folder is None or self.searching or not self._can_search(project):
            return
        key = self.found_key(project)
        self.problem = ""
        self.search_task = self._bench.run_long(
            self,
            self.FIND,
            folder,
            project,
            label=self._labels()[0],
            on_done=lambda found: self._search_done(folder, key, found),
            on_failed=lambda problem: self._search_failed(folder, key, problem),
            on_cancelled=lambda: self._search_failed(folder, key, None),
        )
        self.changed.emit()

    def found_key(self, project: Project) -> Key:
        """Return a key of all inputs of the search in `project`: equal keys give equal results."""
        keys = inputs_of(self.STEP, project, {})
        return tuple(keys.get(name, "") for name in FOUND_BY[self.STEP])

    def solve_key(self, project: Project) -> Key:
        """Return a key of all inputs of the solution in `project`: equal keys give equal results."""
        keys = inputs_of(self.STEP, project, {})
        known = (*FOUND_BY[self.STEP], ACCEPTED[self.STEP])
        others = [value for name, value in keys.items() if name not in known]
        return (*self.found_key(project), *others)

    def _search_done(self, folder: Path, key: Key, found: Found) -> None:
        if folder != self._model.folder:
            return  # the project has been left; another one may be searched by now
        self.search_task = None
        for solved in [one for one in self._solved if one[: len(key)] == key]:
            del self._solved[solved]
        self._found[key], self._found_key = found, ()
        self._pictures.list_again()
        self.follow()
        self.searched.emit()
        self.changed.emit()

    def _search_failed(self, folder: Path, key: Key, problem: Any) -> None:
        if folder != self._model.folder:
            return
        self.search_task, self._refused = None, (key, problem)
        if key == self._found_key:
            self.problem = "" if problem is None else self._in_words(problem)
        self.changed.emit()

    def _ask_what_was_found(self, folder: Path, project: Project) -> None:
        """What was found in the pictures when they were searched last, though nothing made of it was accepted."""
        if self._can_search(project) and folder == self._model.folder:
            self._bench.quick.run(
                self,
                self.FOUND,
                folder,
                project,
                label=tr("Reading what was found"),
                on_done=lambda found: self._take_up(folder, project, found),
            )

    def _take_up(
        self, folder: Path, project: Project, found: Found | None, calibration: Solution | None = None
    ) -> None:
        """What the pictures of `project` show is known, and perhaps the `calibration` solved from it.

        It is of no interest where they were searched since, or the project was left.
        """
        key = self.found_key(project)
        if folder != self._model.folder or not found or key in self._found:
            return
        if calibration is not None:
            self._solved[self.solve_key(project)] = calibration, ""
        self._found[key], self._found_key = found, ()
        self.follow()

    def _solve(self, key: Key) -> None:
        if key in self._solved:
            self._solved.move_to_end(key)
            self._show(key)
            return
        self.solving = True
        self._bench.quick.run(
            self,
            self.SOLVE,
            self._model.folder,
            self._model.project,
            self.found,
            label=self._labels()[1],
            on_done=lambda calibration: self._solved_for(key, calibration, ""),
            on_failed=lambda problem: self._solved_for(key, None, self._in_words(problem)),
            replace_waiting=True,
        )

    def _solved_for(self, key: Key, calibration: Solution | None, problem: str) -> None:
        self._solved[key] = calibration, problem
        while len(self._solved) > KEPT:
            self._solved.popitem(last=False)
        if key == self._solve_key:
            self._show(key)
            self.changed.emit()

    def _show(self, key: Key) -> None:
        self.calibration, self.problem = self._solved[key]
        self.solving = False
        self._calibration_changed()
