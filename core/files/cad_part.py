"""STEP (ISO 10303): parts from CAD, as triangles in mm. The libraries, cascadio and trimesh, are an extra.

The CAD kernel behind cascadio prints, cannot be interrupted and may crash on a damaged file: it runs in a process of
its own, which is ended when the job is cancelled.
"""

from __future__ import annotations

import subprocess
import tempfile
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from core.errors import InputError, WrongValue
from core.extras import install
from core.files.limits import STEP_BYTES, check_file
from core.messages import Message
from core.model.arrays import Array
from core.processes import module_command
from core.progress import Progress, silent

SUFFIXES = (".step", ".stp")
"""Of the names of such files, in small letters."""

_TURN_RAD = 0.35
"""A curved face is cut where it has turned by so much, 20°, however small it is."""
_MM = 1000.0
"""glTF is in metres whatever the unit of the STEP file was."""
_ASK_EVERY_S = 0.1
"""How often in s it is asked whether the job is cancelled."""
_TESSELLATION = "core.files.cad_tessellation"
"""The module that process runs."""


def read_corners(path: Path, chord_mm: float, progress: Progress = silent) -> Array:
    """Read a STEP file as triangles: corners (N, 3, 3) in mm over all faces; InputError if it cannot be read.

    Parameters
    ----------
    chord_mm
        How far a triangle may be off the curved face it stands for. Its corners lie on the face.
    progress
        May raise Cancelled.

    Raises
    ------
    InputError
        If the file is too large or none, or the libraries are not installed.
    WrongValue
        If it holds no part that can be read.
    """
    check_file(path, most=STEP_BYTES)
    if find_spec("cascadio") is None or find_spec("trimesh") is None:
        raise InputError(
            Message(
                "file.install_step",
                "STEP needs cascadio and trimesh: install them with {command}",
                command=install("step"),
            ),
            where=path,
        )
    with tempfile.TemporaryDirectory(prefix="trisect-step-", ignore_cleanup_errors=True) as folder:
        glb = Path(folder) / "part.glb"
        _tessellate(path, glb, chord_mm, progress)
        return _corners(glb)


def _tessellate(path: Path, glb: Path, chord_mm: float, progress: Progress) -> None:
    command = module_command(_TESSELLATION, str(path.resolve()), str(glb), f"{chord_mm:.9g}", f"{_TURN_RAD}")
    quiet = subprocess.DEVNULL
    with subprocess.Popen(command, stdin=quiet, stdout=quiet, stderr=quiet) as process:
        try:
            while process.poll() is None:
                progress("CAD part", 0, 1)
                with suppress(subprocess.TimeoutExpired):
                    process.wait(_ASK_EVERY_S)
        finally:
            process.kill()
    if process.returncode != 0 or not glb.is_file():
        raise WrongValue(Message("file.step_unreadable", "it is damaged, or no STEP file"))


def _corners(glb: Path) -> Array:
    import trimesh

    mesh = trimesh.load_scene(glb).to_mesh()
    if not len(mesh.faces):
        raise WrongValue(Message("file.step_without_faces", "it holds no faces of a part"))
    return np.asarray(mesh.triangles, dtype=np.float64) * _MM
