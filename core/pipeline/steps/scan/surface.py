"""The surface of a scan: normals of its points, and a mesh of the fused ones, made here or in a second process."""

from __future__ import annotations

from collections.abc import Callable

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
    """Start to make the surface in the process `beside`, if any; returns a function that waits for it, or makes it."""
    if beside is None:
        return lambda: make_surface(scanned, progress=progress)
    made = beside.submit(make_surface, scanned, progress)
    return lambda: beside.wait(made, progress, "mesh")


def make_surface(scanned: tuple[Cloud, tuple[int, int]], /, *, progress: Progress = silent) -> tuple[Cloud, Mesh]:
    """Compute the normals of a cloud, and its mesh, for pictures of a size (width, height)."""
    cloud, image_size = scanned
    cloud = with_normals(cloud, progress=progress)
    surface = with_normals(fuse(cloud, image_size, progress=progress), progress=progress)
    return cloud, build_mesh(surface, progress=progress)
