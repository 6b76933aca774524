"""What both frozen programs run: the window or the command line, by the program's name, or a module of ours.

The second is asked for by the program itself, see `core.processes`.
"""

import multiprocessing
import os
import sys
from pathlib import Path

from core.processes import run_asked_module

WINDOW = "trisect-workbench"


def restore_library_path() -> None:
    """Leave to other programs, as a browser, their own libraries: ours are found when this line is read."""
    before = os.environ.pop("LD_LIBRARY_PATH_ORIG", None)
    if before is not None:
        os.environ["LD_LIBRARY_PATH"] = before
    else:
        os.environ.pop("LD_LIBRARY_PATH", None)


if __name__ == "__main__":
    restore_library_path()
    multiprocessing.freeze_support()
    if not run_asked_module():
        if Path(sys.executable).stem == WINDOW:
            from workbench.__main__ import main as open_window

            sys.exit(open_window())
        from core.cli import main

        main()
