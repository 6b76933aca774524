"""Small pictures of recorded ones, for lists and for looking at many of them quickly."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.acquire.channel import Channel
from core.acquire.folder import read_ahead
from core.acquire.grey import to_grey
from core.errors import InputError
from core.files.film import film_picture
from core.files.pictures import read_picture
from core.image.mosaic import Pattern
from core.pipeline.live.display import Display
from core.progress import Progress, silent

Thumbnail = NDArray[np.uint8]

LEAST_CONTRAST = 16.0
"""Grey levels; what differs by less is not brightened to white."""


def display_picture(
    path: Path, channel: Channel | None, width_px: int, mosaic: Pattern | None = None, progress: Progress = silent
) -> tuple[Thumbnail, int]:
    """Read a picture in 8 bit, reduced by a whole factor to at most `width_px` across; return it and the factor.

    Raw pictures of a `mosaic` are shown in the `channel`, without the checkerboard they are.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    return Display(width_px).reduced(read_picture(path, channel, mosaic))


def display_frame(path: Path, number: int, width_px: int, progress: Progress = silent) -> tuple[Thumbnail, int]:
    """Read the frame `number` from 0 of a film in 8 bit, reduced by a whole factor; return it and the factor.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    return Display(width_px).reduced(to_grey(film_picture(path, number)))


def thumbnails(
    paths: Sequence[Path],
    channel: Channel | None = None,
    mosaic: Pattern | None = None,
    width_px: int = 120,
    progress: Progress = silent,
    *,
    of_stripes: bool = False,
) -> tuple[Thumbnail | None, ...]:
    """Make a small 8-bit picture (h, w ≤ `width_px`) of each of `paths`; None for one that cannot be read.

    As `display_picture` shows it. With `of_stripes` they are brightened until the stripes of light are, which a small
    picture makes faint.
    """

    def small(path: Path) -> Thumbnail | None:
        try:
            picture = Display(width_px).reduced(read_picture(path, channel, mosaic))[0]
            return brightened(picture) if of_stripes else picture
        except InputError:
            return None  # the step that measures it says why

    made: list[Thumbnail | None] = []
    for _, picture in read_ahead(paths, small):
        made.append(picture)
        progress("small pictures", len(made), len(paths))
    return tuple(made)


def stripe_thumbnails(
    paths: Sequence[Path],
    channel: Channel | None = None,
    mosaic: Pattern | None = None,
    progress: Progress = silent,
) -> tuple[Thumbnail | None, ...]:
    """Make a small 8-bit picture of each frame in `paths`, brightened so that stripes show; None if unreadable."""
    return thumbnails(paths, channel, mosaic, progress=progress, of_stripes=True)


def brightened(picture: Thumbnail) -> Thumbnail:
    """Stretch a picture's grey levels so that its background is black and its stripes white; noise alone stays dark."""
    background, stripes = np.percentile(picture, (5.0, 99.8))
    grey = (picture - background) * (255.0 / max(stripes - background, LEAST_CONTRAST))
    return np.asarray(np.clip(grey, 0, 255), np.uint8)
