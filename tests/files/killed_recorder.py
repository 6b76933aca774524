"""Records small frames and is killed, again and again: `python -m tests.files.killed_recorder FOLDER TIMES`.

Each time the frames the recorder acknowledged before it died go to standard output: folder, how many.
"""

import os
import random
import signal
import sys
import time
from pathlib import Path

import numpy as np

from core.acquire.source import Frame
from core.files.recording.recorder import Recorder

SIZE, LARGE = (24, 32), (1100, 1000)
"""Frames that are written plainly, and frames that go straight to the disk."""


def size_of(time_number):
    """Every tenth recording is one of large frames."""
    return LARGE if time_number % 10 == 1 else SIZE


def picture(number, size=SIZE):
    return np.full(size, number % 251, np.uint8)


def record(folder, ending, size, acknowledged):
    """Record until killed; each time more frames are on the disk, say how many."""
    recorder = Recorder(folder, ending=ending)
    told = number = 0
    while True:
        if recorder.waiting < 20:
            levels = picture(number, size)
            recorder.write(f"frame{number:05d}", levels, Frame(levels, number, number / 100, 0))
            number += 1
        if (written := recorder.written) > told:
            os.write(acknowledged, f"{written}\n".encode())
            told = written


def main(folder, times):
    rng = random.Random(4)
    for time_number in range(times):
        place = Path(folder) / f"{time_number:03d}"
        reading, writing = os.pipe()
        ending = (".png", ".pgm")[time_number % 2]
        child = os.fork()
        if child == 0:
            record(place, ending, size_of(time_number), writing)
        os.close(writing)
        with os.fdopen(reading) as pipe:
            said = [pipe.readline()] if rng.random() < 0.8 else []  # a few are killed while they begin
            time.sleep(rng.uniform(0.0, 0.02))
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            said += pipe.read().split()
        print(place, int(said[-1]) if said else 0, flush=True)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
