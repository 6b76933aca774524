"""The language of the command line: every text that it prints goes through here, from the catalogues of all rooms.

It is chosen before anything is printed: by ``--language``, TRISECT_LANGUAGE, or the locale. What ``--json`` prints is
English in every language. Light to import.
"""

from __future__ import annotations

import inspect
import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import copy
from functools import cache
from typing import Annotated, Any

import typer
from typer.main import get_command

from core.cli import talk
from core.errors import InputError
from core.files_read import listen
from core.messages import ENGLISH, Language, Message, label

OPTION = "--language"
HELP_OPTIONS = ["-h", "--help"]
_HELP = label("Language of what is printed: {languages}; else TRISECT_LANGUAGE, or the locale's.")
_QUIET = label("Say nothing on standard error but errors.")
_VERBOSE = label(
    "Say on standard error, too, which files are read, how long each stage took and where compiled code is kept."
)
_TYPERS_OWN = {
    "ARGUMENTS_PANEL_TITLE": label("Arguments"),
    "OPTIONS_PANEL_TITLE": label("Options"),
    "COMMANDS_PANEL_TITLE": label("Commands"),
    "REQUIRED_LONG_STRING": label("[required]"),
}
"""Words that Typer puts into help, by their names in its module."""
_COMPLETION = (
    label("Install completion for the current shell."),
    label("Show completion for the current shell, to copy it or customize the installation."),
)
"""Typer's own help of its two options."""
_DEFAULT = label("default")
_SHOW_HELP = label("Show this message and exit.")
_USAGE = label("Usage:")
_OPTIONS_PLACE, _COMMAND_PLACE = label("[OPTIONS]"), label("COMMAND [ARGS]...")
"""Places in the line behind it."""

_spoken: Language = ENGLISH


def choose(words: Sequence[str]) -> None:
    """Set the language from the option in the command line `words`, else from the environment.

    Raises
    ------
    core.errors.InputError
        If there is no such language.
    """
    global _spoken
    _spoken = _named([os.environ.get("TRISECT_LANGUAGE", ""), _locale()])
    if asked := _asked_for(words):
        from core.cli.options import one_of
        from core.translations import PSEUDO, languages

        _spoken = _named([PSEUDO if asked == PSEUDO else one_of(asked, languages(), OPTION)])


def speak_as(name: str, loudness: talk.Loudness) -> None:
    """Set the language called `name` and the loudness, in another process of the same command."""
    if name != _spoken.name:
        choose([f"{OPTION}={name}"])
    if loudness != talk.loudness():
        choose_loudness(loudness)


def choose_loudness(loudness: talk.Loudness) -> None:
    """Set how much is printed from now on; if verbose, the name of each file that is read."""
    talk.choose(loudness)
    listen((lambda path: talk.print_line(tr("file read: {file}", file=path))) if talk.is_verbose() else None)


def _named(wanted: Sequence[str]) -> Language:
    first = next(filter(None, wanted), "en")
    if first in ("C", "POSIX") or first.startswith(("en_", "C.")) or first == "en":
        return ENGLISH  # without Babel, which costs 0.05 s
    from core.translations import language, preferred

    return language(preferred(wanted))


def _locale() -> str:
    """The locale that texts are in, by the order of POSIX, without its encoding: 'zh_CN'."""
    names = (os.environ.get(name, "") for name in ("LC_ALL", "LC_MESSAGES", "LANG"))
    return next(filter(None, names), "").partition(".")[0].partition("@")[0]


def _asked_for(words: Sequence[str]) -> str:
    for place, word in enumerate(words):
        if word == "--":
            break
        if word == OPTION:
            return next(iter(words[place + 1 :]), "")
        if word.startswith(f"{OPTION}="):
            return word.partition("=")[2]
    return ""


def current_language() -> Language:
    """Return the language in which the command line prints."""
    return _spoken


def tr(english: str, /, **values: Any) -> str:
    """Translate fixed English words, with `values` in their places: `tr("{n} triangles", n=3)`."""
    return _spoken.label(english, **values)


