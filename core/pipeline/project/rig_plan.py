"""What a rig will measure, foretold for the window: rows in its language, and the σ of every place in the picture."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from core.model.arrays import Array
from core.pipeline.steps.plan_step import PlanResult, plan
from core.pipeline.steps.plan_words import plan_rows
from core.progress import Progress, silent
from core.report.wording import Words


@dataclass(frozen=True, eq=False, slots=True)
class ForetoldRig:
    """A plan to be shown.

    Parameters
    ----------
    rows
        Name and value of each thing that is foretold.
    sigma_mm
        (H, W) standard uncertainty of a depth in mm, own and common part together; NaN where nothing is measured.
    image_size
        Width and height of the whole picture in pixels, which the map covers.
    result
        The plan itself, to be written.
    """

    rows: list[tuple[str, str]]
    sigma_mm: Array
    image_size: tuple[int, int]
    result: PlanResult


def foretell_rig(rig: Path, language: str, progress: Progress = silent) -> ForetoldRig:
    """Plan the rig of a rig.toml; the same as `trisect plan RIG`.

    Raises
    ------
    InputError
        If the file cannot be read, or the rig cannot measure a block.
    """
    result = plan(rig, progress=progress)
    sigma = result.largest.sigma
    return ForetoldRig(
        plan_rows(result, Words.of(language)), np.hypot(sigma.own, sigma.common), result.design.pixels, result
    )
