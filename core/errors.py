"""The one kind of error a user is meant to read."""

from __future__ import annotations


class InputError(Exception):
    """Something in the input keeps us from measuring: one clear sentence.

    The sentence says what is wrong, where (file, frame or field), why it matters, and what to do next.

    Parameters
    ----------
    what
        What is wrong, and why, without a full stop: ``"the board has 8 × 6 inner corners, not 9 × 6"``.
    where
        File, frame or field it was found in; put in front of the sentence.
    todo
        What to do next; put behind it.
    """

    def __init__(self, what: str, *, where: object = "", todo: str = "") -> None:
        self.what = what
        self.where = str(where)
        self.todo = todo
        front = f"{self.where}: " if self.where else ""
        back = f"; {todo}" if todo else ""
        super().__init__(f"{front}{what}{back}.")

    def __reduce__(self) -> tuple[object, ...]:
        return _restored, (type(self), self.what, self.where, self.todo)


def _restored(kind: type[InputError], what: str, where: str, todo: str) -> InputError:
    """An InputError that came from another process."""
    return kind(what, where=where, todo=todo)


class Cancelled(Exception):
    """The user asked a job to stop; nothing half done may be kept."""
