"""Pictures of the boards beside the part, taken before a live scan: of each board the first in which it is found."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from core.acquire.source import Picture
from core.files.atomic import make_folder
from core.files.recording.recording_set import KNOWN_PLANES, PlanePictures, stated_board
from core.messages import Message
from core.model import Camera
from core.pipeline.live.context import LiveContext
from core.pipeline.steps.scan.known_planes import seek_board
from core.scan.known_planes.known_plane import KnownPlane
from core.scan.known_planes.seen_plane import SoughtPlane

FOLDER = Path(KNOWN_PLANES).name
"""Of the boards' pictures, within that of a scan's recording."""


@dataclass(frozen=True, eq=False, slots=True)
class FoundBoards:
    """Boards that were looked for in one picture, by their names."""

    picture: Picture
    boards: dict[str, SoughtPlane]


class LiveBoards:
    """Boards of a live scan: those wanted, and the known planes of those whose pictures are taken."""

    def __init__(self, context: LiveContext) -> None:
        self._context, rig = context, context.request.rig
        self._wanted = {name: PlanePictures(name, stated_board(rig, name)) for name in context.request.boards}
        self._found: dict[str, KnownPlane] = {}

    @property
    def wanted(self) -> tuple[str, ...]:
        """Names of all boards."""
        return tuple(self._wanted)

    @property
    def missing(self) -> tuple[str, ...]:
        """Names of the boards of which there is no picture yet."""
        return tuple(name for name in self._wanted if name not in self._found)

    @property
    def planes(self) -> tuple[KnownPlane, ...]:
        """Known planes of the boards whose pictures are taken."""
        return tuple(self._found.values())

    def seek(self, picture: Picture, camera: Camera) -> FoundBoards:
        """Look for the missing boards in a `picture` (H, W), as the measurement does."""
        rig = self._context.request.rig
        return FoundBoards(
            picture, {name: seek_board(self._wanted[name], [(name, picture)], camera, rig) for name in self.missing}
        )

    def take(self, found: FoundBoards) -> Message | None:
        """Write the picture for each board that was found in it; return why others were not, None if all are there.

        Raises
        ------
        InputError
            If the disk is full.
        """
        for name, sought in found.boards.items():
            if sought.plane is not None:
                make_folder(self._context.request.folder / FOLDER)
                self._context.write(f"{FOLDER}/{name}", found.picture)
                self._found[name] = sought.plane
                self._context.took(f"{FOLDER}/{name}", found.picture)
        notes = [note for sought in found.boards.values() if sought.plane is None for note in sought.notes]
        return notes[0] if notes else None
