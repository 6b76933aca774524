import faulthandler
import os
from pathlib import Path

import pytest


@pytest.hookimpl(trylast=True)
def pytest_configure(config: pytest.Config) -> None:
    """A crash tells of the thread that crashed, not of all: logs that are cut short lose the one that matters."""
    if faulthandler.is_enabled():
        faulthandler.enable(os.dup(2), all_threads=False)


@pytest.fixture(scope="session")
def simulated(tmp_path_factory) -> Path:
    """A small simulated recording set; copy it before changing it."""
    from tests.simulated import small_set

    return small_set(tmp_path_factory.mktemp("simulated") / "block")


@pytest.fixture(scope="session")
def measured(simulated, tmp_path_factory) -> Path:
    """All results of the small set; copy them before changing them."""
    from tests.simulated import CUT, trisect

    out = tmp_path_factory.mktemp("measured") / "out"
    said = trisect("run", simulated, "--out", out, *CUT)
    assert said.code in (0, 1), said.err
    return out
