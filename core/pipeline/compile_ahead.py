"""Compiled loops made ready by two processes at once, before a first measurement waits for them one by one."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
import threading
import time

from core.compiled import is_complete, keep_complete, saved_functions
from core.messages import label
from core.pipeline.live.warm_up import shares
from core.processes import module_command
from core.progress import Progress, silent

STEP = label("preparing")
MODULE = "core.pipeline.compile_ahead"
_LOOK_EVERY_S = 0.2
"""How often in s it is looked whether the second process is done."""
_EXPECTED_FUNCTIONS = 240
"""Functions that a measurement needs; for the bar alone."""


def compile_ahead(progress: Progress = silent) -> None:
    """Compile in other processes all loops that a measurement needs and that are not compiled yet.

    What cannot be made ready here is compiled where it is needed.
    """
    if is_complete():
        return
    running = [
        subprocess.Popen(
            module_command(MODULE, str(number)),
            stdin=subprocess.PIPE,  # it ends with this process
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        for number in range(len(shares()))
    ]
    try:
        while any(process.poll() is None for process in running):
            progress(STEP, min(saved_functions(), _EXPECTED_FUNCTIONS - 1), _EXPECTED_FUNCTIONS)
            time.sleep(_LOOK_EVERY_S)
    finally:
        for process in running:
            process.terminate()
            process.wait()
            if process.stdin is not None:
                process.stdin.close()
    progress(STEP, _EXPECTED_FUNCTIONS, _EXPECTED_FUNCTIONS)
    if not any(process.returncode for process in running):
        keep_complete()


def _end_with_the_first() -> None:
    """End at once when the process that started this one is gone, and its end of standard input with it.

    Read below Python's buffer: a thread that holds that as the process ends would abort it.
    """
    while os.read(0, 1):
        pass
    os._exit(1)


if __name__ == "__main__":
    threading.Thread(target=_end_with_the_first, daemon=True).start()
    gc.disable()  # a fifth of the time; what compiling leaves behind fits the memory
    for stage in shares()[int(sys.argv[1])]:
        stage()