def text_of(said: Message | InputError | str) -> str:
    """Translate a message, an error or fixed words; any other text stays as it is."""
    if isinstance(said, InputError):
        return said.text_in(_spoken)
    return _spoken(said) if isinstance(said, Message) else _spoken.label(str(said))


def speak(command: Any, values: Mapping[str, str]) -> Any:
    """Translate the help of a command, its options and subcommands; `values` fill the placeholders in the help."""
    from core.translations import languages

    values, everywhere = {**values, "languages": ", ".join(languages())}, _taken_everywhere()
    for one in _all_of(command):
        own = {name for option in one.params for name in option.opts}
        one.params += [copy(option) for option in everywhere if not own & set(option.opts)]
        help_option = one.get_help_option(typer.Context(one, help_option_names=HELP_OPTIONS))
        help_option.help = _SHOW_HELP
        one.context_class, one.options_metavar = _Context, tr(_OPTIONS_PLACE)
        one.help, one.epilog = _helped(one.help, values), _helped(one.epilog, values)
        one.rich_help_panel = _helped(one.rich_help_panel, values)
        if hasattr(one, "commands"):
            one.subcommand_metavar = tr(_COMMAND_PLACE)
        for shown in (*one.params, help_option):
            shown.help = _helped(shown.help, values)
            if shown.param_type_name == "argument" or shown.is_flag:
                shown.display_type = _no_type
    return command


def name_panels() -> None:
    """Translate the words that Typer itself prints in help."""
    if _spoken is ENGLISH and "typer.rich_utils" not in sys.modules:
        return  # it costs a start, and speaks English by itself
    from typer import rich_utils

    _fold_help()
    for name, english in _TYPERS_OWN.items():
        setattr(rich_utils, name, tr(english))
    rich_utils.DEFAULT_STRING = f"[{tr(_DEFAULT)}: {{}}]"


@cache
def _fold_help() -> None:
    """Help without spaces, as Chinese has it, is put on several lines; Rich would cut it at the end of the first."""
    from typer import rich_utils

    make: Any = rich_utils._make_rich_text

    def folded(*given: Any, **named: Any) -> Any:
        text = make(*given, **named)
        text.overflow = "fold"
        return text

    rich_utils._make_rich_text = folded


def _no_type(_: typer.Context) -> str:
    """Neither <path> is said of a SET nor <bool> of an option that takes no value."""
    return ""


class _UsageLine(typer.Context.formatter_class):  # type: ignore[misc, valid-type]
    """The line that says what may be typed, in the language."""

    def write_usage(self, prog: str, args: str = "", prefix: str | None = None) -> None:
        super().write_usage(prog, args, f"{tr(_USAGE)} " if prefix is None else prefix)


class _Context(typer.Context):
    formatter_class = _UsageLine


def _louder_or_not(loudness: talk.Loudness) -> Callable[[bool], None]:
    def choose(wanted: bool) -> None:
        if wanted:
            choose_loudness(loudness)

    return choose


def _takes(
    quiet: Annotated[
        bool,
        typer.Option("--quiet", "-q", callback=_louder_or_not(talk.Loudness.QUIET), show_default=False, help=_QUIET),
    ] = False,
    verbose: Annotated[
        bool,
        typer.Option(
            "--verbose", "-v", callback=_louder_or_not(talk.Loudness.VERBOSE), show_default=False, help=_VERBOSE
        ),
    ] = False,
    language: Annotated[str, typer.Option(OPTION, metavar="CODE", show_default=False, help=_HELP)] = "",
) -> None:
    """What every command takes, before its name or behind it; `choose` has read the language already."""


def _taken_everywhere() -> list[Any]:
    """The options of `_takes`, for commands that are not to be told of them."""
    of_one = typer.Typer(add_completion=False)
    of_one.command()(_takes)
    options = get_command(of_one).params
    for option in options:
        option.expose_value = False
    return options


def _all_of(command: Any) -> Iterator[Any]:
    yield command
    for one in getattr(command, "commands", {}).values():
        yield from _all_of(one)


def _helped(english: str | None, values: Mapping[str, str]) -> str | None:
    return tr(inspect.cleandoc(english), **values) if english else english
