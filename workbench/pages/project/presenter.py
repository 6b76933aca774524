"""Decisions of the project page: the fields the report prints."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any, Literal

from core.files.project.data import ProjectInfo
from core.messages import capital
from core.states import STEP_STATES
from workbench.bench import Bench
from workbench.language import tr
from workbench.pages.presenter import StepPresenter
from workbench.pages.whole import MeasuringAll
from workbench.step_state import ORDER, SETTLED, TITLES, State

ProgressLevel = Literal["", "good", "warn", "bad"]


class ProjectPresenter(StepPresenter):
    """Presenter of name, part, people, temperatures, notes."""

    step = "project"

    def __init__(self, bench: Bench) -> None:
        super().__init__(bench)
        self.whole = MeasuringAll(bench, self)
        self.whole.changed.connect(self.changed)
        self.whole.ended.connect(self.go_to)

    def opened(self) -> None:
        self.whole.opened()

    def do_whole(self) -> None:
        """Do every step that is not up to date, to the report, or show why that is impossible; by shortcut."""
        if why := self.whole.cannot_start:
            self.bench.notices.info(why)
        self.whole.start()

    def values(self) -> dict[str, Any]:
        """Return the project's name, part, people, temperatures and notes as the fields of the form."""
        info = self.project.info
        return {field.name: getattr(info, field.name) for field in fields(ProjectInfo)}

    def set_field(self, name: str, value: Any) -> None:
        """Change one field of the project's data; undoable."""
        if isinstance(value, str):
            value = value.strip()
        info = replace(self.project.info, **{name: value})
        label = tr("change {name}", name=self.label(name).lower())
        self.model.edit(label, replace(self.project, info=info))

    def blocker(self) -> str:
        return "" if self.project.info.name.strip() else tr("Give the project a name first.")

    def progress_rows(self) -> list[tuple[str, str, str, ProgressLevel]]:
        """Make a row for each step: its title, state in words, the sentence on it, and a level for the icon."""
        levels: dict[State, ProgressLevel] = {State.DONE: "good", State.OUTDATED: "warn"}
        return [
            (tr(TITLES[step]), tr(STEP_STATES[one.state]), one.sentence, levels.get(one.state, ""))
            for step, one in self.model.states.items()
            if step != "project"
        ]

    def next_words(self) -> str:
        """Write in one sentence what to do next in the project."""
        states = self.model.states
        for step in ORDER:
            if states[step].state not in SETTLED:
                return tr("Next: {step}. {sentence}", step=tr(TITLES[step]), sentence=states[step].sentence)
        return tr("All steps are done.")

    def place(self) -> str:
        """Return the path of the project's folder as text; "" without a project."""
        return str(self.model.folder or "")

    def label(self, name: str) -> str:
        """Return the label of a field of the form."""
        return {
            "name": tr("Name"),
            "part": tr("Part"),
            "serial": tr("Serial number"),
            "operator": tr("Operator"),
            "customer": tr("Customer"),
            "laboratory": tr("Laboratory"),
            "air_celsius": tr("Air temperature"),
            "part_celsius": tr("Part temperature"),
            "notes": capital(tr("notes")),
        }[name]
