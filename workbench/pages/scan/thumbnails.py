"""Small pictures of the frames: made for those that are looked at, when they are, and kept."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QObject, Signal

from workbench.bench import Bench
from workbench.language import tr
from workbench.pages.scan.run import short
from workbench.pages.sources import folder_of
from workbench.work import jobs

AT_ONCE = 6
"""So many are made in one go, so that what the eye waits for comes between."""

IN_SIGHT = 24
"""Of those wanted and not made yet, the last so many are still in sight."""


class FrameThumbnails(QObject):
    """Small `pictures` by the names of the frames; None for one that cannot be read."""

    changed = Signal()

    def __init__(self, bench: Bench, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._bench, self._model = bench, bench.model
        self.forget()

    def forget(self) -> None:
        """Drop all thumbnails, as another recording is used."""
        self.pictures: dict[str, Any] = {}
        self._of = self._source()
        self._wanted: dict[str, None] = {}
        self._making = False

    def follow(self) -> None:
        """Drop the thumbnails if the recording or its colour channel has changed."""
        if self._of != self._source():
            self.forget()

    def request(self, name: str) -> None:
        """Read the thumbnail of the frame called `name` in the background, unless it is there."""
        if name in self.pictures:
            return
        self._wanted.pop(name, None)
        self._wanted[name] = None  # the newest last
        if not self._making:
            self._make()

    def _make(self) -> None:
        names = list(self._wanted)[-IN_SIGHT:][:AT_ONCE]
        folder, of = folder_of(self._model, "scan"), self._of
        if not names or folder is None:
            return
        self._wanted = dict.fromkeys(list(self._wanted)[-IN_SIGHT:][AT_ONCE:])
        self._making = True

        def ended(pictures: tuple[Any, ...]) -> None:
            if of != self._of:
                return
            self._making = False
            self.pictures.update(zip(names, pictures, strict=True))
            self.changed.emit()
            self._make()

        self._bench.quick.run(
            self,
            jobs.STRIPE_THUMBNAILS,
            [folder / short(name) for name in names],
            self._model.project.rig.channel_of("scan"),
            self._model.project.rig.mosaic,
            label=tr("Small pictures"),
            on_done=ended,
            on_failed=lambda _: ended((None,) * len(names)),
            on_cancelled=lambda: ended((None,) * len(names)),
        )

    def _source(self) -> str:
        project = self._model.project
        rig = project.rig
        return f"{self._model.folder}|{project.sources.scan}|{rig.channel_of('scan')}|{rig.mosaic}"
