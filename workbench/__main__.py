"""`trisect-workbench` and `python -m workbench` open the window."""

import sys
from importlib.util import find_spec

from core.extras import install
from core.messages import Message

INSTALL = Message(
    "window.install",
    "The window needs PySide6 and what else draws it: install them with make app, or {command}",
    command=install("window"),
)


def main() -> int:
    """Open the window, or print what has to be installed first; return the exit code."""
    if find_spec("PySide6") is None:
        sys.stderr.write(f"{INSTALL}.\n")
        return 2
    from workbench.app import main as open_window

    return open_window()


if __name__ == "__main__":
    sys.exit(main())
