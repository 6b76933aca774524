"""The scan of a project compared with another surface: written among its results, and shown."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from core.files.atomic import remove
from core.files.project.folder import results_folder
from core.files.project.witness import Written, witnessed
from core.files.results.ply import read_cloud, read_mesh
from core.files.step_graph import FILES
from core.progress import Progress, silent
from core.wings.geometry.comparison.compare import ComparisonScales
from core.wings.geometry.comparison.compare_step import Compared, compare_step
from core.wings.geometry.comparison.shown import ShownComparison

MOST_DRAWN = 200_000
"""So many points of the other surface are drawn."""


def compare_project(
    folder: Path, other: Path, align: str, scales: ComparisonScales, progress: Progress = silent
) -> tuple[Compared, dict[str, Path]]:
    """Compare a project's scan with the surface in `other`, and write the result among its results.

    As `core.wings.geometry.comparison.compare_step.compare_step`.
    """
    folder = folder if folder.is_dir() else folder.parent
    with witnessed(folder, Written("measured")):
        return compare_step(folder, other, align, scales, progress=progress)


def show_comparison(
    folder: Path, other: Path, align: str, diameter_mm: float = 0.0, progress: Progress = silent
) -> ShownComparison:
    """Compare a project's scan with the surface in `other` over circles of `diameter_mm`; write and return it.

    `diameter_mm` 0: chosen.

    Raises
    ------
    InputError
        If one of them cannot be read, they cannot be aligned so, have nothing in common, or nothing can be written.
    """
    made, _ = compare_project(folder, other, align, ComparisonScales(diameter_mm), progress)
    found, summary, results = made.comparison, made.summary, results_folder(folder)
    deviation, significant = found.at(read_cloud(results / FILES["cloud"]).cloud.points)
    mesh = results / FILES["mesh"]
    of_mesh = found.at(read_mesh(mesh).vertices if mesh.is_file() else np.zeros((0, 3)))
    widest = float(np.nanquantile(np.abs(found.deviation), 0.99))
    return ShownComparison(
        other=summary.other,
        alignment=summary.alignment,
        core_points=len(found),
        lower=found.lower,
        higher=found.higher,
        lod95_mm=summary.lod95_mm,
        diameter_mm=found.diameter_mm,
        registration_mm=found.registration_mm,
        deviation=deviation.astype(np.float32),
        significant=significant,
        mesh_deviation=of_mesh[0].astype(np.float32),
        mesh_significant=of_mesh[1],
        range_mm=max(widest, summary.lod95_mm),
        other_points=made.other.points[:: max(1, -(-len(made.other) // MOST_DRAWN))].astype(np.float32),
    )


def forget_comparison(folder: Path, progress: Progress = silent) -> None:
    """Remove the comparison with another surface from a project's results, and so from its report.

    Raises
    ------
    InputError
        If a file cannot be removed.
    """
    progress("results", 0, 1)
    with witnessed(folder, Written("measured")):
        for name in ("comparison", "compared", "comparison_table"):
            remove(results_folder(folder) / FILES[name])
