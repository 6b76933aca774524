"""The surface of a scan made ready for other programs: holes filled on request, fewer triangles, several formats."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from core.errors import InputError
from core.files.atomic import make_folder
from core.files.results.mesh_export import write_3mf, write_obj, write_stl
from core.files.results.ply import read_mesh, write_mesh
from core.files.step_graph import FILES
from core.inspect.shown.view_frame import ViewFrame
from core.messages import Message
from core.pipeline.steps.export_kinds import frame_of
from core.progress import Progress, silent
from core.scan.surface.decimation import Decimated, decimate, decimate_to
from core.scan.surface.fused_surface import Mesh
from core.scan.surface.mesh_holes import fill_holes

_WRITE: Mapping[str, Callable[[Path, Mesh, ViewFrame], None]] = {
    "ply": lambda path, mesh, frame: write_mesh(path, mesh, "", frame),
    "stl": write_stl,
    "obj": write_obj,
    "3mf": write_3mf,
}
FORMATS = tuple(_WRITE)


@dataclass(frozen=True, slots=True)
class MeshOptions:
    """Options of preparing a mesh: `fill_mm`, the largest hole filled; `triangles` or `error_mm`, how far to decimate.

    0: not at all.
    """

    fill_mm: float = 0.0
    triangles: int = 0
    error_mm: float = 0.0


def prepared_mesh(mesh: Mesh, options: MeshOptions, progress: Progress = silent) -> Decimated:
    """Fill the holes of a mesh and decimate it by `options`; return it with the error that decimation made.

    Raises
    ------
    InputError
        If options contradict each other or make no sense.
    """
    if options.triangles and options.error_mm:
        raise InputError(
            Message("surface.two_wishes", "a number of triangles and an error are two wishes"),
            where="decimation",
            todo=Message("advice.give_one", "give one"),
        )
    if min(options.fill_mm, options.error_mm, options.triangles) < 0 or not np.isfinite(options.fill_mm):
        raise InputError(
            Message("surface.negative_wish", "lengths and numbers of triangles are not negative"),
            where="mesh",
            todo=Message("advice.give_one_above_zero", "give one above 0"),
        )
    if options.fill_mm:
        mesh = fill_holes(mesh, options.fill_mm, progress)
    if options.triangles:
        return decimate(mesh, options.triangles, progress)
    if options.error_mm:
        return decimate_to(mesh, options.error_mm, progress)
    return Decimated(mesh, 0.0, 0.0, 0.0)


def mesh_step(
    results: Path,
    formats: Sequence[str],
    options: MeshOptions,
    to: Path,
    progress: Progress = silent,
    *,
    in_camera_frame: bool = False,
) -> tuple[Decimated, dict[str, Path]]:
    """Prepare the mesh among `results` by `options`, and write it into `to` in each of the FORMATS named.

    mesh.ply stays as it is.

    Parameters
    ----------
    in_camera_frame
        Whether it is written as the camera sees it, instead of in the part's own frame where that is known.

    Raises
    ------
    InputError
        If there is no mesh, no such format, or nothing can be written.
    """
    for name in formats:
        if name not in _WRITE:
            raise InputError(
                Message("export.no_such_format", 'there is no format "{name}"', name=name),
                where="--format",
                todo=Message("advice.choose_among", "choose among {choices}", choices=tuple(FORMATS)),
            )
    frame = frame_of(results, in_camera_frame=in_camera_frame)
    made = prepared_mesh(read_mesh(results / FILES["mesh"]), options, progress)
    folder = make_folder(to)
    written = {name: folder / f"surface.{name}" for name in formats}
    for name, path in written.items():
        _WRITE[name](path, made.mesh, frame)
    return made, written
