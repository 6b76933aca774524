"""The libraries that `make bundle` makes smaller can still be loaded."""

import ctypes
import importlib
import shutil
import sys
from pathlib import Path

import pytest

BUNDLE = Path(__file__).parents[1] / "bundle"
needs_binutils = pytest.mark.skipif(
    sys.platform != "linux" or not all(map(shutil.which, ("ld", "objcopy", "readelf"))), reason="made by binutils"
)


@pytest.fixture
def libraries(monkeypatch):
    monkeypatch.syspath_prepend(BUNDLE)
    return importlib.import_module("libraries")


@needs_binutils
def test_a_library_of_data_asks_for_no_stack_that_can_be_executed(libraries, tmp_path):
    """From glibc 2.41 on, such a library is not loaded by a program that is running."""
    made = tmp_path / "libdata.so"
    libraries.link_data(b"0123456789abcdef", "held", made, tmp_path)
    (stack,) = (line for line in libraries.readelf("-l", made).splitlines() if "GNU_STACK" in line)
    assert " RW " in stack
    assert (ctypes.c_char * 16).in_dll(ctypes.CDLL(str(made)), "held").raw == b"0123456789abcdef"
