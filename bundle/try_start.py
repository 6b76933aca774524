"""Open the window, say so, and close it: for the time this takes. Run by `trisect-workbench --module`, or by Python."""

import sys
from pathlib import Path

import workbench.app as program
from workbench.main_window import MainWindow


def tell(window: MainWindow, _path: Path | None) -> None:
    """In the place of what comes once the window is shown."""
    print("shown", flush=True)
    window.close()


program._after_start = tell
sys.exit(program.main([]))
