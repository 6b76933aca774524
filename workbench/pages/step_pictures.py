"""The pictures that a calibration is made from: listed, with a small picture of each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Literal

from PySide6.QtCore import QObject, Signal

from workbench import jobs
from workbench.bench import Bench
from workbench.pages.sources import folder_of

AT_ONCE = 6
"""So many thumbnails are made in one go, so that what the eye waits for comes between."""


class StepPictures(QObject):
    """`paths` of a step's pictures, None until they are listed; `thumbnails` by the name that `named` gives a path.

    A path whose name is "" is no picture of its own and is left out.
    """

    changed = Signal()

    def __init__(
        self,
        bench: Bench,
        step: Literal["camera", "planes"],
        named: Callable[[Path], str],
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._bench, self._model, self._step, self._named = bench, bench.model, step, named
        self.forget()

    def forget(self) -> None:
        """Another project."""
        self.paths: tuple[Path, ...] | None = None
        self.thumbnails: dict[str, Any] = {}
        self._listed = self._thumbnails_of = ""

    def follow(self) -> None:
        """The project is another: list its pictures, unless that was done."""
        project, folder = self._model.project, folder_of(self._model, self._step)
        of = f"{getattr(project.sources, self._step)}|{project.rig.channel}"
        if of == self._listed:
            return
        if of != self._thumbnails_of:
            self.paths, self.thumbnails = None, {}
        self._listed = self._thumbnails_of = of
        if folder is None:
            self.paths = ()
            return

        def listed(paths: Sequence[Path]) -> None:
            if self._listed == of:
                self.paths = tuple(path for path in paths if self._named(path))
                self._make_thumbnails(of, self.paths)
                self.changed.emit()

        self._bench.glance(jobs.LIST_PICTURES, folder, label=self.tr("Listing pictures"), on_done=listed, offers={})

    def list_again(self) -> None:
        """The folder may hold others by now; what is shown stands until they are listed."""
        self._listed = ""
        self.follow()

    def _make_thumbnails(self, of: str, left: tuple[Path, ...]) -> None:
        now, later = left[:AT_ONCE], left[AT_ONCE:]
        if not now or of != self._listed:
            return

        def made(pictures: Sequence[Any]) -> None:
            if of == self._listed:
                self.thumbnails.update({self._named(p): picture for p, picture in zip(now, pictures, strict=True)})
                self.changed.emit()
                self._make_thumbnails(of, later)

        self._bench.glance(
            jobs.THUMBNAILS, list(now), self._model.project.rig.channel, label=self.tr("Small pictures"), on_done=made
        )
