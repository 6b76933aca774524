"""Templates: the plan of one part, saved to a file and taken for the next one; files of both are plan.toml."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from core.files.project.folder import stored_source
from core.inspect.plan.inspection_plan import InspectionPlan
from workbench.language import tr
from workbench.pages.inspect.features.plan import InspectFeatures
from workbench.work import jobs

RECENT = "inspection templates"
MOST_RECENT = 6
"""So many templates that were used are offered again."""


class InspectTemplates:
    """Templates: files of plans, the ones used last first."""

    def __init__(self, features: InspectFeatures) -> None:
        self._features, self._bench, self._model = features, features.bench, features.model

    @property
    def recent(self) -> list[Path]:
        """Paths of the templates used last, the newest first, without files that are gone."""
        paths = [Path(line) for line in self._bench.settings.text(RECENT, "").split("\n") if line]
        return [path for path in paths if path.is_file()]

    @property
    def cannot_save(self) -> str:
        """Reason why the plan cannot be saved as a template; "" if it can."""
        return self._features.buttons.save

    def place(self) -> Path:
        """Propose the path of a new template: beside the last one, or in the folder of projects."""
        recent = self.recent
        folder = recent[0].parent if recent else self._bench.settings.projects_folder
        name = self._model.project.info.part or "plan"
        return folder / f"{''.join(c if c.isalnum() or c in ' -_' else '-' for c in name)}.toml"

    def save(self, path: Path) -> None:
        """Write the plan to a template file; names of nominal surfaces become absolute paths."""
        folder = self._model.folder
        if folder is None or self.cannot_save:
            return
        path = path if path.suffix.lower() == ".toml" else path.with_name(path.name + ".toml")
        plan = _with_nominals(self._features.plan, lambda name: (folder / name).resolve().as_posix())

        def done(_: Any) -> None:
            self._remember(path)
            self._bench.notices.info(tr("The template is {path}.", path=path))

        self._bench.run_quick(
            self._features, jobs.WRITE_PLAN, path, plan, label=tr("Writing the template"), on_done=done, offers={}
        )

    def take(self, path: Path) -> None:
        """Replace the plan by the template in the file `path`, and measure it if there is a scan; undoable."""
        folder = self._model.folder
        if folder is None:
            return

        def done(plan: Any) -> None:
            if folder == self._model.folder:
                self._remember(path)
                plan = _with_nominals(plan, lambda name: stored_source(folder, path.parent / name))
                self._features.put_plan(plan, tr("take the plan {name}", name=path.stem))
                self._features.measure()

        self._bench.run_quick(
            self._features, jobs.READ_PLAN, path, label=tr("Reading the template"), on_done=done, offers={}
        )

    def _remember(self, path: Path) -> None:
        paths = [path.resolve(), *(one for one in self.recent if one != path.resolve())]
        self._bench.settings.keep_text(RECENT, "\n".join(str(one) for one in paths[:MOST_RECENT]))
        self._features.changed.emit()


def _with_nominals(plan: InspectionPlan, named: Callable[[str], str]) -> InspectionPlan:
    """The plan with other names of its nominal surfaces."""
    features = tuple(
        one
        if one.deviation is None
        else replace(one, deviation=replace(one.deviation, nominal=named(one.deviation.nominal)))
        for one in plan.features
    )
    return replace(plan, features=features)
