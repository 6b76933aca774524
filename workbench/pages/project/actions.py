"""What is done with projects as a whole: new, open, from a set or other pictures, sample, simulated rig, close."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtWidgets import QWidget

from core.acquire.source import Step
from core.errors import InputError
from core.files.film import is_film
from core.files.project.data import Project, ProjectFile, new_project, new_project_without_fan
from core.files.project.folder import (
    OPENER,
    can_be_saved,
    free_folder,
    is_project,
    project_from_set,
    read_project,
    rescues,
)
from core.files.recording.rig import Rig
from core.files.recording.unfinished import Unfinished, forget_recording, unfinished_recording
from core.simulate.sample import simulated_project
from workbench.bench import Bench
from workbench.language import printed, text_of, tr
from workbench.pages.live.settings import choose_own, choose_simulated
from workbench.pages.project.copies import PACKED, ProjectCopies
from workbench.pages.project.import_dialog import ImportDialog
from workbench.pages.project.sample import SampleProject
from workbench.pages.project.states import StateChoice, choose_access, choose_state
from workbench.pages.sources import put_source
from workbench.project_model import Access
from workbench.views import ask
from workbench.work import jobs
from workbench.work.tasks import Task

PROJECT, BACKUPS, SET = "project.json", "backups", "rig.toml"
CORNER = "corner.pdf"
"""Sheets to print of a project without a fan, beside its project.json."""


class ProjectActions(QObject):
    """Actions that open and close projects; they ask only where something could be lost."""

    go_to = Signal(str)
    first_measurement_begun = Signal()
    """Its project is open: the instructions can be shown."""

    def __init__(self, bench: Bench, window: QWidget) -> None:
        super().__init__(window)
        self.bench, self.model, self._window = bench, bench.model, window
        self.sample = SampleProject(bench, self._open_at_result, self)
        self.copies = ProjectCopies(bench, window, self.save, self.close_project, self.open_project, self._open)
        self._when_left: Callable[[], object] | None = None
        self._preparing: Task | None = None
        # Queued: a recording that ends is at its end then, and not in the midst of telling it.
        self.model.recordings_over.connect(self._recordings_over, Qt.ConnectionType.QueuedConnection)

    def new_project(self) -> None:
        """Ask for name, folder and lasers, and make an empty project for the user's own rig."""
        ways = tr("Lasers"), (tr("Three-line laser and line laser"), tr("Line laser and two printed sheets"))
        title = tr("New project")
        answer = ask.ask_new_project(self._window, title, title, self.bench.settings.projects_folder, ways)
        if answer is None:
            return
        name, folder, way = answer
        self.bench.settings.projects_folder = folder
        place = folder / ask.file_name(name)
        if not way:
            self._create(place, new_project, name, partial(choose_own, self.bench.settings))
            return

        def begun() -> None:
            choose_own(self.bench.settings)
            model, sheets = self.model, place / CORNER

            def drawn(rig: Rig) -> None:
                if model.folder == place:
                    model.edit(tr("state the boards of the corner"), replace(model.project, rig=rig))
                self.bench.notices.info(
                    tr("Print both sheets of {file} at 100 % and join them to a corner behind the part.", file=sheets)
                )

            self.bench.run_quick(
                self,
                jobs.CORNER_SHEETS,
                model.project.rig,
                model.project.report.paper,
                sheets,
                label=tr("Drawing the sheets to print"),
                on_done=drawn,
                offers={},
            )

        self._create(place, new_project_without_fan, name, begun)

    def choose_project(self) -> None:
        """Ask for the folder of a project, and open the project."""
        folder = ask.choose_folder(self._window, tr("Open a project folder"), self.bench.settings.projects_folder)
        if folder is not None:
            self.open_dropped(folder)

    def choose_set(self) -> None:
        """Ask for a recording set, and make a project that measures it."""
        folder = ask.choose_folder(self._window, tr("Choose a recording set (a folder with rig.toml)"), Path.home())
        if folder is not None:
            self.open_dropped(folder)

    def import_pictures(self) -> None:
        """Ask where pictures of another program are, make a recording set of them, and a project of that.

        The open project measures its parts then; without one, a project that does is made.
        """
        self._import(None)

    def _import(self, film: Path | None) -> None:
        """Ask where pictures are; a film that is named is that of a scan."""
        folder = self.model.folder
        base, name = (folder, "imported") if folder is not None else (self.bench.settings.projects_folder, "set")
        dialog = ImportDialog(self.bench, free_folder(base, name), self._window, film)
        dialog.imported.connect(lambda imported, plan: self._use_imported(imported.folder, tuple(plan.parts), folder))
        dialog.open()

    def _use_imported(self, imported: Path, parts: tuple[str, ...], asked_in: Path | None) -> None:
        if asked_in != self.model.folder:
            self.bench.notices.info(tr("The pictures are in {folder}.", folder=imported))
            return
        if self.model.folder is not None:
            self._put_parts(imported, parts)
        elif (imported / SET).exists():
            self.open_set(imported)
        else:
            name = tr("New project from {name}", name=imported.name)
            self._make(name, imported.name, new_project, then=lambda: self._put_parts(imported, parts))

    def _put_parts(self, imported: Path, parts: tuple[str, ...]) -> None:
        steps: tuple[Step, ...] = ("camera", "planes", "scan", "check")
        for step in steps:
            if step in parts:
                put_source(self.model, step, imported / step, tr("use imported pictures"))
        self.go_to.emit("scan" if parts[0] == "check" else parts[0])

    def open_dropped(self, path: Path) -> None:
        """Open a dropped file or folder: a project, a packed one, an earlier version, a recording set, or a film."""
        path = path.resolve()
        if path.suffix == OPENER and not path.is_dir():
            path = path.parent
        if path.suffix.lower() == PACKED and path.is_file():
            self.copies.unpack(path)
        elif is_project(path) or rescues(path):
            self.open_project(path)
        elif path.is_file() and path.parent.name == BACKUPS and is_project(path.parent.parent):
            self.open_version(path)
        elif (path / SET).exists() or path.name == SET:
            self.open_set(path.parent if path.name == SET else path)
        elif path.is_file() and is_film(path):
            self._import(path)
        else:
            self.bench.notices.error(
                tr("{path}: is neither a project (project.json) nor a recording set (rig.toml).", path=path)
            )

    def open_project(self, path: Path) -> None:
        """Open a project; ask first if there are autosaved changes or project.json is damaged."""
        folder = (path.parent if path.name == PROJECT else path).resolve()
        if folder == self.model.folder:
            return
        access = choose_access(self._window, folder)
        if access is None:
            return
        try:  # what somebody else has not saved yet is not to be recovered
            wanted = StateChoice() if access is Access.READ_ONLY else choose_state(self._window, folder)
        except InputError as error:
            self.bench.notices.failed(error)
            return
        if wanted is not None:
            self._open(folder, wanted.version, recover=wanted.recover, access=access)

    def open_version(self, path: Path) -> None:
        """Open a project as one of its backups has it; saving makes that version the present one."""
        try:
            version = read_project(path)
        except InputError as error:
            self.bench.notices.failed(error)
            return
        text = tr("This is an earlier version; once it is saved, the present one is among the backups.")
        folder = path.parent.parent
        access = Access.ALONE if folder == self.model.folder else choose_access(self._window, folder)
        if access is not None:
            self._open(folder, version, access=access, then=lambda: self.bench.notices.info(text))

    def open_set(self, folder: Path) -> None:
        """Make a project that measures the recording set in `folder`, without copying it."""
        self._make(
            tr("New project from {name}", name=folder.name),
            folder.resolve().name,
            lambda name: project_from_set(folder, name),
        )

    def open_sample(self) -> None:
        """Open the finished sample project, which is measured first if that was never done."""
        self.sample.open()

    def _open_at_result(self, folder: Path) -> None:
        """Open a project where its result is to be seen, if it has been inspected."""
        self.open_project(folder)
        if self.model.folder == folder.resolve() and "gauge" in self.model.results:
            self.go_to.emit("inspect")

    def try_simulated(self) -> None:
        """Make a new project whose live source is the simulated rig."""
        self._try_simulated(simulated_project)

    def try_simulated_without_fan(self) -> None:
        """Make a new project whose live source is the simulated rig with a line laser and two printed boards."""
        self._try_simulated(partial(simulated_project, has_fan=False))

    def _try_simulated(self, project: Callable[[str], Project]) -> None:
        choose_simulated(self.bench.settings)
        folder = free_folder(self.bench.settings.projects_folder, tr("Simulated rig"))
        self._create(folder, project, folder.name, then=lambda: self.go_to.emit("camera"))

    def begin_first_measurement(self) -> None:
        """Begin the first measurement by a three-line laser and a line laser."""
        self._begin_first_measurement(has_fan=True)

    def begin_first_measurement_without_fan(self) -> None:
        """Begin the first measurement by a line laser and two printed boards."""
        self._begin_first_measurement(has_fan=False)

    def _begin_first_measurement(self, *, has_fan: bool) -> None:
        """Make a new project of the sample's pictures with nothing measured, for the step-by-step instructions.

        If another project is opened while the pictures are rendered, it stays open.
        """
        name, asked_in = tr("First measurement"), self.model.folder
        if self._preparing is not None:
            self.bench.notices.info(tr("Its pictures are being prepared; the status bar says how far that is."))
            return

        def make(project: Project) -> None:
            self._prepared()
            if self.model.folder != asked_in:
                self.bench.notices.info(tr("The pictures are ready: Help, First measurement."))
                return
            made = replace(project, info=replace(project.info, operator=""))
            folder = free_folder(self.bench.settings.projects_folder, name)
            self._create(folder, lambda _: made, folder.name, then=self.first_measurement_begun.emit)

        self._preparing = self.bench.run_long(
            self,
            jobs.SAMPLE_TO_MEASURE,
            printed(),
            has_fan,
            label=tr("Preparing the first measurement"),
            on_done=make,
            on_failed=self._prepared,
            on_cancelled=self._prepared,
        )

    def _prepared(self, *_: Any) -> None:
        self._preparing = None

    def begin_next_part(self) -> None:
        """Make the project of the next part of the series, and show its scan page."""
        self.copies.next_part(lambda: self.go_to.emit("scan"))

    def save(self) -> bool:
        """Save the project, with fields still being edited; False if it could not be saved."""
        self._take_typed()
        try:
            self.model.save()
        except InputError as error:
            self.bench.notices.failed(error)
            return False
        return True

    def close_project(self, then: Callable[[], object] = lambda: None) -> None:
        """Save and close the project, then call `then`; neither if the user cancels."""

        def close() -> None:
            self.bench.measuring.cancel_all()
            self.model.close()
            then()

        if self.model.is_open:
            self.leave(close)
        else:
            then()

    def leave(self, then: Callable[[], object]) -> None:
        """Save the project, end a recording, then call `then`; not if the user cancels.

        Asks if something runs, or cannot be saved. While a recording ends the window takes no input.
        """
        if self._when_left is not None:
            return
        self._when_left = then
        if not self._may_stop():
            self._when_left = None
            return
        self._take_typed()
        self.model.leaving.emit()
        if self.model.is_recording:
            self._window.setEnabled(False)
        else:
            self._recordings_over()

    def _recordings_over(self) -> None:
        """Nothing records any more: if that was waited for, save and go on."""
        if self._when_left is None or self.model.is_recording:
            return
        self._window.setEnabled(True)
        saved = self._saved()
        then, self._when_left = self._when_left, None
        if saved:
            then()

    def _may_stop(self) -> bool:
        """Whether what runs may be stopped: asks if anything does."""
        job = self.bench.measuring.current
        running = [tr("A recording is running.")] if self.model.is_recording else []
        if job is not None:
            running.append(tr("A job is not finished yet: {job}.", job=job.label))
        if not running:
            return True
        text = tr("{running} What is recorded is kept. Stop it and leave?", running=" ".join(running))
        answers = [tr("Stop and leave"), tr("Stay")]
        return ask.ask(self._window, tr("Leave the project"), text, answers) == 0

    def _saved(self) -> bool:
        """Save; False if that cannot be done, and the changes are not to be lost."""
        if not self.model.is_modified:
            self.model.autosave()  # nothing is left that could be offered for recovery
            return True
        if self.save():
            return True
        text = tr("The project cannot be saved. Leave and lose the changes?")
        answers = [tr("Leave without saving"), tr("Stay")]
        return ask.ask(self._window, tr("Leave the project"), text, answers) == 0

    def _take_typed(self) -> None:
        """What is being typed counts, too: an editor tells its text when it loses the focus."""
        editor = self._window.focusWidget()
        if editor is not None and editor.hasFocus():
            editor.clearFocus()
            editor.setFocus()

    def _open(
        self,
        folder: Path,
        version: ProjectFile | None = None,
        *,
        recover: bool = False,
        access: Access = Access.ALONE,
        then: Callable[[], object] = lambda: None,
    ) -> None:
        """Open a project, the one that is open being closed before, `then` go on."""

        def open_() -> None:
            try:
                self.model.open(folder, recover=recover, version=version, access=access)
            except InputError as error:
                self.bench.notices.failed(error)
                return
            self.bench.settings.remember(folder)
            if not can_be_saved(folder):
                self.copies.offer_copy()
            if (refused := self.model.why_read_only()) is not None:
                self.bench.notices.warning(text_of(refused))
            elif (unfinished := unfinished_recording(folder)) is not None:
                self._offer(folder, unfinished)
            then()

        self.close_project(open_)

    def _offer(self, folder: Path, unfinished: Unfinished) -> None:
        """A recording was cut short by a crash: its pictures are whole, and may be used."""
        what = {
            "camera": tr("Views of the camera's target were being recorded when the program ended."),
            "planes": tr("Poses of the plate were being recorded when the program ended."),
            "scan": tr("A scan was being recorded when the program ended."),
            "check": tr("Pictures of the check were being taken when the program ended."),
        }[unfinished.step]
        kept = tr(
            "{count} pictures are kept in {folder}. Use them?", count=unfinished.pictures, folder=unfinished.folder
        )
        text = f"{what} {kept}"
        answers = [tr("Use them"), tr("Leave them there")]
        if ask.ask(self._window, tr("Interrupted recording"), text, answers) == 0:
            put_source(self.model, unfinished.step, unfinished.folder, tr("use an interrupted recording"))
            self.go_to.emit("scan" if unfinished.step == "check" else unfinished.step)
        else:
            self.bench.notices.info(tr("The pictures are in {folder}.", folder=unfinished.folder))
        try:
            forget_recording(folder)
        except InputError as error:
            self.bench.notices.failed(error)

    def _make(
        self,
        title: str,
        name: str,
        project: Callable[[str], Project],
        then: Callable[[], object] = lambda: None,
    ) -> None:
        answer = ask.ask_name_and_folder(self._window, title, name, self.bench.settings.projects_folder)
        if answer is None:
            return
        name, folder = answer
        self.bench.settings.projects_folder = folder
        self._create(folder / ask.file_name(name), project, name, then)

    def _create(
        self, folder: Path, project: Callable[[str], Project], name: str, then: Callable[[], object] = lambda: None
    ) -> None:
        """Make a project and open it, the one that is open being closed before, `then` go on."""

        def create() -> None:
            try:
                self.model.create(folder, replace(made, info=replace(made.info, name=name)))
            except InputError as error:
                self.bench.notices.failed(error)
                return
            self.bench.settings.remember(folder)
            then()

        try:
            made = project(name)
        except InputError as error:
            self.bench.notices.failed(error)
            return
        self.close_project(create)
