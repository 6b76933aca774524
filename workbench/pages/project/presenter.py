"""Decisions of the project page: the fields the report prints."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any, Literal

from core.files.project.data import ProjectInfo
from workbench.language import tr
from workbench.pages.presenter import StepPresenter
from workbench.step_state import ORDER, State

ProgressLevel = Literal["", "good", "warn", "bad"]


class ProjectPresenter(StepPresenter):
    """Name, part, people, temperatures, notes."""

    step = "project"

    def values(self) -> dict[str, Any]:
        """The fields as they are."""
        info = self.project.info
        return {field.name: getattr(info, field.name) for field in fields(ProjectInfo)}

    def set_field(self, name: str, value: Any) -> None:
        """Change one field; undoable."""
        if isinstance(value, str):
            value = value.strip()
        info = replace(self.project.info, **{name: value})
        label = tr("change {name}", name=self.label(name).lower())
        self.model.edit(label, replace(self.project, info=info))

    def blocker(self) -> str:
        return "" if self.project.info.name.strip() else self.tr("Give the project a name first.")

    def progress_rows(self) -> list[tuple[str, str, str, ProgressLevel]]:
        """One row a step: title, state in words, the sentence that explains it, level."""
        words: dict[State, tuple[str, ProgressLevel]] = {
            State.TODO: (self.tr("to do"), ""),
            State.READY: (self.tr("ready"), ""),
            State.DONE: (self.tr("done"), "good"),
            State.OUTDATED: (self.tr("out of date"), "warn"),
        }
        states = self.model.states
        titles = self._titles()
        return [
            (titles[step], words[states[step].state][0], states[step].sentence, words[states[step].state][1])
            for step in ORDER
            if step != "project"
        ]

    def next_words(self) -> str:
        """What to do next, in one sentence."""
        states = self.model.states
        for step in ORDER:
            if states[step].state is not State.DONE:
                return tr("Next: {step}. {sentence}", step=self._titles()[step], sentence=states[step].sentence)
        return self.tr("All steps are done.")

    def place(self) -> str:
        """The project's folder."""
        return str(self.model.folder or "")

    def _titles(self) -> dict[str, str]:
        return {
            "project": self.tr("Project"),
            "camera": self.tr("Camera"),
            "planes": self.tr("Laser planes"),
            "scan": self.tr("Scan"),
            "inspect": self.tr("Inspect"),
            "report": self.tr("Report"),
        }

    def label(self, name: str) -> str:
        """What a field is called on screen."""
        return {
            "name": self.tr("Name"),
            "part": self.tr("Part"),
            "serial": self.tr("Serial number"),
            "operator": self.tr("Operator"),
            "customer": self.tr("Customer"),
            "laboratory": self.tr("Laboratory"),
            "air_celsius": self.tr("Air temperature"),
            "part_celsius": self.tr("Part temperature"),
            "notes": self.tr("Notes"),
        }[name]
