"""What is known of the pictures of the plate under the fan: measured, solved; kept for every state of undo."""

from __future__ import annotations

from collections import OrderedDict
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Signal

from core.calibrate.pose_features import PoseFeatures
from core.calibrate.results import FanCalibration
from core.files.project import Project
from core.files.project_keys import rests_on
from workbench import jobs
from workbench.bench import Bench
from workbench.pages.sources import folder_of
from workbench.problems import sentence
from workbench.tasks import Task

MEASURED_BY = ("camera calibration", "pictures of the plane target", "plane target", "colour channel")
"""What measuring the poses rests on; solving rests on the laser, the left-out poses and the constraint too."""

KEPT = 12
"""So many solutions are kept for undo and redo."""

AT_ONCE = 6
"""So many thumbnails are made in one go, so that what the eye waits for comes between."""

Key = tuple[str, ...]
Poses = tuple[PoseFeatures, ...]


class PlanesWork(QObject):
    """Measures the poses and solves the light planes.

    `poses` and `calibration` are of the project as it is, or None; while a new solution is on its way (`solving`) the
    last one stands. `problem` says why there is none.
    """

    changed = Signal()

    def __init__(self, bench: Bench, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._bench, self._model = bench, bench.model
        self._forget()

    def _forget(self) -> None:
        self.pictures: tuple[Path, ...] | None = None
        self.poses: Poses | None = None
        self.calibration: FanCalibration | None = None
        self.problem = ""
        self.solving = False
        self.measure_task: Task | None = None
        self.thumbnails: dict[str, Any] = {}
        self._measured: dict[Key, Poses] = {}
        self._solved: OrderedDict[Key, tuple[FanCalibration | None, str]] = OrderedDict()
        self._measured_key: Key = ()
        self._solve_key: Key = ()
        self._listed = self._thumbnails_of = ""

    @property
    def measuring(self) -> bool:
        """Whether the pictures are being measured."""
        return self.measure_task is not None

    def opened(self) -> None:
        """Another project: forget, list its pictures, and take up what has been found in them."""
        if self.measure_task is not None:
            self.measure_task.cancel()
        self._forget()
        folder, project = self._model.folder, self._model.project
        if folder is None:
            return
        self.follow()
        done, keys = self._model.results.get("planes"), rests_on("planes", project, {})
        known = {} if done is None else done.rests_on
        measured, solve = _measured_key(project), _solve_key(project)
        if project.accepted.fan and all(keys.get(name) == known.get(name) for name in MEASURED_BY):
            self._bench.glance(
                jobs.RECALL_POSES,
                folder,
                project,
                label=self.tr("Reading the laser planes"),
                on_done=lambda found: self._recalled(folder, measured, solve, *found),
            )
        elif project.accepted.camera and project.sources.planes:
            self._bench.quick.run(
                jobs.FOUND_POSES,
                folder,
                project,
                label=self.tr("Reading what was found"),
                on_done=lambda poses: self._found(folder, measured, poses),
            )

    def follow(self) -> None:
        """The project is another: show what is known for it, and solve again if its poses are known."""
        project = self._model.project
        self._list_pictures(project)
        measured, solve = _measured_key(project), _solve_key(project)
        if measured != self._measured_key:
            self._measured_key, self._solve_key = measured, ()
            self.poses = self._measured.get(measured)
            if self.poses is None:
                self.calibration, self.problem = None, ""
        if self.poses is None:
            self.solving = False
        elif solve != self._solve_key:
            self._solve_key = solve
            self._solve(self.poses, solve)
        self.changed.emit()

    def measure(self) -> None:
        """Find target and stripes in all pictures, then solve."""
        folder, project = self._model.folder, self._model.project
        if folder is None or self.measuring or not project.sources.planes or not project.accepted.camera:
            return
        key = _measured_key(project)
        self.problem = ""
        self.measure_task = self._bench.measure(
            jobs.FIND_POSES,
            folder,
            project,
            label=self.tr("Laser planes"),
            on_done=lambda poses: self._poses_measured(folder, key, poses),
            on_failed=lambda problem: self._measuring_failed(folder, key, sentence(problem)),
            on_cancelled=lambda: self._measuring_failed(folder, key, ""),
        )
        self.changed.emit()

    def _poses_measured(self, folder: Path, key: Key, poses: Poses) -> None:
        if folder == self._model.folder:
            self.measure_task = None
            self._remember(key, poses)
            self.changed.emit()

    def _recalled(self, folder: Path, measured: Key, solve: Key, poses: Poses, calibration: FanCalibration) -> None:
        if folder == self._model.folder and measured not in self._measured:
            self._solved[solve] = calibration, ""
            self._measured[measured] = poses
            self._measured_key = ()
            self.follow()

    def _found(self, folder: Path, key: Key, poses: Poses) -> None:
        """What was found in the pictures when they were measured last, though nothing made of it was accepted."""
        if poses and folder == self._model.folder and key not in self._measured:
            self._measured[key] = poses
            self._measured_key = ()
            self.follow()

    def _remember(self, key: Key, poses: Poses) -> None:
        self._measured[key] = poses
        for solved in [one for one in self._solved if one[: len(key)] == key]:
            del self._solved[solved]
        self._measured_key, self._listed = (), ""
        self.follow()

    def _measuring_failed(self, folder: Path, key: Key, problem: str) -> None:
        if folder != self._model.folder:
            return  # the project has been left; another one may be measured by now
        self.measure_task = None
        if key == self._measured_key:
            self.problem = problem
        self.changed.emit()

    def _solve(self, poses: Poses, key: Key) -> None:
        if key in self._solved:
            self._solved.move_to_end(key)
            self._show(key)
            return
        self.solving = True
        self._bench.quick.run(
            jobs.SOLVE_POSES,
            self._model.folder,
            self._model.project,
            poses,
            label=self.tr("Solving the laser planes"),
            on_done=lambda calibration: self._solved_for(key, calibration, ""),
            on_failed=lambda problem: self._solved_for(key, None, sentence(problem)),
            replace_waiting=True,
        )

    def _solved_for(self, key: Key, calibration: FanCalibration | None, problem: str) -> None:
        self._solved[key] = calibration, problem
        while len(self._solved) > KEPT:
            self._solved.popitem(last=False)
        if key == self._solve_key:
            self._show(key)
            self.changed.emit()

    def _show(self, key: Key) -> None:
        self.calibration, self.problem = self._solved[key]
        self.solving = False

    def _list_pictures(self, project: Project) -> None:
        wanted, folder = f"{project.sources.planes}|{project.rig.channel}", folder_of(self._model, "planes")
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
                self.pictures = tuple(path for path in paths if not path.stem.endswith("_off"))
                self._make_thumbnails(wanted, list(self.pictures))
                self.changed.emit()

        self._bench.glance(jobs.LIST_PICTURES, folder, label=self.tr("Listing pictures"), on_done=listed, offers={})

    def _make_thumbnails(self, wanted: str, left: list[Path]) -> None:
        now, later = left[:AT_ONCE], left[AT_ONCE:]
        if not now or wanted != self._listed:
            return

        def made(pictures: tuple[Any, ...]) -> None:
            if wanted == self._listed:
                self.thumbnails.update({path.stem: picture for path, picture in zip(now, pictures, strict=True)})
                self.changed.emit()
                self._make_thumbnails(wanted, later)

        self._bench.glance(
            jobs.THUMBNAILS, now, self._model.project.rig.channel, label=self.tr("Small pictures"), on_done=made
        )


def _measured_key(project: Project) -> Key:
    keys = rests_on("planes", project, {})
    return tuple(keys[name] for name in MEASURED_BY)


def _solve_key(project: Project) -> Key:
    keys = rests_on("planes", project, {})
    kept = [value for name, value in keys.items() if name not in (*MEASURED_BY, "accepted laser planes")]
    return (*_measured_key(project), *kept)
