"""The known planes of a scan: its boards found in their pictures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from core.calibrate.board_shape import BoardTolerance
from core.errors import InputError
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import PlanePictures
from core.files.recording.rig import Rig
from core.findings.table import note_of
from core.inspect.plan.temperature import larger_by_warmth
from core.inspect.uncertainty.part import TargetTemperature
from core.messages import Message
from core.model import Camera
from core.pipeline.steps.workspace import HAS_FAN, Calibration, check_size
from core.progress import Progress, steps
from core.scan.known_planes.known_plane import KnownPlane
from core.scan.known_planes.seen_plane import BoardOf, SoughtPlane, seek_plane
from core.scan.reconstruct import ADD_BOARDS


@dataclass(frozen=True, eq=False, slots=True)
class BoardsSeen:
    """Calibration with the known planes that were found, and notes on those that were not."""

    calibration: Calibration
    notes: tuple[Message, ...] = ()


def see_boards(pictures: PictureReader, calibration: Calibration, progress: Progress) -> BoardsSeen:
    """Find the boards of a recording set in the channel of the camera's target, and record the pictures' hashes.

    Raises
    ------
    InputError
        If a picture cannot be read, or has another size than the camera's, or there is neither a fan nor a known plane.
    """
    boards, has_fan = pictures.recording_set.known_planes, pictures.recording_set.rig.has_fan
    if not boards and has_fan:
        return BoardsSeen(calibration)
    camera = calibration.camera.camera
    sought = [_sought(pictures, board, camera) for board in steps(boards, progress, "known planes", len(boards))]
    planes = tuple(one.plane for one in sought if one.plane is not None)
    notes = tuple(note for one in sought for note in one.notes)
    if not has_fan:
        with told_of_boards(notes):
            _require_any(planes)
    return BoardsSeen(calibration.with_planes(planes), notes)


def states_no_fan(rig: Rig) -> dict[str, bool]:
    """Make the setting of the scan step in run.json that states that a rig has no fan; nothing where it has one."""
    return {} if rig.has_fan else {HAS_FAN: False}


def _require_any(planes: Sequence[KnownPlane]) -> None:
    """InputError if there is neither a fan nor a known plane."""
    if not planes:
        raise InputError(
            Message(
                "scan.neither_fan_nor_plane",
                "the rig has no fan, as it has no table [laser_fan], and there is no known plane that is seen",
            ),
            where="scan",
            todo=ADD_BOARDS,
        )


@contextmanager
def told_of_boards(notes: Sequence[Message]) -> Iterator[None]:
    """Put notes on the boards of a scan behind the text of a complaint raised in this block."""
    try:
        yield
    except InputError as error:
        if not notes:
            raise
        what = Message("scan.refused_and_boards", "{complaint} ({notes:;})", complaint=error.what, notes=tuple(notes))
        raise type(error)(what, where=error.where, todo=error.todo) from error


def _sought(pictures: PictureReader, board: PlanePictures, camera: Camera) -> SoughtPlane:
    """One board in its own pictures, else in the reference."""
    reference = pictures.recording_set.reference
    paths: list[Path] = list(board.pictures) or ([] if reference is None else [reference])
    pictures.take_hashes(paths)
    read = []
    for path in paths:
        picture = pictures.read_board(path)
        check_size(path, picture.shape, camera)
        read.append((pictures.recording_set.name_of(path), picture))
    return seek_board(board, read, camera, pictures.recording_set.rig)


def seek_board(
    board: PlanePictures, pictures: Sequence[tuple[str, NDArray[Any]]], camera: Camera, rig: Rig
) -> SoughtPlane:
    """Find the plane of a `board` of the `rig` in `pictures`, each a name and grey levels (H, W), at its warmth."""
    stated = board.stated
    tolerance: BoardTolerance = stated.board
    of = BoardOf(board.name, board.target, tolerance, stated.margin_mm, board.print_of, stated.region_px)
    return _at_its_warmth(seek_plane(of, pictures, camera), stated.temperature, rig.part.target)


def _at_its_warmth(sought: SoughtPlane, own: TargetTemperature, standard: TargetTemperature) -> SoughtPlane:
    """The plane of a board of its `own` stated temperature, in lengths by the plane target, which is the `standard`.

    At the end these lengths are put to 20 °C by the plane target's temperature. A board without a temperature is taken
    to be as warm as that.
    """
    if sought.plane is None or own.celsius is None or own == standard:
        return sought
    (larger, sd), (of_standard, _) = larger_by_warmth(own), larger_by_warmth(standard)
    share = larger - of_standard
    note = note_of("scan.board_warm", board=sought.plane.name, ppm=1e6 * share, celsius=own.celsius)
    return SoughtPlane(sought.plane.enlarged(share, sd), (*sought.notes, note))
