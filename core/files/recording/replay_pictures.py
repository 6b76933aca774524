"""Which pictures of a folder a replay shows: of a recording set the part that is being recorded, else all of it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from core.acquire.source import Lasers, Shown
from core.files.recording.set_listing import is_off, pictures_in, without_off

_PARTS: tuple[Shown, ...] = ("camera", "planes", "scan", "check")
_BOARDS = "scan/planes"


@dataclass(frozen=True, slots=True)
class ReplayPictures:
    """Pictures in a folder by step and lasers, named as in a recording set.

    `folder` is that of a recording set, or one that holds the pictures of one step.
    """

    folder: Path

    @property
    def is_set(self) -> bool:
        """Whether the folder holds folders named as the parts of a recording set."""
        return any((self.folder / part).is_dir() for part in _PARTS)

    def __call__(self, step: Shown, lasers: Lasers) -> tuple[Path, ...]:
        """The pictures of a step taken under these lasers, in the order of their names; empty if there are none."""
        if step == "boards":
            beside = pictures_in(self.folder / (_BOARDS if self.is_set else Path(_BOARDS).name))
            return beside or self("scan", Lasers(fan=True, hand=False))
        pictures = pictures_in(self.folder / step if self.is_set else self.folder)
        if step in ("planes", "check"):
            off = {without_off(path): path for path in pictures if is_off(path)}
            shown = [path for path in pictures if path not in off.values()]
            if lasers.fan:
                return tuple(shown)
            return tuple(off[path.stem] for path in shown) if all(path.stem in off for path in shown) else ()
        if step == "scan":
            return tuple(path for path in pictures if (path.stem.lower() != "reference") == lasers.hand)
        return pictures
