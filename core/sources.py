"""The program's own text, as hashes: what another text has made is made anew.

A frozen program has no source files. Their hashes are then read from a file that is written as it is built, beside the
saved code.
"""

from __future__ import annotations

import hashlib
import json
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).parent
SHIPPED = PACKAGE / "saved_code"
"""Saved code of compiled loops that came with the package."""
BUILT = SHIPPED / "sources.json"
"""Hash of each source file, by its name; and those alone that become compiled code. `bundle/` writes it."""


def brings_code() -> bool:
    """Whether the package comes with compiled loops, as far as its files tell."""
    return any(SHIPPED.glob("*/complete"))


def texts(package: Path = PACKAGE) -> dict[Path, bytes]:
    """Read the bytes of all source files below `package`; {} in a frozen program, which has none."""
    return {file: file.read_bytes() for file in sorted(package.rglob("*.py"))}


def hashes(files: dict[Path, bytes]) -> dict[str, str]:
    """Compute SHA-256 in hex of each file's bytes, by its path within the package."""
    return {file.relative_to(PACKAGE).as_posix(): hashlib.sha256(text).hexdigest() for file, text in files.items()}


@cache
def text_hash(rooms: tuple[str, ...]) -> str:
    """Compute one hash over the source files of some rooms of core; InputError if there are none."""
    found = {file: file.read_bytes() for room in rooms for file in sorted(PACKAGE.joinpath(room).rglob("*.py"))}
    names = hashes(found) or {name: one for name, one in built("files").items() if name.split("/")[0] in rooms}
    if not names:
        raise _not_whole()
    return hashlib.sha256(repr(sorted(names.items())).encode()).hexdigest()


def compiled_hashes() -> dict[str, str]:
    """Read the hash of each source file that was compiled when the program was built; InputError if there is none."""
    return built("compiled")


def built(part: str) -> dict[str, str]:
    """Read the hashes under `part` ("files", "compiled") from the program's build; InputError if none."""
    try:
        kept: dict[str, str] = json.loads(BUILT.read_text(encoding="utf-8"))[part]
    except (OSError, ValueError, KeyError, TypeError):
        kept = {}
    if not kept:
        raise _not_whole()
    return kept


def _not_whole() -> Exception:
    from core.errors import InputError
    from core.messages import Message

    return InputError(
        Message(
            "run.program_not_whole",
            "the program is not whole: neither its source files nor the list of them that is written when it is built "
            "are there",
        ),
        where=PACKAGE,
        todo=Message("advice.install_anew", "install it anew"),
    )


def to_be_built(compiled: dict[Path, bytes]) -> str:
    """Make the content of the file BUILT: hashes of all source files, and of those in `compiled`."""
    return json.dumps({"files": hashes(texts()), "compiled": hashes(compiled)}, indent=1)
