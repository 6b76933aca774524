"""What is wrong with a command line, told as every other refusal: one sentence, in the reader's language."""

from __future__ import annotations

import difflib
import sys
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import typer
from typer.core import TyperGroup
from typer.main import get_group

from core.door import found_at
from core.errors import Cancelled, InputError
from core.messages import Message, plain
from core.wing import OUR_COMMANDS, why_away, wings

_ERRORS: Any = sys.modules[typer.BadParameter.__module__]
"""Typer carries click in a package of its own, which is called otherwise in other versions of it."""
UsageError: type[Exception] = _ERRORS.UsageError
"""What Typer raises for a command line that it cannot read."""
NoArgsIsHelpError: type[Exception] = _ERRORS.NoArgsIsHelpError
"""What it raises after it has printed the help, where nothing was typed."""


class Commands(TyperGroup):
    """Group of commands; Ctrl-C passes through as `Cancelled`, or Typer would exit with the code of "not proven"."""

    def invoke(self, ctx: typer.Context) -> Any:  # type: ignore[override]
        """Run the command that was typed (called by Typer)."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as interrupt:
            raise Cancelled from interrupt

    def resolve_command(self, ctx: typer.Context, args: list[str]) -> Any:  # type: ignore[override]
        """Find the command that was typed (called by Typer); InputError if there is no such command."""
        if args[0] not in self.commands:
            if ctx.parent is None and (wing := missing_wing(args[0])):
                why, todo = why_away(wing)
                what = Message(
                    "cli.command_of_missing_wing",
                    'the command "{command}" is of the wing {wing}, {why}',
                    command=args[0],
                    wing=wing,
                    why=why,
                )
                raise InputError(what, todo=todo)
            what = Message("cli.no_such_command", 'there is no command "{command}"', command=args[0])
            raise InputError(what, todo=_see_help(ctx, difflib.get_close_matches(args[0], self.commands)))
        return super().resolve_command(ctx, args)


def missing_wing(command: str) -> str:
    """Return the name of the missing wing that has this command; "" if no such wing is known."""
    if command in OUR_COMMANDS:
        return OUR_COMMANDS[command]
    for wing in wings().away:
        with suppress(Exception):  # whatever a stranger's module raises: then it has no command that could be told
            if wing.commands and command in get_group(found_at(wing.commands)).commands:
                return wing.name
    return ""


def usage_error(error: Any, words: Sequence[str]) -> InputError:
    """Convert an error of Typer's about the command line to an InputError.

    Parameters
    ----------
    error
        A `UsageError`.
    words
        The command line.
    """
    ctx, where = error.ctx, ""
    choices: Sequence[str] = ()
    near: Sequence[str] = ()
    match error:
        case _ERRORS.NoSuchOption():
            what = Message("cli.no_such_option", "there is no option {option}", option=error.option_name)
            near = error.possibilities or ()
        case _ERRORS.BadOptionUsage():
            where = error.option_name
            given = any(word.startswith(f"{where}=") for word in words)
            what = (
                Message("cli.takes_no_value", "takes no value")
                if given
                else Message("cli.needs_value", "needs a value")
            )
        case _ERRORS.MissingParameter():
            what = Message("cli.missing", "{name} is missing", name=_name(error.param))
        case _ERRORS.BadParameter() if error.param is not None:
            where = _name(error.param)
            what, choices = _bad_value(error)
        case _ if ctx is not None and hasattr(ctx.command, "commands"):  # a name that is none is refused by `Commands`
            what = Message("cli.no_command", "a command is missing")
        case _:
            # Typer names the words in its sentence only: "Got unexpected extra argument(s) (b c)".
            extra = error.message.partition("(s) (")[2].removesuffix(")") or error.message
            what = Message("cli.too_many_words", 'there is no place for "{extra}"', extra=extra)
    return InputError(what, where=where, todo=_choose(choices) if choices else _see_help(ctx, near))


def _name(param: Any) -> str:
    """What the user calls it: --out, SET."""
    return str(param.opts[0] if param.param_type_name == "option" else param.metavar)


def _bad_value(error: Any) -> tuple[Message, Sequence[str]]:
    """What is wrong with a value, and the values there are, where they can be counted."""
    if error.__cause__ is None:
        return plain(error.message), ()
    found = error.__cause__.errors()[0]  # pydantic's
    value = str(found["input"])
    if found["type"].startswith("int_"):
        return Message("cli.not_a_whole_number", '"{value}" is no whole number', value=value), ()
    if found["type"].startswith("float_"):
        return Message("cli.not_a_number", '"{value}" is no number', value=value), ()
    choices = error.param.type_descriptor.choices
    if choices is None:
        return plain(error.message), ()
    told = Message("export.no_such_choice", 'there is no "{chosen}"', chosen=value)
    return told, [str(one.value) for one in choices]


def _choose(choices: Sequence[str]) -> Message:
    return Message("advice.choose_among", "choose among {choices}", choices=tuple(choices))


def _see_help(ctx: Any, near: Sequence[str]) -> Message | str:
    if near:
        return Message("advice.perhaps", "perhaps you mean {choices}", choices=tuple(near))
    return Message("advice.see_help", "see {command} --help", command=ctx.command_path) if ctx is not None else ""
