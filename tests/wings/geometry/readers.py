"""The readers of the wing's files, with a good file of each kind: for `tests.hostile`."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from core.files.atomic import write_bytes
from core.files.results.ply_format import Ply, ply_bytes
from core.wings.geometry.comparison.comparison_file import (
    ChangedPart,
    ComparisonFile,
    read_comparison,
    write_comparison,
)
from core.wings.geometry.comparison.surface_file import read_surface
from tests.hostile.readers import Reader

READERS = {
    "comparison": Reader("comparison.json", read_comparison),
    "other surface": Reader("other.ply", read_surface),
}


def good_files(folder: Path) -> None:
    """Write a good file of each kind into `folder`."""
    changed, same = ChangedPart(0.25, -0.1, -0.12), ChangedPart(0.0, math.nan, math.nan)
    found = ComparisonFile("before.ply", "best fit", 1300, changed, same, 0.06, 12.0, 5.0, 0.002, "a")
    write_comparison(folder / "comparison.json", found)
    places = np.zeros(9, dtype=[(axis, "f4") for axis in "xyz"])
    write_bytes(folder / "other.ply", ply_bytes(Ply({"vertex": places}, ())))
