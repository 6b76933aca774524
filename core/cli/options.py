"""Options that several commands take, in the same words everywhere."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum, IntEnum
from pathlib import Path
from typing import Annotated

import typer

from core.errors import InputError
from core.messages import Message, label


class ExitCode(IntEnum):
    """Exit codes of the program."""

    DONE = 0
    NOT_PROVEN = 1
    BAD_INPUT = 2
    NO_THICKNESS = 3
    FAULT = 70
    """As sysexits.h of BSD calls it: EX_SOFTWARE."""
    HUNG_UP = 129
    INTERRUPTED = 130
    TERMINATED = 143
    """These three as shells have it: 128 and the number of the signal."""


EPILOG = label(
    "Exit code: 0 done, 1 measured but out of tolerance or not proven, 2 bad input, 3 measured but no thickness could "
    "be found, 70 a fault of the program, 129 hung up, 130 interrupted, 143 terminated."
)


class Panel:
    """Headings of the commands in `trisect --help`, in the order of their first commands."""

    MEASURE = label("Measure a part")
    CALIBRATE = label("Calibrate and check the rig")
    RESULTS = label("Reports, studies, other programs")
    PREPARE = label("Before a measurement")
    PROJECTS = label("Projects of the window")
    TRY = label("Try it without a rig")


class WhichTarget(str, Enum):  # noqa: UP042
    """Target of a rig: the camera's or the planes'."""

    camera = "camera"
    plane = "plane"


class RecordedPart(str, Enum):  # noqa: UP042
    """Part of a recording set, named as its folder."""

    camera = "camera"
    planes = "planes"
    scan = "scan"
    check = "check"


class OrderBy(str, Enum):  # noqa: UP042
    """Order of imported pictures."""

    name = "name"
    time = "time"


Set = Annotated[Path, typer.Argument(metavar="SET", help="The recording set: a folder with rig.toml and pictures.")]
Out = Annotated[Path, typer.Option("--out", "-o", metavar="DIR", help="Folder of the results; made if need be.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object for machines instead of a table.")]
Part = Annotated[str, typer.Option(metavar="NAME", help="Name of the part in the report; else the name of SET.")]
Exclude = Annotated[
    list[str] | None,
    typer.Option(
        "--exclude",
        metavar="NAME",
        help="Leave this picture out: camera/view03.png, planes/pose02 or scan/frame0007.png; repeat for more.",
    ),
]


Profile = Annotated[
    bool, typer.Option("--profile", help="Say on standard error what each stage has cost in processor time.")
]


def one_of(chosen: str, known: Sequence[str], where: str) -> str:
    """Find `chosen` among the names `known`, ignoring case; "" stays "". InputError if there is none."""
    by_lower = {one.lower(): one for one in known}
    if chosen and chosen.lower() not in by_lower:
        raise InputError(
            Message("export.no_such_choice", 'there is no "{chosen}"', chosen=chosen),
            where=where,
            todo=Message("advice.choose_among", "choose among {choices}", choices=tuple(known)),
        )
    return by_lower.get(chosen.lower(), "")
