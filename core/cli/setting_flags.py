"""Flags of commands for the settings of their steps, from the table of settings. Light to import."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from enum import Enum
from functools import wraps
from types import MappingProxyType
from typing import Annotated, Any, TypeAlias

import typer

from core.settings.options import settings_of
from core.settings.setting import Choice, Number, Row, Setting, rows_within

Typed: TypeAlias = Mapping[str, Any]
"""What was typed of the settings, by the words of their flags."""
NOTHING_TYPED: Typed = MappingProxyType({})
"""Stands in the signature of a command where the flags come."""


def takes(*steps: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Make a decorator that gives a command the flags of all settings of `steps` in place of its parameter `typed`."""
    within = [one for step in steps for row in settings_of(step) for one in rows_within(row)]
    flags = {parameter.name: parameter for parameter in map(_parameter, within) if parameter is not None}

    def with_flags(command: Callable[..., None]) -> Callable[..., None]:
        own = inspect.signature(command, eval_str=True)

        @wraps(command)
        def called(**given: Any) -> None:
            command(typed={word: given.pop(word) for word in flags}, **given)

        parameters = [
            one
            for own_one in own.parameters.values()
            for one in (flags.values() if own_one.name == "typed" else [own_one])
        ]
        called.__signature__ = own.replace(parameters=parameters)  # type: ignore[attr-defined]
        called.__annotations__ = {one.name: one.annotation for one in parameters}
        del called.__wrapped__
        return called

    return with_flags


def _parameter(row: Row) -> inspect.Parameter | None:
    """The flag of a setting as a parameter of a command; None if it has none."""
    flag = row.setting.flag
    if flag is None:
        return None
    usual = row.default if flag.none is None else flag.none
    option = typer.Option(flag.name, metavar=flag.value, help=flag.help, show_default=usual is not None)
    word = _type(row.setting)
    annotation: Any = Annotated[word if usual is not None else word | None, option]
    return inspect.Parameter(flag.word, inspect.Parameter.POSITIONAL_OR_KEYWORD, default=usual, annotation=annotation)


def _type(one: Setting) -> Any:
    """What Typer makes of the word typed."""
    if isinstance(one.kind, Number):
        return float
    if not isinstance(one.kind, Choice) or True in one.kind.values:
        return bool
    words = {str(value): value for value in one.kind.values if value is not None}
    return one.kind.type or Enum(one.title or "Word", words, type=str)
