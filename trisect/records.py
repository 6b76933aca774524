"""Records that are given to a function: one of another kind than it needs is refused at the door, in a sentence."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import is_dataclass
from functools import cache, wraps
from types import UnionType
from typing import Any, ParamSpec, TypeVar, Union, get_args, get_origin, get_type_hints

from core.errors import InputError
from core.messages import Message

P = ParamSpec("P")
R = TypeVar("R")


@cache
def checked(function: Callable[P, R]) -> Callable[P, R]:
    """Wrap a function so that it raises InputError for a record of another type than its annotations name."""
    signature = inspect.signature(function)
    kinds = get_type_hints(function)

    @wraps(function)
    def at_the_door(*args: P.args, **named: P.kwargs) -> R:
        for name, value in signature.bind(*args, **named).arguments.items():
            for where, one, needed in _records(name, value, kinds.get(name)):
                if not isinstance(one, needed):
                    raise _refused(where, type(one), needed, function.__name__)
        return function(*args, **named)

    at_the_door.__module__ = __package__  # where it is found, and pickled by
    return at_the_door


def _records(name: str, value: object, hint: Any) -> Iterator[tuple[str, object, tuple[type, ...]]]:
    """What must be a record, where it is, and the kinds that it may be; nothing where anything else is asked for."""
    if needed := _kinds(hint):
        yield name, value, needed
    elif get_origin(hint) is Sequence and (needed := _kinds(*get_args(hint))):
        if not isinstance(value, Iterable):
            yield name, value, (Sequence,)
        for number, one in enumerate(value if isinstance(value, Sequence) else ()):
            yield f"{name}[{number}]", one, needed


def _kinds(hint: Any) -> tuple[type, ...]:
    """The kinds of records that an annotation names; none if it names anything else."""
    kinds = get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,)
    return kinds if all(one is type(None) or is_dataclass(one) for one in kinds) else ()


def _refused(where: str, given: type, needed: Sequence[type], function: str) -> InputError:
    names = " or ".join(_name(one) for one in needed if one is not type(None))
    return InputError(
        Message("api.wrong_record", "{given} is given where {needed} is needed", given=_name(given), needed=names),
        where=where,
        todo=Message("api.advice_record", "help(trisect.{function}) says what to give", function=function),
    )


def _name(kind: type) -> str:
    """As scripts know it."""
    from trisect import promised

    return next((name for name in promised.__all__ if getattr(promised, name) is kind), kind.__name__)
