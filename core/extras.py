"""How a part of the program that is installed only on request, an extra, is installed afterwards."""

from __future__ import annotations

import sys

from core import __version__
from core.messages import Message


def install(extra: str) -> Message:
    """Write the commands that install `extra`, as "window": no index has the program, only its sources and wheels."""
    return Message(
        "advice.install_extra",
        "{pip} install -e '.[{extra}]' in the folder of its sources, or pip install '{wheel}[{extra}]' with its wheel",
        pip=".venv\\Scripts\\pip" if sys.platform == "win32" else ".venv/bin/pip",
        extra=extra,
        wheel=f"./trisect-{__version__}-py3-none-any.whl",
    )
