"""Start the program, unless another installed package stands in the place of one of its folders.

The folders `core`, `workbench` and `resources` have names that others have, too: a package that brings one of the same
name overwrites files in it, or is found before it. This module is where no such package reaches, imports none of them
before it has looked, and tells in one sentence what would be a traceback.
"""

from __future__ import annotations

import csv
import os
import sys
from base64 import urlsafe_b64encode
from collections.abc import Iterator
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path

FOLDERS = ("core", "workbench", "resources")
HOME = Path(__file__).parents[1]
"""Where this package lies, and the folders beside it."""
_SHA256 = "sha256="
_ALONE = "install Trisect into an environment of its own (pipx install, or uv tool install)"


def main_cli() -> int:
    """Run the command line `trisect` and return its exit code."""
    if (what := complaint()) is not None:
        return _refuse(what)
    from core.cli import main

    main()
    return 0


def main_window() -> int:
    """Run the window `trisect-workbench` and return its exit code."""
    if (what := complaint()) is not None:
        return _refuse(what)
    from workbench.__main__ import main

    return main()


def complaint(home: Path = HOME) -> str | None:
    """Return a sentence if a folder of the program is missing or replaced, or a file of it is changed; else None."""
    for name in FOLDERS:
        found = find_spec(name)
        place = Path(found.origin) if found is not None and found.origin is not None else None
        if place is None:
            return f"Trisect cannot start: its folder {home / name} is not there; install it anew."
        if place.parent != home / name:
            return f"Trisect cannot start: {place} is found before its own folder {home / name}; {_ALONE}."
    for file in changed_files(home):
        others = ", ".join(_owners(home, file))
        by = f"the package {others} has put" if others else "something has put"
        return f"Trisect cannot start: {by} a file of its own in place of {home / file}; {_ALONE}."
    return None


def changed_files(home: Path) -> Iterator[str]:
    """List the installed files of the program that are missing or changed since installation; none in a checkout.

    All are looked at for being there and for their size; what the folders begin with, which any package of that name
    brings, for what it says, too.
    """
    ours, begin = (tuple(f"{name}/{file}" for name in FOLDERS) for file in ("", "__init__.py"))
    for record in home.glob("trisect-[0-9]*.dist-info/RECORD"):
        for file, digest, size in _rows(record):
            if not size or not file.startswith(ours):
                continue
            path, hashed = f"{home}/{file}", file in begin and digest.startswith(_SHA256)
            if _size(path) != int(size) or (hashed and digest != _digest(path)):
                yield file


def _owners(home: Path, file: str) -> Iterator[str]:
    """Other packages installed in `home` that have a file of this name."""
    for record in sorted(home.glob("*.dist-info/RECORD")):
        package = record.parent.name.removesuffix(".dist-info").replace("-", " ")
        if not package.startswith("trisect ") and any(row[:1] == [file] for row in _rows(record)):
            yield package


def _rows(record: Path) -> Iterator[list[str]]:
    """What an installer wrote: path, hash and size of each file."""
    with record.open(encoding="utf-8", newline="") as lines:
        yield from csv.reader(lines)


def _size(path: str) -> int:
    """Of a file in bytes; -1 if it is not there."""
    try:
        return os.stat(path).st_size  # noqa: PTH116  a path object takes longer than the look, and there are 1000
    except FileNotFoundError:
        return -1


def _digest(path: str) -> str:
    """Of what a file says, as installers write it."""
    return f"{_SHA256}{urlsafe_b64encode(sha256(Path(path).read_bytes()).digest()).decode().rstrip('=')}"


def _refuse(what: str) -> int:
    if sys.stderr is not None:  # a program of windows has none on Windows
        sys.stderr.write(f"{what}\n")
    return 2
