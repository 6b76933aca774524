"""Compiling ahead: a real scan finds everything compiled."""

import subprocess
import sys

from tests.simulated import copy_of

PROGRAM = """
import gc, sys
from pathlib import Path
from core.files.recording_set import open_set
from core.pipeline import Options, Workspace, scan_step
from core.pipeline.warm_up import stages

def compiled():
    return {
        (one.py_func.__module__, one.py_func.__name__, str(signature))
        for one in gc.get_objects() if type(one).__name__ == "CPUDispatcher" for signature in one.signatures
    }

for stage in stages():
    stage()
before = compiled()
scan_step(Workspace.open(open_set(Path(sys.argv[1])), Path(sys.argv[2])), Options(sigma_cut_mm=0.3))
new = sorted(name for name in compiled() - before if name[0].startswith("core."))
sys.exit("\\n".join(map(str, new)) or None)
"""


def test_a_scan_after_it_compiles_nothing(simulated, measured, tmp_path):
    out = copy_of(measured, tmp_path / "out")
    ran = subprocess.run([sys.executable, "-c", PROGRAM, simulated, out], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
