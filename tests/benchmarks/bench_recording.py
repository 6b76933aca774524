"""Recording 10.7 MP frames as fast as they are offered: what the recorder takes, and what the disk would."""

from __future__ import annotations

import os
import shutil
import time
from pathlib import Path

import numpy as np

from core.acquire.source import Frame
from core.files.pictures import pgm_parts
from core.files.recording.direct_file import DirectWriter
from core.files.recording.recorder import Recorder
from core.files.recording.recording_log import lost_frames, read_log
from tests.benchmarks.conftest import table

FRAMES, RATE_HZ = 300, 100.0
BARE = 60


def bare_disk(folder: Path, picture: np.ndarray) -> tuple[float, float]:
    """Frames a second of plain writes into one file: into the system's memory, and until the disk has them."""
    head, pixels = pgm_parts(picture)
    begun = time.perf_counter()
    with (folder / "bare").open("wb", buffering=0) as file:
        for _ in range(BARE):
            file.write(head)
            file.write(pixels)
        taken = time.perf_counter() - begun
        os.fsync(file.fileno())
    return BARE / taken, BARE / (time.perf_counter() - begun)


def direct_disk(folder: Path, picture: np.ndarray) -> float:
    """Frames a second straight to the disk, with nothing else to do."""
    writer, parts = DirectWriter(), pgm_parts(picture)
    begun = time.perf_counter()
    for number in range(BARE):
        writer.write(folder / f"direct{number}", *parts)
    return BARE / (time.perf_counter() - begun)


def test_100_frames_a_second(tmp_path, capsys):
    """Three seconds of PGM frames at 100 a second; none is lost uncounted, whatever the disk does."""
    picture = np.random.default_rng(1).integers(0, 256, (2748, 3840)).astype(np.uint8)
    memory_hz, disk_hz = bare_disk(tmp_path, picture)
    direct_hz = direct_disk(tmp_path, picture)
    for path in tmp_path.iterdir():
        path.unlink()
    os.sync()
    recorder = Recorder(tmp_path / "scan", ending=".pgm")
    begun, spent = time.perf_counter(), time.process_time()
    for number in range(FRAMES):
        time.sleep(max(0.0, begun + number / RATE_HZ - time.perf_counter()))
        recorder.write(f"frame{number:05d}", picture, Frame(picture, number, number / RATE_HZ, 0))
    offered_s, at_once = time.perf_counter() - begun, recorder.written
    recorder.close()
    spent = time.process_time() - spent
    log = read_log(tmp_path / "scan")
    assert recorder.written + recorder.dropped == FRAMES
    assert len(log) == recorder.written
    assert lost_frames(log) + FRAMES - 1 - log[-1].index == recorder.dropped
    shutil.rmtree(tmp_path / "scan")
    table(
        capsys,
        f"{FRAMES} frames of 3840 × 2748 px offered at {FRAMES / offered_s:.0f}/s ({RATE_HZ:.0f} wanted), as PGM",
        {
            "recorder, while frames come": f"{at_once / offered_s:8.0f} frames/s written, {recorder.dropped} dropped",
            "recorder, processor time": f"{1e3 * spent / max(1, recorder.written):8.1f} ms a frame",
            "straight to the disk, one after the other": f"{direct_hz:8.0f} frames/s",
            "plain writes into memory": f"{memory_hz:8.0f} frames/s",
            "plain writes until the disk has them": f"{disk_hz:8.0f} frames/s",
        },
    )
