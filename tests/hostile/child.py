"""Runs cases in a process of its own: `python -m tests.hostile.child GOOD WORK SEED FIRST LAST`.

Before each case its number is told, so that whoever started this knows which one ended the process; every case that did
anything but work or be refused in one sentence is told with its trace.
"""

from __future__ import annotations

import faulthandler
import json
import os
import re
import resource
import shutil
import signal
import sys
import traceback
import warnings
from pathlib import Path

import numpy as np

from core.errors import LONGEST, InputError
from tests.hostile.mutations import mutated
from tests.hostile.readers import all_readers

MEMORY_BYTES = 2 << 30
CASE_S = 10
"""Of processor time; of the clock six times as much, for a machine that does other things."""
_CONTROLS = re.compile(r"[\x00-\x1f\x7f-\x9f\u202a-\u202e]")
_SHOWN = 1500
"""Characters of a trace that are told."""


def main() -> None:
    """See the module."""
    good, work = Path(sys.argv[1]), Path(sys.argv[2])
    seed, first, last = map(int, sys.argv[3:])
    import cv2

    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    warnings.simplefilter("error", RuntimeWarning)
    shutil.copytree(good, work, dirs_exist_ok=True)
    __import__("core.files.results.nominal_surface")
    resource.setrlimit(resource.RLIMIT_DATA, (MEMORY_BYTES, MEMORY_BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    for number in range(first, last):
        _say({"begin": number})
        signal.setitimer(signal.ITIMER_PROF, CASE_S)  # SIGPROF ends the process, whatever native code it is in
        faulthandler.dump_traceback_later(6 * CASE_S, exit=True)
        if os.environ.get("TRISECT_HOSTILE_ABORT") == str(number):  # to see that a crash is found
            os.abort()
        wrong = _case(good, work, seed, number)
        signal.setitimer(signal.ITIMER_PROF, 0)
        if wrong:
            _say({"case": number, "wrong": wrong})
    _say({"done": last})


def case_name(number: int) -> str:
    """The reader that a case is of."""
    return sorted(all_readers())[number % len(all_readers())]


def _case(good: Path, work: Path, seed: int, number: int) -> str:
    """What went wrong; "" if nothing did."""
    reader = all_readers()[case_name(number)]
    path = work / reader.file
    data = (good / reader.file).read_bytes()
    try:
        path.write_bytes(mutated(data, path.name, np.random.default_rng([seed, number])))
        reader.read(path)
    except InputError as error:
        told = str(error)
        if len(told) > LONGEST or _CONTROLS.search(told):
            return f"no sentence: {told[:_SHOWN]!r}"
    except BaseException:  # noqa: BLE001  whatever it is, it is what is looked for
        return traceback.format_exc()[-_SHOWN:]
    finally:
        path.write_bytes(data)
    return ""


def _say(told: dict[str, object]) -> None:
    print(json.dumps(told), flush=True)


if __name__ == "__main__":
    main()
