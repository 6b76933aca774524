"""Compiling ahead: a real scan finds everything compiled."""

import subprocess
import sys

import pytest

from tests.simulated import copy_of

COMPILED = """
import gc, sys
from pathlib import Path
from core.files.recording.recording_set import open_set

def compiled():
    return {
        (one.py_func.__module__, one.py_func.__name__, str(signature))
        for one in gc.get_objects() if type(one).__name__ == "CPUDispatcher" for signature in one.signatures
    }
"""

SCAN = """
from core.settings.options import Options
from core.pipeline.steps.scan_step import scan_step
from core.pipeline.steps.workspace import Workspace
from core.pipeline.live.warm_up import stages

for stage in stages():
    stage()
before = compiled()
scan_step(Workspace.open(open_set(Path(sys.argv[1])), Path(sys.argv[2])), Options(sigma_cut_mm=0.3))
"""

LIVE = """
import numpy as np
from core.acquire.source import Frame
from core.files.recording.picture_reader import PictureReader
from core.settings.options import Options
from core.pipeline.live.preview import ScanPreviewer
from core.pipeline.live.warm_up import get_ready_for_live
from core.pipeline.steps.workspace import Workspace

found = open_set(Path(sys.argv[1]))
calibration = Workspace.open(found, Path(sys.argv[2])).calibration()
get_ready_for_live(np.uint8)
before = compiled()
previewer = ScanPreviewer(calibration.camera.camera, calibration.fan.fan)
pictures = PictureReader(found)
previewer.read_reference(pictures.read(found.reference))
located = 0
for number, path in enumerate(found.frames):
    looked = previewer.look(number, path.name, Frame(pictures.read(path), number, 0.0, 0))
    located += len(looked.preview.points)
    while previewer.has_more:
        previewer.go_on()
assert located > 100
"""

NEW = """
new = sorted(name for name in compiled() - before if name[0].startswith("core."))
sys.exit("\\n".join(map(str, new)) or None)
"""


@pytest.mark.parametrize(
    ("work", "made"),
    [
        pytest.param(SCAN, ("simulated", "measured"), id="measuring a scan", marks=pytest.mark.accuracy),
        pytest.param(LIVE, ("tiny_set", "tiny_measured"), id="looking at a live one"),
    ],
)
def test_after_warming_up_nothing_is_compiled_nor_loaded(request, tmp_path, work, made):
    pictures, results = map(request.getfixturevalue, made)
    out = copy_of(results, tmp_path / "out")
    program = [sys.executable, "-c", COMPILED + work + NEW, pictures, out]
    ran = subprocess.run(program, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
