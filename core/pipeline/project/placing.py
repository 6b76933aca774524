"""Where the part lies under the rig: its reference picture, with the outline of what was measured on it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.files.project.data import Project
from core.files.recording.picture_reader import PictureReader
from core.image.display import in_8_bit, white_level
from core.inspect.shown.outline import outline_px
from core.model.arrays import Array
from core.pipeline.project.results import load_results
from core.pipeline.project.workspace import project_set
from core.progress import Progress, silent

WIDTH_PX = 640
"""At most so wide is what is shown."""


@dataclass(frozen=True, eq=False, slots=True)
class Placing:
    """Place of a part in the picture: the reference picture and the outline of the part's upper face.

    Parameters
    ----------
    picture
        (h, w) uint8: the reference picture, every `scale`-th pixel of it.
    scale
        The whole factor it is reduced by.
    outline
        (n, 2) in pixels of the full picture: round the points of the part's upper face, as measured.
    """

    picture: NDArray[np.uint8]
    scale: int
    outline: Array


def placing(folder: Path, project: Project, progress: Progress = silent) -> Placing | None:
    """Find where a project's part lay, in outline; None without a measured thickness or a reference picture.

    Raises
    ------
    InputError
        If the pictures cannot be read.
    """
    results = load_results(folder, progress)
    recording = project_set(folder, project)
    if results.gauge is None or results.cloud is None or recording.reference is None:
        return None
    try:
        outline = outline_px(results.cloud.uv[results.gauge.upper.indices])
    except InputError:  # all its points on one line
        return None
    read = PictureReader(recording).read(recording.reference)
    picture = in_8_bit(read, white_level(read))
    scale = max(1, -(-picture.shape[1] // WIDTH_PX))
    return Placing(np.ascontiguousarray(picture[::scale, ::scale]), scale, outline)
