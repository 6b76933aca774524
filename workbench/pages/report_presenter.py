"""Decisions of the report page: what is in the report, and what is handed over beside it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from PySide6.QtCore import Signal

from core.files.project import Project
from core.files.project_keys import finished
from core.report.content import SECTIONS
from workbench import jobs
from workbench.bench import Bench
from workbench.pages.presenter import StepPresenter
from workbench.step_state import State, step_states
from workbench.tasks import Task

PAGE_WIDTH_PX = 1000


class ReportPresenter(StepPresenter):
    """Preview, sections, paper, export."""

    step = "report"
    pages_ready = Signal(object)
    exported = Signal(object)

    def __init__(self, bench: Bench) -> None:
        super().__init__(bench)
        self.pages: tuple[Any, ...] = ()
        self.problem = ""
        self._preview: Task | None = None
        self._previewed: Project | None = None
        self._visible = False

    @property
    def previewing(self) -> bool:
        """Whether the pages are being drawn."""
        return self._preview is not None

    def sections(self) -> list[tuple[str, str, bool]]:
        """Name, title, and whether it is in the report, of each section that can be left out."""
        return [(name, title, name not in self.project.report.hidden) for name, title in SECTIONS.items()]

    def choose_section(self, name: str, shown: bool) -> None:
        """Put a section in or leave it out; undoable."""
        hidden = self.project.report.hidden - {name} if shown else self.project.report.hidden | {name}
        label = self.tr("put in “{0}”") if shown else self.tr("leave out “{0}”")
        report = replace(self.project.report, hidden=frozenset(hidden))
        self.model.edit(label.format(SECTIONS[name]), replace(self.project, report=report))

    def choose_paper(self, paper: Any) -> None:
        """A4 or Letter; undoable."""
        report = replace(self.project.report, paper=paper)
        self.model.edit(self.tr("print on {0}").format(paper), replace(self.project, report=report))

    def ready(self) -> bool:
        """Whether there is something to report."""
        return "scan" in self.model.results

    def blocker(self) -> str:
        return "" if self.ready() else self.tr("Scan the part first; then there is something to report.")

    def warning(self) -> str:
        """What is out of date in the results the report would print, or ""."""
        states = step_states(self.project, self.model.results)
        for step in ("scan", "inspect"):
            if states[step].state is State.OUTDATED:
                titles = {"scan": self.tr("Scan"), "inspect": self.tr("Inspect")}
                return self.tr("{0}: {1}").format(titles[step], states[step].sentence)
        return ""

    def do_run(self) -> None:
        """Make the report into the project's results."""
        if not self.ready() or self.model.folder is None:
            return
        project = self.project

        def done(path: Path) -> None:
            self.model.record("report", finished("report", project, self.model.results))
            self.bench.notices.info(self.tr("The report is {0}.").format(path))
            self.exported.emit(path)

        self.bench.measure(
            jobs.MAKE_REPORT, self.model.folder, project, label=self.tr("Making the report"), on_done=done
        )

    def export(self, kind: str, path: Path) -> None:
        """Write a copy for others: "pdf", "cloud", "mesh", "stl", "csv" or "json"."""
        if self.model.folder is None:
            return

        def done(written: Path) -> None:
            self.bench.notices.info(self.tr("Written: {0}").format(written))
            self.exported.emit(written)

        self.bench.measure(
            jobs.EXPORT, self.model.folder, self.project, kind, path, label=self.tr("Writing {0}").format(path.name),
            on_done=done,
        )  # fmt: skip

    def export_missing(self, kind: str) -> str:
        """Why this cannot be handed over yet, or ""."""
        needs = {"pdf": "report", "json": "inspect"}.get(kind, "scan")
        if needs in self.model.results:
            return ""
        return {
            "report": self.tr("Make the report first."),
            "inspect": self.tr("Measure the thickness first."),
            "scan": self.tr("Scan the part first."),
        }[needs]

    def export_name(self, kind: str) -> str:
        """The name proposed for an exported file."""
        name = self.project.info.part or self.project.info.name or self.tr("result")
        endings = {"pdf": ".pdf", "cloud": ".ply", "mesh": " mesh.ply", "stl": ".stl", "csv": ".csv", "json": ".json"}
        return "".join("-" if c in '<>:"/\\|?*' else c for c in name) + endings[kind]

    def opened(self) -> None:
        self._drop_preview()
        self._refresh_preview()

    def project_changed(self, before: Project, after: Project) -> None:
        self._refresh_preview()

    def entered(self) -> None:
        self._visible = True
        self._refresh_preview()

    def left(self) -> None:
        self._visible = False

    def _refresh_preview(self) -> None:
        """Draw the pages anew if something in them has changed and somebody looks."""
        if not self._visible or self.model.folder is None or not self.ready() or self._previewed == self.project:
            return
        self._previewed = project = self.project
        self._preview = self.bench.quick.run(
            jobs.PREVIEW_REPORT,
            self.model.folder,
            project,
            PAGE_WIDTH_PX,
            label="report preview",
            on_done=lambda pages: self._show(project, pages, ""),
            on_failed=lambda problem: self._show(project, (), str(problem)),
            replace_waiting=True,
        )
        self.changed.emit()

    def _show(self, project: Project, pages: tuple[Any, ...], problem: str) -> None:
        if project is not self._previewed:
            return
        self._preview = None
        self.pages, self.problem = pages, problem
        self.pages_ready.emit(pages)
        self.changed.emit()

    def _drop_preview(self) -> None:
        if self._preview is not None:
            self._preview.cancel()
        self._preview = self._previewed = None
        self.pages, self.problem = (), ""
