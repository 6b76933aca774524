"""The picture that is looked at."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from PySide6.QtCore import QObject, Signal

from workbench.bench import Bench
from workbench.pages.calibration.work import CalibrationWork
from workbench.work import jobs


class CurrentPicture(QObject):
    """Reader of the `current` picture; it reads again only where another one is chosen.

    `label` names the reading; of those of one label only the newest is wanted.
    """

    picture = Signal(str, object)
    """Name of the current picture, and the picture."""

    def __init__(
        self, bench: Bench, work: CalibrationWork[Any, Any], label: str, parent: QObject | None = None
    ) -> None:
        super().__init__(parent)
        self._bench, self._model, self._work, self._label = bench, bench.model, work, label
        self.forget()

    def forget(self) -> None:
        """Reset: no picture is current."""
        self.current = ""
        self._read: tuple[Any, ...] = ()

    def again(self) -> None:
        """Read the current picture from its file again."""
        self._read = ()
        self.refresh()

    def names(self) -> Sequence[str]:
        """List the names of the calibration's pictures."""
        return [self._work.name_of(path) for path in self._work.pictures or ()]

    def follow(self) -> None:
        """Keep the current picture while it exists, else choose the first one; then read it."""
        names = self.names()
        if self.current not in names:
            self.current = names[0] if names else ""
        self.refresh()

    def refresh(self) -> None:
        """Read the current picture in the background, unless it is read already."""
        name = self.current
        path = next((path for path in self._work.pictures or () if self._work.name_of(path) == name), None)
        if not name or path is None or self._read == (name,):
            return
        self._read = (name,)
        self._bench.run_quick(
            self,
            jobs.READ_PICTURE,
            path,
            self._model.project.rig.channel_of(self._work.STEP),
            self._model.project.rig.mosaic,
            label=self._label,
            on_done=lambda found: self.picture.emit(name, found) if name == self.current else None,
            offers={},
            replace_waiting=True,
        )
