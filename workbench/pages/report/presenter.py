"""Decisions of the report page: what is in the report, and what is handed over beside it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from core.errors import InputError
from core.files.project.data import Project
from core.files.project.keys import finished, up_to_date
from core.files.project.view_file import read_view
from core.files.results.export_list import exports
from core.messages import capital
from core.report.template import sections
from core.wing import no_reader_of_studies, studies_can_be_read
from workbench.bench import Bench
from workbench.language import printed, text_of, tr
from workbench.pages.presenter import StepPresenter
from workbench.pages.report.stage import Facts, Stage, WhyNot, stage_of, why_not_export, why_not_make
from workbench.step_state import TITLES, State
from workbench.work import jobs
from workbench.work.tasks import Task

PAGE_WIDTH_PX = 1400
"""Pixels across a page as it is drawn for the window, which scales it to the zoom."""

EXPORT_FOLDER = "export folder"
EXPORT_FRAME = "frame of exports"


class ReportPresenter(StepPresenter):
    """Presenter of preview, sections, paper and export.

    `pages` are the last ones drawn; while `drawing`, others are on their way. `problem` says why there are none.
    """

    step = "report"

    def __init__(self, bench: Bench) -> None:
        super().__init__(bench)
        self.pages: tuple[Any, ...] = ()
        self.problem = ""
        self._drawing: tuple[Any, ...] | None = None
        self._drawn: tuple[Any, ...] | None = None
        self._making: Task | None = None
        self._visible = False
        self.view = ""
        """Numbers of how the surface was left in 3D; "" where it was not turned. Read where it may be another."""
        self.model.results_changed.connect(self._results_changed)

    # ---- what is in it

    def sections(self) -> list[tuple[str, str, bool]]:
        """List each section of the report that may be left out: name, title, and whether it is printed."""
        return [(name, tr(title), name not in self.project.report.hidden) for name, title in sections().items()]

    def empty_section(self, name: str) -> str:
        """Return the reason why a section has nothing to print yet; "" if it has."""
        kinds = {feature.kind for feature in self.project.inspection.features}
        nothing = {
            "view": "" if self.view else tr("Turn the surface on the Inspect page: it is printed as you left it."),
            "sections": "" if "section" in kinds else tr("There is no cross-section among the features yet."),
            "deviation": ""
            if "deviation" in kinds
            else tr("There is no deviation from a nominal surface among the features yet."),
            "repeats": "" if self.project.repeats else tr("No scan has been added to the repeats yet."),
            "studies": self._no_studies(),
            "remarks": "" if self.project.info.notes else tr("There are no notes on the Project page yet."),
            "budget": "" if "gauge" in self.model.results else tr("The thickness has not been measured yet."),
        }
        return nothing.get(name, "")

    def _no_studies(self) -> str:
        """Give the reason why no study is printed, or ""; no tab of a wing that is not there is named."""
        if not studies_can_be_read():
            what, todo = no_reader_of_studies()
            return capital(text_of(InputError(what, todo=todo)))
        ticked = any(study.included for study in self.project.studies)
        return "" if ticked else tr("No study is ticked on the Inspect page, tab Studies.")

    def choose_section(self, name: str, shown: bool) -> None:
        """Print a section of the report, or leave it out; undoable."""
        hidden = self.project.report.hidden - {name} if shown else self.project.report.hidden | {name}
        title = sections()[name]
        label = tr("put in “{title}”", title=title) if shown else tr("leave out “{title}”", title=title)
        report = replace(self.project.report, hidden=frozenset(hidden))
        self.model.edit(label, replace(self.project, report=report))

    def choose_paper(self, paper: Any) -> None:
        """Choose the paper of the report, "A4" or "Letter"; undoable."""
        report = replace(self.project.report, paper=paper)
        self.model.edit(tr("print on {paper}", paper=paper), replace(self.project, report=report))

    def choose_language(self, language: Any) -> None:
        """Choose the language of the report, as "de"; "" for the window's language. Undoable."""
        report = replace(self.project.report, language=language)
        self.model.edit(tr("language of the report"), replace(self.project, report=report))

    def choose_template(self, path: Path | None) -> None:
        """Choose the report template in the file `path`, or None for no template; undoable."""
        folder, choices = self.model.folder, self.project.report
        if folder is None:
            return

        def done(report: Any) -> None:
            if folder == self.model.folder and choices == self.project.report:
                label = tr("report without a template") if path is None else tr("template of the report")
                self.model.edit(label, replace(self.project, report=report))

        self.bench.run_quick(
            self,
            jobs.CHOOSE_TEMPLATE,
            folder,
            choices,
            path,
            label=tr("Reading the template"),
            on_done=done,
            offers={},
        )

    # ---- how far it is

    @property
    def stage(self) -> Stage:
        """How far the report is: none, ready to be made, being made, made or outdated."""
        return stage_of(self._facts())

    def _facts(self) -> Facts:
        results, state = self.model.results, self.state.state
        return Facts(
            camera="camera" in results,
            scan=self.ready(),
            thickness="gauge" in results,
            features="inspection" in results,
            report=state in (State.DONE, State.OUTDATED),
            outdated=state is State.OUTDATED,
            making=self._making is not None,
            read_only=self.read_only,
        )

    def ready(self) -> bool:
        """Whether there are results that a report can print."""
        return "scan" in self.model.results

    def blocker(self) -> str:
        return "" if self.ready() else tr("Scan the part first; then there is something to report.")

    def warning(self) -> str:
        """Return a sentence on which results in the report are out of date; "" if none is."""
        states = self.model.states
        for step in ("scan", "inspect"):
            if states[step].state is State.OUTDATED:
                return tr(
                    "{step}: {sentence} The report prints what was measured then.",
                    step=tr(TITLES[step]),
                    sentence=states[step].sentence,
                )
        if "inspection" in self.model.results and not up_to_date("inspection", self.project, self.model.results):
            return tr(
                "Inspect: the features or the scan have changed since the features were measured. The report prints "
                "what was measured then."
            )
        return ""

    # ---- make and hand over

    @property
    def read_only(self) -> bool:
        """Whether the project cannot be written to, so that a report can be exported but not stored in it."""
        return self.model.is_read_only

    def why_not_make(self) -> str:
        """Return the reason why the report cannot be made now; "" if it can."""
        return {
            WhyNot.NOTHING: "",
            WhyNot.MAKING: tr("The report is being made."),
            WhyNot.NO_SCAN: self.blocker(),
            WhyNot.READ_ONLY: self.bench.unwitnessed
            or tr("The project is read-only: export the report elsewhere, or go on in a copy (File, Save a copy)."),
        }[why_not_make(self._facts())]

    def do_run(self) -> None:
        """Make the report and store it in the project's results, in the background."""
        self._make("")

    def export(self, kind: str, path: Path) -> None:
        """Write an export of this kind to `path`, after making the report if it is out of date."""
        ending = exports()[kind].ending
        path = path if path.suffix.lower() == ending else path.with_name(path.name + ending)
        self.bench.settings.keep_text(EXPORT_FOLDER, str(path.parent))
        if kind == "pdf" and self.stage is not Stage.MADE and not self.read_only:
            self._make(path)
        else:
            self._export(kind, path)

    @property
    def in_camera_frame(self) -> bool:
        """Whether clouds, meshes and shapes are exported in the camera's frame instead of the part's."""
        return self.bench.settings.text(EXPORT_FRAME, "part") == "camera"

    @in_camera_frame.setter
    def in_camera_frame(self, wanted: bool) -> None:
        self.bench.settings.keep_text(EXPORT_FRAME, "camera" if wanted else "part")

    def export_missing(self, kind: str) -> str:
        """Return the reason why an export of this kind is not possible yet; "" if it is."""
        return {
            WhyNot.NOTHING: "",
            WhyNot.NO_CAMERA: tr("Calibrate the camera first."),
            WhyNot.NO_SCAN: tr("Scan the part first."),
            WhyNot.MAKING: tr("The report is being made."),
            WhyNot.NO_THICKNESS: tr("Measure the thickness first."),
        }[why_not_export(self._facts(), kind)]

    def export_place(self, kind: str) -> Path:
        """Propose the path of an export: in the folder used last, named after the part."""
        name = self.project.info.part or self.project.info.name or tr("result")
        name = "".join("-" if c in '<>:"/\\|?*' or ord(c) < 32 else c for c in name).strip(" .") or tr("result")
        called = exports()[kind].called
        name += f" {tr(called)}" if called else ""
        folder = Path(self.bench.settings.text(EXPORT_FOLDER, str(self.model.folder or Path.home())))
        return (folder if folder.is_dir() else Path.home()) / (name + exports()[kind].ending)

    def results_folder(self) -> Path | None:
        """Return the folder of the project's results; None if there are no results."""
        folder = self.model.folder / "results" if self.model.folder is not None else None
        return folder if folder is not None and folder.is_dir() else None

    def _make(self, then_copy_to: Path | str) -> None:
        folder, project, results = self.model.folder, self.project, self.model.results
        if folder is None or self.why_not_make():
            return

        def done(path: Path) -> None:
            self._making = None
            if folder == self.model.folder:
                self.model.record("report", finished("report", project, results))
                self.bench.notices.info(tr("The report is {path}.", path=path))
                if isinstance(then_copy_to, Path):
                    self._export("pdf", then_copy_to)
            self.changed.emit()

        def ended(*_: Any) -> None:
            self._making = None
            self.changed.emit()

        self._making = self.bench.run_long(
            self,
            jobs.MAKE_REPORT,
            folder,
            project.printed_in(printed()),
            label=tr("Making the report"),
            on_done=done,
            on_failed=ended,
            on_cancelled=ended,
        )
        self.changed.emit()

    def _export(self, kind: str, path: Path) -> None:
        if self.model.folder is None:
            return
        self.bench.run_long(
            self,
            jobs.EXPORT,
            self.model.folder,
            self.project.printed_in(printed()),
            kind,
            path,
            self.in_camera_frame,
            label=tr("Writing {name}", name=path.name),
            on_done=lambda written: self.bench.notices.info(tr("Written: {path}", path=written)),
        )

    # ---- preview

    @property
    def drawing(self) -> bool:
        """Whether the pages of the preview are being drawn."""
        return self._drawing is not None

    def opened(self) -> None:
        self.pages, self.problem = (), ""
        self._drawing = self._drawn = None
        self._read_view()
        self._refresh_preview()

    def project_changed(self, before: Project, after: Project) -> None:
        self._refresh_preview()

    def entered(self) -> None:
        self._visible = True
        self._read_view()
        self._refresh_preview()

    def left(self) -> None:
        self._visible = False

    def _results_changed(self) -> None:
        self._read_view()
        self._refresh_preview()

    def _read_view(self) -> None:
        view = None if self.model.folder is None else read_view(self.model.folder)
        self.view = "" if view is None else view.words

    def _printed(self) -> tuple[Any, ...]:
        """Everything the pages say something of."""
        project, results = self.project, self.model.results
        return (
            self.model.folder,
            project.info,
            project.rig,
            project.sources,
            project.repeats,
            project.studies,
            project.report,
            project.options.part,
            self.view,
            results.get("scan"),
            results.get("gauge"),
            results.get("inspection"),
        )

    def _refresh_preview(self) -> None:
        """Draw the pages anew if something in them has changed and the page is shown; one drawing at a time."""
        if not self._visible or self.model.folder is None or self.drawing:
            return
        if not self.ready():
            self.pages, self.problem, self._drawn = (), "", None
            return
        wanted = self._printed()
        if wanted == self._drawn:
            return
        self._drawing = wanted
        self.bench.quick.run(
            self,
            jobs.PREVIEW_REPORT,
            self.model.folder,
            self.project.printed_in(printed()),
            PAGE_WIDTH_PX,
            label=tr("Drawing the pages"),
            on_done=lambda pages: self._show(wanted, pages, ""),
            on_failed=lambda problem: self._show(wanted, (), text_of(problem)),
            on_cancelled=lambda: self._show(wanted, self.pages, ""),
        )
        self.changed.emit()

    def _show(self, drawn: tuple[Any, ...], pages: tuple[Any, ...], problem: str) -> None:
        """The pages are drawn; what has changed meanwhile is drawn next."""
        if drawn is not self._drawing:
            return
        self._drawing, self._drawn = None, drawn
        self.pages, self.problem = pages, problem
        self._refresh_preview()
        self.changed.emit()
