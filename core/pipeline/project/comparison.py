"""The scan of a project compared with another surface: written among its results, and shown."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from core.files.project.folder import results_folder
from core.files.results.ply import read_cloud
from core.inspect.comparison import ComparisonScales
from core.inspect.shown.shown_comparison import ShownComparison
from core.pipeline.project.verify import noting_results
from core.pipeline.steps.compare_step import Compared, compare_step
from core.pipeline.steps.workspace import FILES
from core.progress import Progress, silent

MOST_DRAWN = 200_000
"""So many points of the other surface are drawn."""


def compare_project(
    folder: Path, other: Path, align: str, scales: ComparisonScales, progress: Progress = silent
) -> tuple[Compared, dict[str, Path]]:
    """Compare the scan of a project, as `core.pipeline.steps.compare_step.compare_step`; its trail is told."""
    folder = folder if folder.is_dir() else folder.parent
    with noting_results(folder):
        return compare_step(folder, other, align, scales, progress=progress)


def show_comparison(
    folder: Path, other: Path, align: str, scales: ComparisonScales, progress: Progress = silent
) -> ShownComparison:
    """Compare the scan of a project, write it there, and return what is drawn.

    Raises
    ------
    InputError
        If one of them cannot be read, they cannot be aligned so, have nothing in common, or nothing can be written.
    """
    made, _ = compare_project(folder, other, align, scales, progress)
    points = read_cloud(results_folder(folder) / FILES["cloud"]).cloud.points
    deviation, significant = made.comparison.at(points)
    known = deviation[np.isfinite(deviation)]
    widest = float(np.quantile(np.abs(known), 0.99)) if len(known) else 1.0
    step = max(1, -(-len(made.other) // MOST_DRAWN))
    return ShownComparison(
        made.summary.other,
        made.summary.alignment,
        made.summary.core_points,
        made.comparison.lower,
        made.comparison.higher,
        made.summary.lod95_mm,
        made.comparison.diameter_mm,
        made.comparison.registration_mm,
        deviation.astype(np.float32),
        significant,
        max(widest, made.summary.lod95_mm),
        made.other.points[::step].astype(np.float32),
    )
