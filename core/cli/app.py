"""`trisect`: what each command takes, and what its exit code says.

0: done, and conforming if a verdict was asked for. 1: measured, but out of tolerance or not proven. 2: bad input, told
in one sentence on standard error. 3: measured, but no thickness could be found. 70: a fault of the program, in one
sentence that names the report of it. 129, 130, 143: ended by SIGHUP, Ctrl-C, SIGTERM. Numbers come from the rooms
below; here is only talk. Those rooms are imported by the command that needs them: so `trisect --help` answers at once.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, Sequence
from functools import cache
from io import TextIOWrapper
from typing import Annotated, Any

import typer
from typer.main import get_command, get_group

from core import __version__
from core.cli import language, talk
from core.cli.interrupts import Interrupts, interruptible
from core.cli.measuring_commands import commands as measuring
from core.cli.options import EPILOG, ExitCode
from core.cli.preparing_commands import commands as preparing
from core.cli.project_commands import commands as projects
from core.cli.result_commands import commands as results
from core.cli.simulating import HELP_VALUES
from core.cli.simulating import commands as simulating
from core.cli.usage import Commands, NoArgsIsHelpError, UsageError, usage_error
from core.door import Brought, found_at
from core.errors import Cancelled, InputError, NoThickness
from core.messages import Message
from core.messages import as_json as as_json_message
from core.wing import Wing, note_on_no_wings, wings

app = typer.Typer(
    name="trisect",
    cls=Commands,
    help="Measure a part with one camera, a fixed three-line laser and a hand-moved single-line laser.",
    epilog=EPILOG,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": language.HELP_OPTIONS},
)
for commands in (measuring, results, preparing, projects, simulating):
    app.add_typer(commands)


def _say_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"trisect {__version__}")
        raise typer.Exit


@app.callback()
def _trisect(
    version: Annotated[
        bool, typer.Option("--version", callback=_say_version, is_eager=True, help="Print the version and leave.")
    ] = False,
) -> None:
    """Only holds --version; the commands do the rest."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line `arguments`, by default the program's own, and exit with the command's exit code."""
    # OpenCV mumbles about damaged pictures and films on standard error; what matters is said in our own sentence.
    os.environ["OPENCV_LOG_LEVEL"] = "SILENT"
    os.environ["OPENCV_FFMPEG_LOGLEVEL"] = "-8"  # FFmpeg's AV_LOG_QUIET
    words = list(sys.argv[1:] if arguments is None else arguments)
    language.choose_loudness(talk.Loudness.USUAL)
    if isinstance(sys.stdout, TextIOWrapper):  # a file in the encoding of Windows has no σ: no reason to fail
        sys.stdout.reconfigure(errors="replace")
    with interruptible() as interrupts:
        try:
            language.choose(words)
            _run(words)
        except BrokenPipeError:
            # Whoever read our output has left; Python would complain once more when it closes standard output.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        except (Exception, KeyboardInterrupt) as error:  # noqa: BLE001  the one door for whatever nobody foresaw, too
            sys.exit(_failed(error, words, interrupts))


def _failed(error: BaseException, words: Sequence[str], interrupts: Interrupts) -> ExitCode:
    """Tell why a command was not done; what the program leaves with.

    What fails once the command was asked to end fails because of that: its second process is gone, or its terminal.
    """
    if interrupts.signal or not isinstance(error, Exception) or isinstance(error, Cancelled):
        told = language.tr("interrupted; what was finished before is whole, nothing is half written.")
        talk.print_always(f"trisect: {told}")
        return interrupts.code
    from core.files.reading import refused_path

    refused = error if isinstance(error, InputError) else refused_path(error)
    _refuse(refused or _fault(words, error), as_json="--json" in words)
    if refused is None:
        return ExitCode.FAULT
    return ExitCode.NO_THICKNESS if isinstance(refused, NoThickness) else ExitCode.BAD_INPUT


def _run(words: list[str]) -> None:
    """Run the commands; they leave by SystemExit with their own code."""
    try:
        command = _commands(language.current_language().name)
        language.name_panels()
        sys.exit(command(words, prog_name="trisect", standalone_mode=False))
    except NoArgsIsHelpError:
        sys.exit(ExitCode.BAD_INPUT)
    except UsageError as error:
        raise usage_error(error, words) from error
    finally:
        sys.stdout.flush()  # here, where a closed pipe can still be told apart from a failure


@cache
def _commands(_spoken: str) -> Any:
    """Every command in the language that is spoken: Typer reads all functions for it, which takes 0.1 s."""
    command, unusable = whole_command()
    _say_unusable(unusable)
    if note := note_on_no_wings():
        talk.print_line(language.text_of(note))
    return language.speak(command, HELP_VALUES)


def whole_command() -> tuple[Any, list[Brought]]:
    """Make the group of all commands, those of the wings among them, and list the wings that cannot be used."""
    from core.files.results.export_list import unusable_exports
    from core.findings.table import unusable_findings

    command: Any = get_command(app)
    unusable = [*wings().unusable, *unusable_findings(), *unusable_exports()]
    for wing, origin in wings().wings:
        try:
            command.commands = with_commands(command.commands, wing)
        except Exception as error:  # noqa: BLE001  (whatever a stranger's module raises: all other commands stand)
            unusable.append(Brought(wing.name, None, f"{type(error).__name__}: {error}", origin))
    return command, unusable


def with_commands(commands: Mapping[str, Any], wing: Wing) -> dict[str, Any]:
    """Insert a wing's commands into `commands` after the command that the wing names; else at the end.

    Raises
    ------
    ValueError
        If the wing has a command of a name that is taken.
    """
    brought = get_group(found_at(wing.commands)).commands if wing.commands else {}
    if taken := sorted(brought.keys() & commands.keys()):
        raise ValueError(f"there is a command {taken[0]} already")
    names = list(commands)
    place = names.index(wing.after) + 1 if wing.after in commands else len(names)
    return {**{name: commands[name] for name in names[:place]}, **brought, **{n: commands[n] for n in names[place:]}}


def _say_unusable(unusable: Sequence[Brought]) -> None:
    """Say which wings cannot be used, and why."""
    if unusable:
        from core.findings.brought import note_on_unusable

        for one in unusable:
            talk.print_line(language.text_of(note_on_unusable(one)))


def _fault(words: Sequence[str], error: Exception) -> InputError:
    """An unexpected error as a sentence; its details are written to a report."""
    from core.files.fault_report import write_fault_report

    path = write_fault_report(words, error)
    what = Message("cli.fault", "a fault of the program kept it from going on ({name})", name=type(error).__name__)
    if path is None:
        return InputError(what)
    return InputError(what, todo=Message("advice.send_report", "please send the report {path}", path=path))


def _refuse(error: InputError, *, as_json: bool) -> None:
    if as_json:
        from core.files.json_text import to_json

        told = {
            "error": str(error),
            **as_json_message(error.what),
            "where": str(error.where),
            "todo": as_json_message(error.todo),
        }
        sys.stdout.write(to_json(told))
    talk.print_always(f"trisect: {language.text_of(error)}")
