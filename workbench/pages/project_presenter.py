"""Decisions of the project page: the fields the report prints."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

from PySide6.QtCore import QCoreApplication

from core.files.project import ProjectInfo
from workbench.pages.presenter import StepPresenter


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
        label = QCoreApplication.translate("ProjectPresenter", "change {0}").format(self.label(name).lower())
        self.model.edit(label, replace(self.project, info=info))

    def blocker(self) -> str:
        return "" if self.project.info.name.strip() else self.tr("Give the project a name first.")

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
