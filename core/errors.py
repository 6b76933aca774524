"""Errors a user is meant to read: what keeps us from measuring, and values that nothing can be made of."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from core.messages import ENGLISH, Label, Language, Message, plain, visible

LONGEST = 300
"""Characters of a sentence beyond which names and texts from outside are shortened in it; our own words never are."""
_FOREIGN = 90
"""Characters that a text from outside keeps then."""
_WORD = 40
"""Characters that a word keeps at least."""


class InputError(Exception):
    """Error in the input that makes measuring impossible: one clear sentence.

    The sentence says what is wrong, where (file, frame or field), why it matters, and what to do next.

    Parameters
    ----------
    what
        What is wrong, and why, without a full stop: 'the board has 8 × 6 inner corners, not 9 × 6'.
    where
        File, frame or field it was found in, or a message that names it; put in front of the sentence.
    todo
        What to do next; put behind it.
    """

    def __init__(self, what: Message | str, *, where: object = "", todo: Message | str = "") -> None:
        self.what = what if isinstance(what, Message) else plain(what)
        self.where = where if isinstance(where, Message) else str(where)
        self.todo = todo if isinstance(todo, Message) else plain(todo)
        super().__init__(self.text_in())

    @property
    def code(self) -> str:
        """Code of the error's sentence, for programs."""
        return self.what.code

    def text_in(self, language: Language = ENGLISH) -> str:
        """Return the error's whole text, with place and advice, in a `language`."""
        where = self.where if isinstance(self.where, Message) else plain(self.where)
        parts = (where, self.what, self.todo)
        told = _with_short_words([visible(language(part)) for part in parts])
        if _length(told) > LONGEST:
            told = _with_short_words([visible(language(_with_short_texts(part))) for part in parts])
        return language(_sentence(*map(plain, told)))

    @property
    def reason(self) -> Message:
        """Place and reason of the error, without a full stop and without advice, to be put into another message."""
        where = self.where if isinstance(self.where, Message) else plain(self.where)
        return Message("input.reason", "{where}: {what}", where=where, what=self.what) if where.text else self.what

    @property
    def message(self) -> Message:
        """Whole sentence of the error as a message, for notes and files."""
        where = self.where if isinstance(self.where, Message) else plain(self.where)
        return _sentence(where, self.what, self.todo)

    def __reduce__(self) -> tuple[object, ...]:
        return _restored, (type(self), self.what, self.where, self.todo)


class NoThickness(InputError):
    """Error that a part was measured, but no thickness could be found."""


class OwnCause(InputError):
    """Error whose cause is seen itself: no other possible causes are named with it."""


class WrongValue(ValueError):
    """Error that a value is unusable, with a message for the user who gave it.

    Algorithms and data types raise it. The code that knows where the value came from (a file, a table, a field of the
    window) tells it as an `InputError`.

    Parameters
    ----------
    what
        What is wrong, without a full stop: 'a gauge R&R study needs values that differ'.
    """

    def __init__(self, what: Message) -> None:
        super().__init__(what)
        self.what = what


def _sentence(where: Message, what: Message, todo: Message) -> Message:
    if where.text and todo.text:
        return Message("input.where_what_todo", "{where}: {what}; {todo}.", where=where, what=what, todo=todo)
    if where.text:
        return Message("input.where_what", "{where}: {what}.", where=where, what=what)
    if todo.text:
        return Message("input.what_todo", "{what}; {todo}.", what=what, todo=todo)
    return Message("input.what", "{what}.", what=what)


def words_of(error: Exception) -> Message | str:
    """Return the text of an error to be put into a message: an InputError's reason, or another error's own words."""
    return error.what if isinstance(error, (InputError, WrongValue)) else str(error)


def _length(parts: Sequence[str]) -> int:
    """Characters of the sentence made of place, what is wrong and what to do."""
    return sum(map(len, parts)) + len(": ; .")


def _with_short_words(parts: Sequence[str]) -> list[str]:
    """The parts of a sentence, the longest words cut so that it ends at LONGEST characters: these keep their ends."""
    parts = list(parts)
    while (excess := _length(parts) - LONGEST) > 0:
        longest = max((word for part in parts for word in part.split(" ")), key=len)
        if len(longest) <= _WORD:
            break
        opening = f"{longest[0] if longest[0] in '([' else ''}…"
        kept = max(_WORD, len(longest) - excess) - len(opening)  # one character less at least: this ends
        parts = [part.replace(longest, opening + longest[-kept:]) for part in parts]
    return parts


def _with_short_texts(message: Message) -> Message:
    """The same with the texts from outside in it cut after _FOREIGN characters; our own words stay whole."""
    return message.with_values(_short) if message.code else plain(_short(str(message)))


def _short(value: Any) -> Any:
    """A value of a message: a text from outside is cut, also within messages and sequences."""
    if isinstance(value, Message):
        return _with_short_texts(value)
    if isinstance(value, tuple):
        return tuple(map(_short, value))
    if isinstance(value, str) and not isinstance(value, Label) and len(value) > _FOREIGN and " " in value:
        return f"{value[: _FOREIGN - 1].rsplit(' ', 1)[0]} …"
    return value


def refuse(error: InputError) -> None:
    """Raise `error`: the job for something that must not be done."""
    raise error


def _restored(kind: type[InputError], what: Message, where: Message | str, todo: Message) -> InputError:
    """An InputError that came from another process."""
    return kind(what, where=where, todo=todo)


class Cancelled(Exception):
    """Exception that the user asked a job to stop; nothing half done may be kept."""
