"""Templates: the plan of one part, saved to a file and taken for the next one; files of both are plan.toml."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject

from core.files.project import stored_source
from core.inspect.inspection_plan import InspectionPlan
from workbench import jobs

if TYPE_CHECKING:
    from workbench.pages.inspect_features import InspectFeatures

RECENT = "inspection templates"
MOST_RECENT = 6


class InspectTemplates(QObject):
    """Files of plans, the ones used last first."""

    def __init__(self, owner: InspectFeatures) -> None:
        super().__init__(owner)
        self._owner, self._bench = owner, owner.owner.bench

    @property
    def recent(self) -> list[Path]:
        """The templates used last, the newest first; those that are gone are left out."""
        paths = [Path(line) for line in self._bench.settings.text(RECENT, "").split("\n") if line]
        return [path for path in paths if path.is_file()]

    @property
    def cannot_save(self) -> str:
        """Why there is no template to be made of this plan, or ""."""
        return "" if self._owner.plan.features else self.tr("Add a feature first.")

    def place(self) -> Path:
        """Where a template is proposed to be saved: beside the last one, or beside the projects."""
        recent = self.recent
        folder = recent[0].parent if recent else self._bench.settings.projects_folder
        name = self._owner.owner.project.info.part or "plan"
        return folder / f"{''.join(c if c.isalnum() or c in ' -_' else '-' for c in name)}.toml"

    def save(self, path: Path) -> None:
        """Write the plan to a file; names of nominal surfaces in it become whole paths."""
        folder = self._owner.owner.model.folder
        if folder is None or self.cannot_save:
            return
        path = path if path.suffix.lower() == ".toml" else path.with_name(path.name + ".toml")
        plan = _with_nominals(self._owner.plan, lambda name: (folder / name).resolve().as_posix())

        def done(_: Any) -> None:
            self._remember(path)
            self._bench.notices.info(self.tr("The template is {0}.").format(path))

        self._bench.glance(jobs.WRITE_PLAN, path, plan, label=self.tr("Writing the template"), on_done=done, offers={})

    def take(self, path: Path) -> None:
        """Measure the plan in this file from now on, and at once if there is a scan; undoable."""
        folder = self._owner.owner.model.folder
        if folder is None:
            return

        def done(plan: Any) -> None:
            if folder == self._owner.owner.model.folder:
                self._remember(path)
                plan = _with_nominals(plan, lambda name: stored_source(folder, path.parent / name))
                self._owner.take_template(plan, path.stem)
                self._owner.measure()

        self._bench.glance(jobs.READ_PLAN, path, label=self.tr("Reading the template"), on_done=done, offers={})

    def _remember(self, path: Path) -> None:
        paths = [path.resolve(), *(one for one in self.recent if one != path.resolve())]
        self._bench.settings.keep_text(RECENT, "\n".join(str(one) for one in paths[:MOST_RECENT]))
        self._owner.changed.emit()


def _with_nominals(plan: InspectionPlan, named: Callable[[str], str]) -> InspectionPlan:
    """The plan with other names of its nominal surfaces."""
    features = tuple(
        one
        if one.deviation is None
        else replace(one, deviation=replace(one.deviation, nominal=named(one.deviation.nominal)))
        for one in plan.features
    )
    return replace(plan, features=features)
