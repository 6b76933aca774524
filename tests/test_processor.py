"""The last digits are those of the numbers, not of the processor, its cores or what the environment says."""

import hashlib
import os
import platform
import subprocess
import sys
from pathlib import Path

import pytest

import core
from core.processor import PROCESSOR

MEASURE = """
import sys
from pathlib import Path
from core.settings.options import Options
from core.files.recording.recording_set import open_set
from core.pipeline.steps.camera_step import camera_step
from core.pipeline.steps.gauge_step import gauge_step
from core.pipeline.steps.planes_step import planes_step
from core.pipeline.steps.scan_step import scan_step
from core.pipeline.steps.workspace import Workspace
from core.second_process import second_process
work = Workspace.open(open_set(Path(sys.argv[1])), Path(sys.argv[2]))
with second_process() as beside:
    camera_step(work)
    planes_step(work, beside=beside)
    scan_step(work, Options(sigma_cut_mm=1.0), beside=beside)
    gauge_step(work)
"""
"""A run without its report, which is not compared."""
NAMES = ("camera.json", "planes.json", "cloud.ply", "mesh.ply", "gauge.json", "scan.npz")
PINNED = ("OPENBLAS_", "OMP_", "MKL_", "NPY_", "OPENCV_", "NUMBA_CPU")
NO_AVX512 = ",".join(f"-AVX512{part}" for part in ("F", "CD", "BW", "DQ", "VL"))


def environment(**more):
    """This process's, without what Trisect itself has put into it."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(PINNED)}
    return kept | {"PYTHONPATH": str(Path(core.__file__).parents[1])} | more


def run(*words, env):
    ran = subprocess.run([sys.executable, *map(str, words)], env=env, capture_output=True, text=True, check=False)
    assert ran.returncode in (0, 1), ran.stderr
    return ran


@pytest.mark.accuracy
@pytest.mark.skipif(PROCESSOR != "x86-64-v3", reason="nothing is pinned for other processors")
def test_a_measurement_gives_the_same_bytes_whatever_the_environment_says_of_threads_and_processor(tiny_set, tmp_path):
    """Each of these gave other bytes by itself when libraries were left to choose."""
    surroundings = {
        "cleared": environment(),
        "two threads": environment(OPENBLAS_NUM_THREADS="2", OMP_NUM_THREADS="2"),
        "older kernels": environment(OPENBLAS_CORETYPE="Nehalem", OPENCV_IPP="disabled"),
        "no AVX-512": environment(
            NPY_DISABLE_CPU_FEATURES="X86_V3 X86_V4 AVX512_ICL", GLIBC_TUNABLES=f"glibc.cpu.hwcaps={NO_AVX512}"
        ),
    }
    found = {}
    for name, env in surroundings.items():
        out = tmp_path / name
        run("-c", MEASURE, tiny_set, out, env=env)
        found[name] = [hashlib.sha256((out / file).read_bytes()).hexdigest() for file in NAMES]
    assert all(hashes == found["cleared"] for hashes in found.values()), found


@pytest.mark.skipif(platform.machine().lower() not in ("x86_64", "amd64"), reason="nothing is switched off elsewhere")
def test_numpy_uses_no_instructions_beyond_avx2_and_does_not_complain_of_a_name():
    program = """
import core, numpy
from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__
print(*(name for name in __cpu_dispatch__ if __cpu_features__[name]))
"""
    ran = run("-W", "error", "-c", program, env=environment())
    assert ran.stdout.split() == (["X86_V3"] if PROCESSOR == "x86-64-v3" else [])
    assert ran.stderr == ""


def test_what_was_imported_before_is_known():
    assert run("-c", "import numpy, core.processor as p; print(p.IMPORTED_BEFORE)", env=environment()).stdout == (
        "('numpy',)\n"
    )
    assert run("-c", "import core.processor as p, numpy; print(p.IMPORTED_BEFORE)", env=environment()).stdout == "()\n"
