"""Undo: every edit swaps one whole project for another, so nothing can be half undone."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtGui import QUndoCommand

from core.files.project import Project


class Edit(QUndoCommand):
    """One change of the project by the user; edits with the same `merge_key` in a row become one.

    Parameters
    ----------
    label
        What the Undo menu calls it: "leave out view03".
    before, after
        The whole project before and after.
    show
        Called with the project to be in force.
    """

    def __init__(
        self, label: str, before: Project, after: Project, show: Callable[[Project], None], merge_key: str = ""
    ) -> None:
        super().__init__(label)
        self.before, self.after, self.merge_key = before, after, merge_key
        self._show = show

    def redo(self) -> None:
        self._show(self.after)

    def undo(self) -> None:
        self._show(self.before)

    def id(self) -> int:
        return hash(self.merge_key) & 0x3FFFFFFF if self.merge_key else -1

    def mergeWith(self, other: QUndoCommand) -> bool:
        if not isinstance(other, Edit) or not self.merge_key or other.merge_key != self.merge_key:
            return False
        self.after = other.after
        if self.after == self.before:
            self.setObsolete(True)
        return True
