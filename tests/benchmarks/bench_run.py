"""A whole run on the sample: what its stages cost, and all of it against OpenCV's detection in the same pictures."""

from __future__ import annotations

import time
from pathlib import Path

import cv2
import numpy as np

from core.files.recording.recording_set import RecordingSet, open_set
from core.files.results.scan_file import read_scan
from core.files.step_graph import FILES
from core.image.stripes.tracing.ridge import ridge_response
from core.image.targets import Checkerboard
from core.pipeline.run import run
from core.second_process import second_process
from core.simulate.sample import sample_set
from core.stage_times import StageTimes
from tests.benchmarks.conftest import table
from tests.benchmarks.peers import opencv_steger

FEWEST = 0.02
"""Share of the whole from which on a stage has a row of its own."""


def detected_by_opencv(recording_set: RecordingSet, filter_px: float, threshold: float) -> float:
    """Processor time in s of decoding all pictures of a set, its corners, and Steger's points of its stripes."""
    began = time.process_time()
    board = recording_set.rig.camera_target
    assert isinstance(board, Checkerboard)
    for path in recording_set.camera:
        assert cv2.findChessboardCornersSB(picture(path), (board.columns, board.rows))[0]
    assert recording_set.reference is not None
    reference = picture(recording_set.reference)
    pairs = [(pair.on, picture(pair.off)) for pair in recording_set.planes if pair.off is not None]
    for path, dark in [*pairs, *((path, reference) for path in recording_set.frames)]:
        difference = cv2.subtract(picture(path), dark, dtype=cv2.CV_32F)
        assert len(opencv_steger(np.asarray(difference), filter_px, threshold))
    return time.process_time() - began


def picture(path: Path) -> np.ndarray:
    read = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    assert read is not None
    return np.asarray(read)


def test_a_whole_run(benchmark, capsys, tmp_path):
    """Two processes measure the sample from its pictures to the report; OpenCV only detects, on one core."""
    sample = sample_set()
    with second_process() as beside:
        run(sample, tmp_path, beside=beside)  # compiled code and fonts are loaded
        times = StageTimes()
        benchmark.pedantic(lambda: run(sample, tmp_path, progress=times, beside=beside), rounds=1)
    seconds, wall = times.seconds(), times.wall_s
    whole = sum(seconds.values())
    stripe = read_scan(tmp_path / FILES["scan"]).features.sweep_stripe
    assert stripe is not None
    threshold = ridge_response(0.35 * stripe.contrast, stripe.stripe_px, stripe.filter_px)
    opencv = detected_by_opencv(open_set(sample), stripe.filter_px, threshold)
    rows = {
        step: f"{spent:8.2f} s   {spent / whole:4.0%}   {spent / opencv:.2f} of OpenCV's detection"
        for step, spent in seconds.items()
        if spent >= FEWEST * whole
    }
    table(
        capsys,
        "A whole run on the sample, processor time of both processes",
        {
            **rows,
            "all": f"{whole:8.2f} s          {whole / opencv:.2f} of OpenCV's detection",
            "OpenCV: decoding, corners, Steger on every pixel": f"{opencv:8.2f} s",
            "time it took": f"{wall:8.2f} s          {whole / wall:.1f} cores busy   (required: 10 s on 2 quiet cores)",
        },
    )
