"""Studies of the project: kept, put into the report, made from a table or from other projects. Edits are undoable."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from PySide6.QtCore import QObject

from core.files.project import KeptStudy
from workbench import jobs
from workbench.problems import sentence
from workbench.tasks import Task

if TYPE_CHECKING:
    from workbench.pages.inspect_presenter import InspectPresenter

Kind = Literal["grr", "acceptance"]
HEADS: Mapping[Kind, str] = {
    "grr": "part;operator;value\n",
    "acceptance": "quantity;position;measured_mm;calibrated_mm;u_mm\n",
}
"""The head line a table begins with."""
LIMITS = ("form", "size", "spacing", "flatness")
ARTEFACTS = ("sphere", "bar", "plane")


@dataclass(frozen=True, slots=True)
class Draft:
    """A study that is being made: its table as CSV, the folder names in it are seen from, and its settings in mm."""

    kind: Kind
    text: str
    base: Path
    values: Mapping[str, Any]


class InspectStudies(QObject):
    """The list, the chosen study, and the draft of a new one."""

    def __init__(self, owner: InspectPresenter) -> None:
        super().__init__(owner)
        self._owner = owner
        self.chosen = ""
        self.draft: Draft | None = None
        self.problem = ""
        self._looked: dict[str, Any] = {}
        self._asked: set[str] = set()
        self._working: Task | None = None

    @property
    def all(self) -> tuple[KeptStudy, ...]:
        """The studies in the order they are reported."""
        return self._owner.project.studies

    @property
    def study(self) -> Any:
        """The chosen one, as `core.study` gives it; None as long as it is being read, or none is chosen."""
        return self._looked.get(self.chosen)

    @property
    def working(self) -> bool:
        """Whether something is being read or worked out for a study."""
        return self._working is not None

    def choose(self, id_: str) -> None:
        """Show this study; "" for none."""
        self.chosen = id_
        self._look()
        self._owner.changed.emit()

    # ---- the list

    def include(self, id_: str, included: bool) -> None:
        """Put a study into the report or leave it out; undoable."""
        label = self.tr("report the study") if included else self.tr("leave the study out")
        self._put(tuple(replace(one, included=included) if one.id == id_ else one for one in self.all), label)

    def remove(self, id_: str) -> None:
        """Take a study out of the project; undoable."""
        if any(one.id == id_ for one in self.all):
            self._put(tuple(one for one in self.all if one.id != id_), self.tr("remove a study"))

    @property
    def cannot_keep_type1(self) -> str:
        """Why the repeats give no type-1 study to be kept, or ""."""
        if not self._owner.model.is_open:
            return self.tr("Open a project first.")
        return self._owner.repeats.no_type1

    def keep_type1(self) -> None:
        """Keep the type-1 study of the repeats as they are now; undoable."""
        spec, repeats = self._owner.faces.spec, self._owner.repeats.all
        if self.cannot_keep_type1 or spec.tolerance_mm is None:
            self._owner.bench.notices.warning(self.cannot_keep_type1)
            return
        values = [repeat.thickness_mm for repeat in repeats]
        self._run(
            jobs.KEEP_TYPE1, values, spec.nominal_mm, 2 * spec.tolerance_mm, label=self.tr("Studying the repeats"),
            on_done=self._keep, offers={},
        )  # fmt: skip

    def export(self, id_: str, path: Path) -> None:
        """Write a copy of a study: its table if the name ends in .csv, else study.json."""
        path = path if path.suffix.lower() in (".csv", ".json") else path.with_name(path.name + ".json")
        self._run(
            jobs.EXPORT_STUDY, id_, path, label=self.tr("Writing {0}").format(path.name), offers={},
            on_done=lambda written: self._owner.bench.notices.info(self.tr("Written: {0}").format(written)),
        )  # fmt: skip

    # ---- a new one

    def begin(self, kind: Kind) -> None:
        """Begin a study of this kind, with an empty table."""
        folder = self._owner.model.folder
        if folder is None:
            self._owner.bench.notices.warning(self.tr("Open a project first."))
            return
        tolerance = self._owner.faces.spec.tolerance_mm
        values: dict[str, Any] = {"tolerance_mm": tolerance}
        if kind == "acceptance":
            values = dict.fromkeys(LIMITS) | {"artefact": "sphere", "calibrated_mm": 25.0, "u_mm": 0.0}
            values |= {"diameter_mm": 25.0}
        self.draft, self.problem = Draft(kind, HEADS[kind], folder, values), ""
        self._owner.changed.emit()

    def give_up(self) -> None:
        """Make no study after all."""
        self.draft, self.problem = None, ""
        self._owner.changed.emit()

    def write(self, text: str) -> None:
        """Take this text for the table."""
        if self.draft is not None and text != self.draft.text:
            self.draft = replace(self.draft, text=text)

    def set_value(self, key: str, value: Any) -> None:
        """Change a setting of the draft."""
        if self.draft is not None:
            self.draft = replace(self.draft, values={**self.draft.values, key: value})
            self._owner.changed.emit()

    def open_table(self, path: Path) -> None:
        """Take the table in this file; names of results in it are seen from its folder."""

        def done(text: Any) -> None:
            if self.draft is not None:
                self.draft = replace(self.draft, text=text, base=path.parent)

        self._run(
            jobs.READ_STUDY_TABLE, path, label=self.tr("Reading the table"), on_done=done, offers={}, of_project=False
        )

    def add_project(self, folder: Path) -> None:
        """Add what another project has measured to the table."""
        draft = self.draft
        if draft is None:
            return
        values = draft.values
        settings = [values.get(key) or 0.0 for key in ("calibrated_mm", "u_mm", "diameter_mm")]

        def done(rows: Any) -> None:
            if self.draft is not None and self.draft.kind == draft.kind:
                text = self.draft.text
                self.draft = replace(self.draft, text=text + ("" if text.endswith("\n") or not text else "\n") + rows)

        self._run(
            jobs.PROJECT_ROWS, draft.kind, folder, values.get("artefact", "plane"), *settings,
            label=self.tr("Reading {0}").format(folder.name), on_done=done, of_project=False,
        )  # fmt: skip

    def finish(self) -> None:
        """Make the study of the draft and keep it; what is wrong with the table stays in it with a sentence."""
        draft = self.draft
        if draft is None:
            return
        if draft.kind == "grr":
            tolerance = draft.values["tolerance_mm"]
            limits = {} if tolerance is None else {"tolerance": 2 * tolerance}
        else:
            limits = {key: draft.values[key] for key in LIMITS if draft.values[key] is not None}
        self._run(
            jobs.KEEP_STUDY, draft.kind, _one_separator(draft.text), draft.base, limits,
            label=self.tr("Making the study"), on_done=self._keep,
        )  # fmt: skip

    # ---- what happens elsewhere

    def forget(self) -> None:
        """Another project is open."""
        self.chosen, self.draft, self.problem = "", None, ""
        self._looked, self._asked = {}, set()

    # ---- inside

    def _keep(self, kept: KeptStudy) -> None:
        self.draft, self.problem = None, ""
        self.chosen = kept.id
        if all(one.id != kept.id for one in self.all):
            self._put((*self.all, kept), self.tr("add a study"))
        self._look()

    def _put(self, studies: tuple[KeptStudy, ...], label: str) -> None:
        self._owner.model.edit(label, replace(self._owner.project, studies=studies))

    def _look(self) -> None:
        """Read the chosen study, unless it is there or under way."""
        folder, id_ = self._owner.model.folder, self.chosen
        if folder is None or not id_ or id_ in self._looked or id_ in self._asked:
            return
        self._asked.add(id_)

        def done(study: Any) -> None:
            if folder == self._owner.model.folder:
                self._looked[id_] = study
                self._owner.changed.emit()

        self._owner.bench.glance(
            jobs.LOOK_AT_STUDY, folder, id_, label=self.tr("Reading the study"), on_done=done, offers={}
        ).ended.connect(lambda *_: self._asked.discard(id_))

    def _run(self, job: jobs.Job, *args: Any, of_project: bool = True, **more: Any) -> None:
        """One job at a time; what goes wrong with it is told where the study is made, too."""
        folder, on_done = self._owner.model.folder, more.pop("on_done")
        if folder is None or self.working:
            return
        self.problem = ""

        def done(answer: Any) -> None:
            if folder == self._owner.model.folder:
                on_done(answer)

        def failed(problem: Any) -> None:
            if folder == self._owner.model.folder:
                self.problem = sentence(problem)

        first = (folder,) if of_project else ()
        bench = self._owner.bench
        run = bench.measure if job == jobs.PROJECT_ROWS else bench.glance  # a cloud is looked through for the artefact
        self._working = run(job, *first, *args, on_done=done, on_failed=failed, **more)
        self._working.ended.connect(self._ended)
        self._owner.changed.emit()

    def _ended(self) -> None:
        self._working = None
        self._owner.changed.emit()


def _one_separator(text: str) -> str:
    """Rows pasted from a spreadsheet, with tabs, under a head with semicolons."""
    return text.replace("\t", ";") if ";" in text.partition("\n")[0] else text
