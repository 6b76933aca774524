"""A file at a second place without its bytes twice, where the disk can do that."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import Literal

Way = Literal["hard link", "symbolic link", "copy"]


def link(source: Path, target: Path, *, symbolic: bool = False) -> Way:
    """Put the file `source` at `target` too, by a hard link, a symbolic one or a copy; returns which of these it was.

    A hard link first: it needs no right on Windows, and stays whole if the source is moved or removed. Then, if
    `symbolic`, a link by name, which another disk takes, too; else, or where there are no links at all, a copy.

    Raises
    ------
    OSError
        If the source is not there, or even the copy cannot be written.
    """
    source = source.resolve(strict=True)  # what a link stands for, not the link
    try:
        os.link(source, target)
    except OSError:  # another disk, or one that knows no links
        if symbolic:
            try:
                target.symlink_to(source)
            except (OSError, NotImplementedError):
                pass
            else:
                return "symbolic link"
        shutil.copy2(source, target)
        return "copy"
    return "hard link"
