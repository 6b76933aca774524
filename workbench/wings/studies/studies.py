"""Studies of the project: kept, put into the report, made from a table or from other projects. Edits are undoable."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal, NamedTuple

from PySide6.QtCore import QObject, Signal

from core.files.project.data import KeptStudy
from core.findings.proof import Doubt
from core.wings.studies.files.table import with_rows
from workbench.bench import Bench
from workbench.language import text_of, tr
from workbench.pages.inspect.repeats.repeats import InspectRepeats
from workbench.wings.studies import jobs
from workbench.wings.studies.type1 import no_type1
from workbench.work.jobs import Job
from workbench.work.tasks import Task


@dataclass(frozen=True, slots=True)
class StudiesFacts:
    """Facts that the buttons of studies rest on."""

    busy: str
    """What is being read or worked out for a study; "": nothing."""
    cannot_write: str
    """Why no study can be kept in the project."""
    no_type1: str
    """Why the repeats give no type-1 study."""
    chosen: bool
    """A study of the list is."""
    rows: bool
    """The table of the study being made has more than its head."""


class StudiesButtons(NamedTuple):
    """Reasons why each button is grey; a study being made can be given up at any time."""

    begin: str
    type1: str
    remove: str
    export: str
    read: str
    """Open a table, or add a project to it."""
    make: str


def studies_buttons(facts: StudiesFacts) -> StudiesButtons:
    """Derive why each button of the studies and of the draft is disabled; "" for each that is enabled."""
    busy = tr("Wait for what is under way: {what}.", what=facts.busy) if facts.busy else ""
    choose = "" if facts.chosen else tr("Choose a study in the list first.")
    rows = "" if facts.rows else tr("Enter or paste measurements into the table first.")
    return StudiesButtons(
        begin=facts.cannot_write or busy,
        type1=facts.cannot_write or facts.no_type1 or busy,
        remove=choose or busy,
        export=choose or busy,
        read=busy,
        make=facts.cannot_write or busy or rows,
    )


Kind = Literal["grr", "acceptance", "series"]
HEADS: Mapping[Kind, str] = {
    "grr": "part;operator;value\n",
    "acceptance": "quantity;position;measured_mm;calibrated_mm;u_mm\n",
    "series": "part;value_mm;u_mm\n",
}
"""The head line a table begins with."""
LIMITS = ("form", "size", "spacing", "flatness")
ARTEFACTS = ("sphere", "bar", "plane")


THICKNESS = "thickness"
"""What a series is of where nothing else is named."""


@dataclass(frozen=True, slots=True)
class Draft:
    """Study that is being made: its table as CSV, the folder names in it are seen from, and its settings in mm."""

    kind: Kind
    text: str
    base: Path
    values: Mapping[str, Any]


class InspectStudies(QObject):
    """Presenter of the list of studies, the chosen one, and the draft of a new one."""

    changed = Signal()

    def __init__(self, bench: Bench, repeats: InspectRepeats) -> None:
        super().__init__()
        self.bench, self.model, self._repeats = bench, bench.model, repeats
        self.chosen = ""
        self.draft: Draft | None = None
        self.problem = ""
        self._looked: dict[str, Any] = {}
        self._asked: set[str] = set()
        self._working: Task | None = None
        bench.model.opened.connect(self.forget)

    @property
    def all(self) -> tuple[KeptStudy, ...]:
        """Studies of the project, in the order the report prints them."""
        return self.model.project.studies

    @property
    def study(self) -> Any:
        """Study that is chosen, with its results; None while it is being read, or if none is chosen."""
        return self._looked.get(self.chosen)

    @property
    def working(self) -> bool:
        """Whether a study is being read or computed."""
        return self._working is not None

    @property
    def buttons(self) -> StudiesButtons:
        """Reason why each button is disabled; "" if it is enabled."""
        return studies_buttons(
            StudiesFacts(
                busy="" if self._working is None else self._working.label,
                cannot_write=self.bench.cannot_write,
                no_type1=no_type1(self._repeats),
                chosen=any(one.id == self.chosen for one in self.all),
                rows=self.draft is not None and bool(self.draft.text.partition("\n")[2].strip()),
            )
        )

    def choose(self, id_: str) -> None:
        """Choose the study with this id, and read it; "" chooses none."""
        self.chosen = id_
        self._look()
        self.changed.emit()

    # ---- the list

    def include(self, id_: str, included: bool) -> None:
        """Print the study with this id in the report, or leave it out; undoable."""
        label = tr("report the study") if included else tr("leave the study out")
        self._put(tuple(replace(one, included=included) if one.id == id_ else one for one in self.all), label)

    def remove(self, id_: str) -> None:
        """Remove the study with this id from the project; undoable."""
        if any(one.id == id_ for one in self.all):
            self._put(tuple(one for one in self.all if one.id != id_), tr("remove a study"))

    def keep_type1(self) -> None:
        """Store the type-1 study of the present repeats in the project; undoable."""
        spec, repeats = self._repeats.spec, self._repeats.all
        if self.buttons.type1 or spec.tolerance_mm is None:
            return
        values = [(one.scan, one.thickness_mm, tuple(map(Doubt.named, one.doubts))) for one in repeats]
        self._run(
            jobs.KEEP_TYPE1, values, spec.nominal_mm, 2 * spec.tolerance_mm,
            label=tr("Studying the repeats"), on_done=self._keep, offers={}, writes=True,
        )  # fmt: skip

    def export(self, id_: str, path: Path) -> None:
        """Write a copy of the study with this id to `path`: its table if that ends in .csv, else study.json."""
        path = path if path.suffix.lower() in (".csv", ".json") else path.with_name(path.name + ".json")
        self._run(
            jobs.EXPORT_STUDY, id_, path, label=tr("Writing {name}", name=path.name), offers={},
            on_done=lambda written: self.bench.notices.info(tr("Written: {path}", path=written)),
        )  # fmt: skip

    # ---- a new one

    def begin(self, kind: Kind) -> None:
        """Begin the draft of a new study of this kind, with an empty table."""
        folder = self.model.folder
        if folder is None:
            self.bench.notices.warning(tr("Open a project first."))
            return
        tolerance = self._repeats.spec.tolerance_mm
        values: dict[str, Any] = {"tolerance_mm": tolerance}
        if kind == "acceptance":
            values = dict.fromkeys(LIMITS) | {"artefact": "sphere", "calibrated_mm": 25.0, "u_mm": 0.0}
            values |= {"diameter_mm": 25.0}
        if kind == "series":
            values |= {"name": THICKNESS, "nominal_mm": self._repeats.spec.nominal_mm, "size": 1}
        self.draft, self.problem = Draft(kind, HEADS[kind], folder, values), ""
        self.changed.emit()

    def give_up(self) -> None:
        """Discard the draft, and cancel what is being read or computed for it."""
        if self._working is not None:
            self._working.cancel()
        self.draft, self.problem = None, ""
        self.changed.emit()

    def write(self, text: str) -> None:
        """Replace the text of the draft's table."""
        if self.draft is not None and text != self.draft.text:
            self.draft = replace(self.draft, text=text)

    def set_value(self, key: str, value: Any) -> None:
        """Change one setting of the draft."""
        if self.draft is not None:
            self.draft = replace(self.draft, values={**self.draft.values, key: value})
            self.changed.emit()

    def open_table(self, path: Path) -> None:
        """Read the draft's table from a CSV file; folders named in it are relative to the file's folder."""

        def done(text: Any) -> None:
            if self.draft is not None:
                self.draft = replace(self.draft, text=text, base=path.parent)

        self._run(jobs.READ_STUDY_TABLE, path, label=tr("Reading the table"), on_done=done, offers={}, of_project=False)

    def add_project(self, folder: Path) -> None:
        """Append the results of the project in `folder` to the draft's table."""
        draft = self.draft
        if draft is None:
            return
        values = draft.values
        settings = [values.get(key) or 0.0 for key in ("calibrated_mm", "u_mm", "diameter_mm")]

        def done(rows: Any) -> None:
            if self.draft is not None and self.draft.kind == draft.kind:
                self.draft = replace(self.draft, text=with_rows(self.draft.text, rows))

        self._run(
            jobs.PROJECT_ROWS, draft.kind, folder, values.get("artefact", "plane"), *settings, _name(values),
            label=tr("Reading {name}", name=folder.name), on_done=done, of_project=False,
        )  # fmt: skip

    def finish(self) -> None:
        """Make the study of the draft, and store it in the project; if that fails, the draft stays."""
        draft = self.draft
        if draft is None:
            return
        if draft.kind == "grr":
            tolerance = draft.values["tolerance_mm"]
            limits = {} if tolerance is None else {"tolerance": 2 * tolerance}
        elif draft.kind == "series":
            limits = _limits_of_series(draft.values)
        else:
            limits = {key: draft.values[key] for key in LIMITS if draft.values[key] is not None}
        self._run(
            jobs.KEEP_STUDY, draft.kind, _one_separator(draft.text), draft.base, limits, _name(draft.values),
            label=tr("Making the study"), on_done=self._keep, writes=True,
        )  # fmt: skip

    # ---- what happens elsewhere

    def forget(self) -> None:
        """Drop the chosen study, the draft and all studies read, as another project is open."""
        self.chosen, self.draft, self.problem = "", None, ""
        self._looked, self._asked = {}, set()
        self.changed.emit()

    # ---- inside

    def _keep(self, kept: KeptStudy) -> None:
        self.draft, self.problem = None, ""
        self.chosen = kept.id
        if all(one.id != kept.id for one in self.all):
            self._put((*self.all, kept), tr("add a study"))
        self._look()

    def _put(self, studies: tuple[KeptStudy, ...], label: str) -> None:
        self.model.edit(label, replace(self.model.project, studies=studies))

    def _look(self) -> None:
        """Read the chosen study, unless it is there or under way."""
        folder, id_ = self.model.folder, self.chosen
        if folder is None or not id_ or id_ in self._looked or id_ in self._asked:
            return
        self._asked.add(id_)

        def done(study: Any) -> None:
            if folder == self.model.folder:
                self._looked[id_] = study
                self.changed.emit()

        task = self.bench.run_quick(
            self, jobs.LOOK_AT_STUDY, folder, id_, label=tr("Reading the study"), on_done=done, offers={}
        )
        task.ended.connect(lambda: self._asked.discard(id_))

    def _run(self, job: Job, *args: Any, of_project: bool = True, **more: Any) -> None:
        """One job at a time; what goes wrong with it is told where the study is made, too."""
        folder, on_done = self.model.folder, more.pop("on_done")
        if folder is None or self.working:
            return
        self.problem = ""

        def done(answer: Any) -> None:
            if folder == self.model.folder:
                on_done(answer)

        def failed(problem: Any) -> None:
            if folder == self.model.folder:
                self.problem = text_of(problem)

        first = (folder,) if of_project else ()
        # A cloud is looked through for the artefact, which takes long.
        run = self.bench.run_long if job == jobs.PROJECT_ROWS else self.bench.run_quick
        self._working = run(self, job, *first, *args, on_done=done, on_failed=failed, **more)
        self._working.ended.connect(self._ended)
        self.changed.emit()

    def _ended(self) -> None:
        self._working = None
        self.changed.emit()


def _name(values: Mapping[str, Any]) -> str:
    """Of the characteristic that a series is of."""
    return str(values.get("name") or "").strip() or THICKNESS


def _limits_of_series(values: Mapping[str, Any]) -> dict[str, float]:
    """Size of the subgroups, and the two limits where nominal value and tolerance are known."""
    nominal, tolerance, size = values["nominal_mm"], values["tolerance_mm"], {"size": values["size"]}
    if nominal is None or tolerance is None:
        return size
    return size | {"lower": nominal - tolerance, "upper": nominal + tolerance}


def _one_separator(text: str) -> str:
    """Rows pasted from a spreadsheet, with tabs, under a head with semicolons."""
    return text.replace("\t", ";") if ";" in text.partition("\n")[0] else text
