"""The target of a step: changed by the user, printed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

from PySide6.QtCore import QObject, Signal

from core.image.targets import Target
from workbench import jobs
from workbench.bench import Bench
from workbench.pages.target_values import changed_target, values_of


class TargetChoice(QObject):
    """`which` target of the rig; `label` names the edit, as "change the camera's target"."""

    target_refused = Signal(str, str)
    """Field and why it cannot be so; an empty sentence if it can."""

    def __init__(
        self, bench: Bench, which: Literal["camera_target", "plane_target"], label: str, parent: QObject | None = None
    ) -> None:
        super().__init__(parent)
        self._bench, self._model, self._which, self._label = bench, bench.model, which, label

    @property
    def target(self) -> Target:
        """The target as it is."""
        target: Target = getattr(self._model.project.rig, self._which)
        return target

    def target_values(self) -> dict[str, Any]:
        """The target as the fields of a form."""
        return values_of(self.target)

    def set_target(self, field: str, value: Any) -> None:
        """Change one field; undoable. What cannot be is refused with a sentence."""
        try:
            target = changed_target(self.target, field, value)
        except ValueError as error:
            self.target_refused.emit(field, str(error))
            return
        self.target_refused.emit(field, "")
        project = self._model.project
        changed: dict[str, Any] = {self._which: target}
        after = replace(project, rig=replace(project.rig, **changed))
        self._model.edit(self._label, after, f"{self._which} {field}")

    def print_target(self, path: Path, paper: str) -> None:
        """Write the target to scale as a PDF."""
        self._bench.glance(
            jobs.TARGET_SHEET,
            path,
            self.target,
            paper,
            self._model.project.info.name,
            label=self.tr("Drawing the target"),
            on_done=lambda done: self._bench.notices.info(
                self.tr("The target was written to {0}. Print it at 100 % and measure its rulers.").format(done)
            ),
        )
