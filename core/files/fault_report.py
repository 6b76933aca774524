"""What a fault of the program leaves for those who mend it: a text with the command, the versions and the trace."""

from __future__ import annotations

import platform
import traceback
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

import platformdirs

from core import __version__
from core.errors import InputError
from core.files.atomic import make_folder, write_text
from core.messages import visible


def write_fault_report(words: Sequence[str], error: BaseException) -> Path | None:
    """Write a report of an unexpected error into the user's folder of logs, and return its path; None if that fails."""
    now = datetime.now().astimezone()
    folder = Path(platformdirs.user_log_dir("trisect", appauthor=False))
    path = folder / f"fault-{now:%Y%m%d-%H%M%S-%f}.txt"
    trace = visible("".join(traceback.format_exception(error)), keep="\n")
    head = f"trisect {__version__}, Python {platform.python_version()}, {platform.platform()}\n{now.isoformat()}"
    try:
        make_folder(folder)
        write_text(path, f"{head}\n{visible(' '.join(words))}\n\n{trace}")
    except (InputError, OSError):
        return None
    return path
