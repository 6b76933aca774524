"""What `make bundle` leaves out or makes smaller: the program needs none of it, and libraries can still be loaded."""

import ctypes
import importlib
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
needs_binutils = pytest.mark.skipif(
    sys.platform != "linux" or not all(map(shutil.which, ("ld", "objcopy", "readelf"))), reason="made by binutils"
)


@pytest.fixture
def libraries(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "bundle")
    return importlib.import_module("libraries")


@needs_binutils
def test_a_library_of_data_asks_for_no_stack_that_can_be_executed(libraries, tmp_path):
    """From glibc 2.41 on, such a library is not loaded by a program that is running."""
    made = tmp_path / "libdata.so"
    libraries.link_data(b"0123456789abcdef", "held", made, tmp_path)
    (stack,) = (line for line in libraries.readelf("-l", made).splitlines() if "GNU_STACK" in line)
    assert " RW " in stack
    assert (ctypes.c_char * 16).in_dll(ctypes.CDLL(str(made)), "held").raw == b"0123456789abcdef"


WITHOUT = """
import sys
sys.path.insert(0, "bundle")
from contents import NOT_NEEDED
sys.modules |= dict.fromkeys(NOT_NEEDED)  # importing them fails
import workbench.main_window, pyvistaqt, pyqtgraph
import core.cli, core.pipeline.run
"""


def test_the_program_can_be_imported_without_what_is_left_out():
    ran = subprocess.run([sys.executable, "-c", WITHOUT], cwd=ROOT, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
