"""The surface of a scan: normals of its points, and a mesh of the fused ones, made here or in a second process."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from core.progress import Progress, silent
from core.scan.surface.cloud import Cloud
from core.scan.surface.fused_surface import Mesh
from core.scan.surface.fusion import fuse
from core.scan.surface.mesh import build_mesh
from core.scan.surface.normals import with_normals
from core.second_process import SecondProcess


def begin_surface(
    scanned: tuple[Cloud, tuple[int, int]], progress: Progress, beside: SecondProcess | None
) -> Callable[[], tuple[Cloud, Mesh]]:
    """Start to make normals and mesh of a cloud in the process `beside`; return a function that waits for them.

    Without `beside` that function makes them.
    """
    if beside is None:
        return lambda: make_surface(scanned, progress=progress)
    made = beside.submit(make_surface, scanned, progress)
    return lambda: beside.wait(made, progress, "mesh")


def get_ready(_: None, /, *, progress: Progress = silent) -> None:
    """Import and compile what `make_surface` needs by calling it with a small cloud; for an idle process."""
    make_surface(level_patch())  # its progress is nobody's


def level_patch() -> tuple[Cloud, tuple[int, int]]:
    """Make a small cloud of a level surface and its image size, for calling `make_surface` once ahead."""
    u, v = (axis.ravel().astype(np.float64) for axis in np.meshgrid(np.arange(40, 200, 2), np.arange(40, 160, 2)))
    points = 500.0 * np.column_stack([(u - 160) / 400, (v - 120) / 400, np.ones(u.size)])
    level, none = np.full(u.size, 0.02), np.zeros(u.size, dtype=np.int64)
    return Cloud(points, np.column_stack([u, v]), level, level, none, none, np.zeros((u.size, 3))), (320, 240)


def make_surface(scanned: tuple[Cloud, tuple[int, int]], /, *, progress: Progress = silent) -> tuple[Cloud, Mesh]:
    """Compute the normals of a cloud and its mesh; `scanned` is the cloud and the pictures' (width, height)."""
    cloud, image_size = scanned
    cloud = with_normals(cloud, progress=progress)
    surface = with_normals(fuse(cloud, image_size, progress=progress), progress=progress)
    return cloud, build_mesh(surface, progress=progress)
