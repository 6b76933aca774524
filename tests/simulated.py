"""A small simulated set and its calibrations, shared by the tests of the command line."""

import io
import shutil
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from unittest.mock import patch

from core.cli import main
from core.simulate.recording import simulate_set
from core.simulate.scenario import Scenario

SMALL = Scenario(scale=0.25, frames=20, camera_views=8, plane_poses=6, seed=3)

TINY = Scenario(scale=0.2, frames=8, camera_views=6, plane_poses=4, seed=3)
"""Measured in a second or two, and too coarse for its thickness to be good."""

CUT = ("--sigma-cut", "0.3")
"""A quarter of the pixels and a third of the frames give points three times as uncertain as the default cut allows."""


@dataclass(frozen=True)
class Said:
    code: int
    out: str
    err: str

    @property
    def sentence(self) -> str:
        """The one sentence on standard error, behind the stages that were begun."""
        *stages, last = self.err.strip().splitlines()
        assert all(line.endswith((" …", " s")) for line in stages), self.err
        assert last.startswith("trisect: ")
        assert last.endswith(".")
        return last


def trisect(*words: object, cores: int = 1) -> Said:
    """Run the command line in this process; with a second core, a second one takes over a part of a measurement.

    On one core by default, as tests run side by side: starting another process costs more than a small set. That the
    results are the same bytes is proven in tests/pipeline/test_run_beside.py.
    """
    out, err, code = io.StringIO(), io.StringIO(), 0
    with redirect_stdout(out), redirect_stderr(err), patch("core.second_process.cores", return_value=cores):
        try:
            main([str(word) for word in words])
        except SystemExit as leave:
            assert not isinstance(leave.code, str), leave.code
            code = leave.code or 0
    return Said(code, out.getvalue(), err.getvalue())


def small_set(folder: Path) -> Path:
    simulate_set(SMALL, folder)
    return folder


def copy_of(folder: Path, to: Path) -> Path:
    """A copy whose files can be replaced (hard links would be written through: our writers rename, cv2 does not)."""
    return Path(shutil.copytree(folder, to))


def contents(folder: Path) -> dict[str, bytes]:
    """The bytes of every file below a folder, by its path within it."""
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
