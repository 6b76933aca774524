"""The processor that numbers are made for: what all of ten years have, and one core for linear algebra.

Libraries choose by the processor they find, and by the number of its cores, which instructions they use and so in which
order they add: the last digits would be those of one machine. They read the environment once, as they are imported, so
it is set here, before any of them. Whatever it said before is replaced: it would be read as well. What this process
starts inherits it.

On an x86-64 without AVX2, and on ARM beyond the compiled loops, libraries choose for themselves.
"""

from __future__ import annotations

import os
import platform
import sys

from llvmlite import binding

IMPORTED_BEFORE = tuple(name for name in ("cv2", "numpy") if name in sys.modules)
"""Libraries that were imported before this package: they have chosen by themselves."""

_V3 = ("avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe")
"""What x86-64-v3 adds to its forerunner (psABI of AMD64, table 3.1), as LLVM names it."""


def _processor() -> str:
    """The family of processors code is made for, as LLVM names it."""
    if platform.machine().lower() not in ("x86_64", "amd64"):
        return "generic"
    has = binding.get_host_cpu_features()
    return "x86-64-v3" if all(has.get(feature) for feature in _V3) else "x86-64"


PROCESSOR = _processor()

os.environ |= {
    **dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1"),  # and many cores only wait
    "NUMBA_CPU_NAME": PROCESSOR,
    "NUMBA_CPU_FEATURES": "",
    "NUMBA_DISABLE_INTEL_SVML": "1",  # another library of exp and log would give other digits
}
if PROCESSOR == "x86-64-v3":
    os.environ |= {
        "OPENBLAS_CORETYPE": "Haswell",  # what OpenBLAS calls x86-64-v3
        "NPY_DISABLE_CPU_FEATURES": "X86_V4 AVX512_ICL AVX512_SPR",  # all that numpy knows beyond it
        "OPENCV_IPP": "avx2",
    }
