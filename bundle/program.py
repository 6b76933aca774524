"""What both frozen programs run: the window or the command line, by the program's name, or a module of ours.

The second is asked for by the program itself, see `core.processes`.
"""

import multiprocessing
import sys
from pathlib import Path

from core.processes import run_asked_module

WINDOW = "trisect-workbench"

if __name__ == "__main__":
    multiprocessing.freeze_support()
    if not run_asked_module():
        if Path(sys.executable).stem == WINDOW:
            from workbench.__main__ import main as open_window

            sys.exit(open_window())
        from core.cli import main

        main()
