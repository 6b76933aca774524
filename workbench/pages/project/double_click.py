"""Opening projects by double click: the system is told which program opens NAME.trisect, for this user alone.

Linux and its kin: a .desktop entry, a MIME type and an icon, as freedesktop.org has them (Desktop Entry Specification
1.5, Shared MIME-info Database 0.21). Windows: the user's own classes in the registry. macOS ties kinds of files to
bundles of programs, which this is not.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from PySide6.QtCore import QSettings
from PySide6.QtWidgets import QWidget

from core.errors import InputError
from core.files.atomic import make_folder, write_text
from core.files.project.folder import OPENER
from core.files.project.packing import PACKED
from core.messages import Message
from core.processes import program_command
from workbench.language import tr
from workbench.notices import Notices
from workbench.views import ask

MIME, PACKED_MIME = "application/x-trisect-project", "application/x-trisect-packed"
CLASS = "Trisect.Project"
PLATFORM = str(sys.platform)
CLASSES = r"HKEY_CURRENT_USER\Software\Classes"

NOTICED_WITHIN_S = 20.0
"""Seconds that the system's own programs have to take notice of new files: far more than they need."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """Result of an installation: one sentence, and the files concerned."""

    sentence: str
    files: tuple[Path, ...] = ()


def install(command: tuple[str, ...] | None = None) -> Outcome:
    """Register the program for this user to open projects by double click; doing it again changes nothing.

    Parameters
    ----------
    command
        What starts the program, if not the one that runs.

    Raises
    ------
    InputError
        If a file cannot be written, or this system has no such thing.
    """
    command = command or starter()
    if PLATFORM == "win32":
        _register(command)
        return Outcome(tr("Windows opens files NAME.trisect in Trisect now."))
    wanted = _wanted(command)
    for path, text in wanted.items():
        make_folder(path.parent)
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            write_text(path, text)
    unknown = _take_notice()
    sentence = tr("A double click on NAME.trisect in a project's folder opens it in Trisect now.")
    if unknown:
        sentence += " " + tr(
            "Log in again for it to work: {programs} is not installed here.", programs=", ".join(unknown)
        )
    return Outcome(sentence, tuple(wanted))


def uninstall() -> Outcome:
    """Remove the registration for opening projects by double click; no error if there is none.

    Raises
    ------
    InputError
        If a file cannot be removed, or this system has no such thing.
    """
    gone = tr("Projects are no longer opened by double click.")
    if PLATFORM == "win32":
        _unregister()
        return Outcome(gone)
    paths = tuple(path for path in _wanted(("",)) if path.exists())
    for path in paths:
        try:
            path.unlink()
        except OSError as error:
            raise InputError(
                Message("file.not_removed", "cannot be removed ({reason})", reason=str(error.strerror)),
                where=path,
                todo=Message("advice.remove_by_hand", "remove it by hand"),
            ) from error
    _take_notice()
    return Outcome(gone, paths)


def installed() -> bool:
    """Whether the program is registered for this user to open projects by double click."""
    if PLATFORM == "win32":
        return bool(_classes().value(f"{CLASS}/shell/open/command/."))
    return PLATFORM != "darwin" and all(path.exists() for path in _wanted(("",)))


def starter() -> tuple[str, ...]:
    """Return the command line that starts the running program."""
    return program_command("trisect-workbench", "workbench")


def _wanted(command: tuple[str, ...]) -> Mapping[Path, str]:
    """The files that tell the system, and what is in them."""
    if PLATFORM == "darwin":
        raise InputError(
            Message("window.no_bundle", "macOS opens files by double click only in programs that are bundles"),
            todo=Message(
                "advice.open_in_window", "open a project with File, Open project, or drop its folder on the window"
            ),
        )
    data = _data_home()
    return {data / name: text for name, text in entries(command).items()}


def entries(command: tuple[str, ...]) -> Mapping[str, str]:
    """Make the texts of the desktop files (freedesktop.org) that register the program, by path below `share`."""
    kinds = {"mime": MIME, "packed_mime": PACKED_MIME}
    entry = template("desktop", "trisect.desktop").format(command=" ".join(map(_quoted, command)), **kinds)
    package = template("desktop", "trisect.xml").format(opener=OPENER, packed=PACKED, **kinds)
    return {
        "applications/trisect.desktop": entry,
        "mime/packages/trisect.xml": package,
        "icons/hicolor/scalable/apps/trisect.svg": template("icons", "trisect.svg"),
    }


def template(folder: str, name: str) -> str:
    """Read a template file for the system, with {places} still to be filled."""
    return (files("resources") / folder / name).read_text(encoding="utf-8")


def _data_home() -> Path:
    """Where the user's own entries belong: XDG_DATA_HOME, which counts only if it is a full path."""
    set_ = Path(os.environ.get("XDG_DATA_HOME", ""))
    return set_ if set_.is_absolute() else Path.home() / ".local" / "share"


def _quoted(part: str) -> str:
    """An argument of Exec: quoted, then escaped as a string, and a percent sign doubled (Desktop Entry, "Exec")."""
    quoted = "".join("\\" + char if char in '"`$\\' else char for char in part)
    return '"' + quoted.replace("\\", "\\\\").replace("%", "%%") + '"'


def _take_notice() -> list[str]:
    """Have the system read the entries; the programs for it that are not there."""
    data, unknown = _data_home(), []
    for name, folder in (("update-mime-database", data / "mime"), ("update-desktop-database", data / "applications")):
        program = shutil.which(name)
        if program is None:
            unknown.append(name)
            continue
        with suppress(OSError, subprocess.SubprocessError):
            subprocess.run([program, str(folder)], check=False, capture_output=True, timeout=NOTICED_WITHIN_S)
    return unknown


def _register(command: tuple[str, ...]) -> None:
    """The user's own classes; "." names the default value of a key."""
    classes = _classes()
    start = " ".join(f'"{part}"' for part in command)
    for key, value in {
        f"{OPENER}/.": CLASS,
        f"{CLASS}/.": "Trisect project",
        f"{CLASS}/shell/open/command/.": f'{start} "%1"',
    }.items():
        classes.setValue(key, value)
    classes.sync()
    if classes.status() != QSettings.Status.NoError:
        raise InputError(Message("window.registry", "the registry cannot be written to"), where=CLASSES)


def _classes() -> QSettings:
    return QSettings(CLASSES, QSettings.Format.NativeFormat)


def _unregister() -> None:
    classes = _classes()
    classes.remove(CLASS)
    if classes.value(f"{OPENER}/.") == CLASS:
        classes.remove(OPENER)
    classes.sync()


def choose_double_click(window: QWidget, notices: Notices) -> None:
    """Ask whether double clicks are to open projects in this program, register or remove it, and show the result."""
    try:
        there = installed()
        text = _there() if there else _not_there()
        answers = [tr("Open by double click"), tr("Leave it as it is")]
        if there:
            answers = [tr("Renew"), tr("No longer"), tr("Leave it as it is")]
        answer = ask.ask(window, tr("Open projects by double click"), text, answers, harmless=True)
        if answer == len(answers) - 1:
            return
        outcome = install() if answer == 0 else uninstall()
    except InputError as error:
        notices.failed(error)
        return
    notices.info(outcome.sentence, "\n".join(map(str, outcome.files)))


def _there() -> str:
    return tr("A double click on NAME.trisect in a project's folder opens it in Trisect. Renew this where the program "
               "has been moved.")  # fmt: skip


def _not_there() -> str:
    return tr("Every project has a file NAME.trisect in its folder. Shall a double click on it open the project? "
               "The system is told so for you alone, and it can be taken back here.")  # fmt: skip
