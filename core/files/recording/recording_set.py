"""A recording set: the pictures that one measurement is made from.

The layout is fixed, so that any program can write one::

    SET/rig.toml
    SET/camera/*            target views, lasers off
    SET/planes/NAME.png     target with the fan on it; NAME_off.png = same pose, laser off (optional)
    SET/scan/reference.png  fan only (optional)
    SET/scan/*              frames, in the order of their names
    SET/check/NAME.png      as planes, but taken on the day of the scan (optional)
    SET/carrier.toml        the marks of the carrier that the part is held in (optional)
    SET/views/NAME/*        another view of the part on its carrier, files as in scan (optional)
    SET/scan/planes/NAME.png  a board lying beside the part during the scan; NAME_2.png … = the same board (optional)

Of pictures in planes, scan and check NAME@2.png and NAME@3.png are further exposures, shorter or longer: of a stripe
they show what is saturated, or too dark, in the first.

A project measures from folders that may lie anywhere; they are gathered into the same set, with the same names.
"""

from __future__ import annotations

import contextlib
import hashlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from pathlib import Path

from core.acquire.channel import Channel
from core.errors import InputError
from core.files.reading import file_hash, resolved
from core.files.recording.recording_log import LOG, FolderLog
from core.files.recording.rig import PLANE_TARGET, KnownPlaneTarget, Rig, read_rig, require_tables, rig_to_toml
from core.files.recording.set_listing import (
    NAMES_SHOWN,
    PlanePair,
    board_pictures,
    check_sizes,
    further_exposures,
    names_not_read,
    notes_on_not_read,
    pictures_in,
    plane_pairs,
    scan_frames,
)
from core.image.targets import Target
from core.messages import Message

PARTS = ("camera", "planes", "scan")
"""The parts of a set, each a folder of pictures."""
CHECK = "check"
"""The folder of the interim check, beside the parts: a set need not have one."""
KNOWN_PLANES = "scan/planes"
"""The folder of boards lying beside the part, within that of the scan: a set need not have one."""
RIG = "rig.toml"
VIEWS, CARRIER = "views", "carrier.toml"
"""The folder of further views of the part, and the file that says where the marks of its carrier are."""
FIRST_VIEW = "scan"
"""Name of the first view: the set's own scan."""
_BRACKETED = ("planes", "scan", CHECK)
"""Folders whose pictures may have further exposures."""


@dataclass(frozen=True, eq=False, slots=True)
class PlanePictures:
    """Known plane of a scan: a board called `name`, what rig.toml states of it, and the pictures that show it.

    Without pictures of its own it is looked for in the scan's picture with the fan alone, `reference`.
    """

    name: str
    stated: KnownPlaneTarget
    pictures: tuple[Path, ...] = ()

    @property
    def target(self) -> Target:
        """Target that is printed on the board."""
        return self.stated.target

    @property
    def print_of(self) -> str:
        """Name of the print that the board's is a part of: "plane_target", or a known plane's, usually its own."""
        return self.stated.print_of or self.name


@dataclass(frozen=True, eq=False, slots=True)
class RecordingSet:
    """Files of one recording set, in the order of their names; a `PictureReader` reads them.

    Parameters
    ----------
    name
        What the set is called; its part is called so, too, if nobody says otherwise.
    folders
        By part: the folder it lies in, whatever that is called. A part that is not there may have none.
    further
        The further exposures, by their number (2, 3), of each picture that has any.
    rig_hash
        SHA-256 of rig.toml.
    known_planes
        Boards that lie beside the part during the scan, in the order of their names.
    """

    name: str
    rig: Rig
    folders: Mapping[str, Path]
    camera: tuple[Path, ...]
    planes: tuple[PlanePair, ...]
    reference: Path | None
    frames: tuple[Path, ...]
    check: tuple[PlanePair, ...] = ()
    further: Mapping[Path, Mapping[int, Path]] = field(default_factory=dict)
    rig_hash: str = ""
    known_planes: tuple[PlanePictures, ...] = ()
    _logs: dict[tuple[str, int], FolderLog] = field(default_factory=dict, repr=False)
    """Those that have been read, by the part and when the file was written."""

    def name_of(self, path: Path) -> str:
        """Return a picture's name within the set, as "camera/view00.png", wherever its file lies."""
        for part, folder in self.folders.items():
            if path.parent == folder:
                return f"{part}/{path.name}"
        raise ValueError(f"{path} is no picture of {self.name}")

    def path_of(self, name: str) -> Path:
        """Return the path of the picture with this name within the set, as "camera/view00.png".

        Raises
        ------
        InputError
            If the part it names has no folder.
        """
        part, _, file = name.partition("/")
        if part not in self.folders or not file:
            raise InputError(Message("set.no_such_picture", "there is no such picture in the set"), where=name)
        return self.folders[part] / file

    def with_further(self, paths: Iterable[Path]) -> list[Path]:
        """List these pictures, each followed by its further exposures, if it has any."""
        return [one for path in paths for one in (path, *self.further.get(path, {}).values())]

    def pictures_of(self, pairs: Iterable[PlanePair]) -> list[Path]:
        """List all pictures of these poses: with the fan on, off, and their further exposures."""
        return self.with_further(path for pair in pairs for path in (pair.on, pair.off) if path is not None)

    def known_plane_pictures(self) -> list[Path]:
        """List all pictures of known planes."""
        return [path for plane in self.known_planes for path in plane.pictures]

    def where(self, part: str) -> Path | str:
        """Return the folder of a part of the set, or the part's name if it has none, to name it in messages."""
        return self.folders.get(part, part)

    def not_read(self, part: str) -> tuple[Message, ...]:
        """Note files in the folder of a part that are pictures or films of a kind that cannot be read; () if none."""
        return notes_on_not_read(self.folders.get(part))

    def log(self, part: str) -> FolderLog:
        """Read the log of the recording of a part, once for as long as it stays as it is; empty where there is none."""
        folder = self.folders.get(part)
        file = None if folder is None else folder / LOG
        key = part, file.stat().st_mtime_ns if file is not None and file.is_file() else 0
        if key not in self._logs:
            self._logs[key] = FolderLog.of(folder)
        return self._logs[key]

    @property
    def simulated(self) -> bool | None:
        """Whether the scan's pictures are rendered, by rig.toml or the recording's log; None if neither says it."""
        taken = self.log("scan").acquisition(self.frames)
        return True if taken is not None and taken.simulated else self.rig.simulated

    @property
    def rig_file(self) -> Path:
        """Path of the set's rig.toml, whether it is there or not."""
        return next((folder.parent for folder in self.folders.values()), Path(self.name)) / RIG

    def contains(self, folder: Path) -> bool:
        """Whether `folder` is one of the set's folders of pictures, or the folder around one."""
        own = {resolved(path) for place in self.folders.values() for path in (place, place.parent)}
        return resolved(folder) in own

    def with_channel(self, channel: Channel | None) -> RecordingSet:
        """Set the channel in which laser pictures of all parts are read; None leaves what the rig states."""
        if channel is None:
            return self
        rig = self.rig
        for part in ("planes", "scan"):
            rig = rig.with_channel(part, channel)
        return replace(self, rig=rig)

    def part_of(self, path: Path) -> str:
        """Return the name of the part, as "camera", to which the picture `path` belongs."""
        return self.name_of(path).partition("/")[0]


def require_folder(folder: Path) -> None:
    """Raise InputError unless `folder` is there and is a folder."""
    if folder.is_dir():
        return
    what = (
        Message("set.file_not_folder", "is a file, not a folder")
        if folder.exists()
        else Message("source.no_such_folder", "there is no such folder")
    )
    raise InputError(
        what, where=folder, todo=Message("advice.name_recording_set", "name the folder of a recording set")
    )


def open_set(folder: Path) -> RecordingSet:
    """List the pictures of the set in `folder` by part, not decoding them; InputError if names or sizes are wrong.

    Raises
    ------
    InputError
        If the folder is missing or empty, rig.toml is wrong, or the pictures are not all of one size.
    """
    require_folder(folder)
    if not any(folder.iterdir()):
        raise InputError(
            Message("set.empty", "the recording set is empty"),
            where=folder,
            todo=Message("advice.set_needs_pictures", "it needs rig.toml and pictures in camera, planes and scan"),
        )
    above = resolved(folder).parent
    if not (folder / RIG).exists() and (above / RIG).is_file():
        raise InputError(
            Message("set.folder_within", "this is a folder within a recording set, not the set"),
            where=folder,
            todo=Message("advice.folder_above", "name the folder above it, {above}", above=above),
        )
    rig = read_rig(folder / RIG)
    places = {part: folder / part for part in PARTS}
    if (folder / CHECK).is_dir():
        places[CHECK] = folder / CHECK
    if (folder / KNOWN_PLANES).is_dir():
        places[KNOWN_PLANES] = folder / KNOWN_PLANES
    found = _listed(resolved(folder).name, rig, places, file_hash(folder / RIG))
    check_sizes([path for part in (*PARTS, CHECK, KNOWN_PLANES) for path in _paths(found, part)])
    return found


def further_views(recording_set: RecordingSet) -> dict[str, RecordingSet]:
    """List the further views of the part in SET/views, each as a set with the same calibration and rig, by name.

    Raises
    ------
    InputError
        If its pictures are not all of one size, or a view has the name of the first one, the set's own scan.
    """
    folder = recording_set.rig_file.parent / VIEWS
    if not folder.is_dir():
        return {}
    found = {}
    for place in sorted(path for path in folder.iterdir() if path.is_dir()):
        if place.name == FIRST_VIEW:
            raise InputError(
                Message("views.name_of_first", "a further view cannot be called {name}: so the first one is called, "
                        "the set's own scan", name=FIRST_VIEW),
                where=place,
                todo=Message("views.advice_rename", "give its folder another name"),
            )  # fmt: skip
        reference, frames = scan_frames(place)
        folders = {part: path for part, path in recording_set.folders.items() if part != KNOWN_PLANES}
        further = {**recording_set.further, **further_exposures(place)}
        view = replace(
            recording_set,
            name=f"{recording_set.name} {place.name}",
            folders={**folders, "scan": place},
            reference=reference,
            frames=frames,
            further=further,
            known_planes=(),
            _logs={},
        )
        check_sizes(_paths(view, "scan"))
        found[place.name] = view
    return found


def gather_set(
    rig: Rig,
    camera: Path | None,
    planes: Path | None,
    scan: Path | None,
    name: str = "",
    check: Path | None = None,
) -> RecordingSet:
    """Make a recording set from folders of pictures that lie anywhere; a part whose folder is None is empty.

    Names and hashes are those of a set in one folder. The rig's hash is that of the rig.toml beside one of the folders
    if it says the same, else of the rig.toml that could be written. Without a `name`, the set is called like the folder
    that holds the scan's.

    Raises
    ------
    InputError
        If one folder is to be two parts, or the pictures of one part are not all of one size.
    """
    given = dict(zip((*PARTS, CHECK), (camera, planes, scan, check), strict=True))
    folders = {part: folder for part, folder in given.items() if folder is not None}
    taken: dict[Path, str] = {}
    for part, folder in folders.items():
        other = taken.setdefault(resolved(folder), part)
        if other != part:
            raise InputError(
                Message("set.folder_twice", "is the folder of both {other} and {part}", other=other, part=part),
                where=folder,
                todo=Message("advice.keep_in_two_folders", "keep their pictures in two folders"),
            )
    places = [folders[part] for part in reversed(PARTS) if part in folders]
    within = None if scan is None else scan / Path(KNOWN_PLANES).name
    if within is not None and within.is_dir() and resolved(within) not in taken:
        folders[KNOWN_PLANES] = within
    found = _listed(name or (resolved(places[0]).parent.name if places else ""), rig, folders, _rig_hash(rig, places))
    for part in ("camera", "planes", CHECK):  # between the parts, each step compares with the camera's calibration
        check_sizes(_paths(found, part))
    check_sizes([*_paths(found, "scan"), *_paths(found, KNOWN_PLANES)])
    return found


def _nothing_in(recording_set: RecordingSet, part: str, what: Message, todo: Message) -> InputError:
    """The error of a part without pictures; where there are some of a kind that is not read, these are to be told."""
    pictures, films = names_not_read(recording_set.folders.get(part))
    if pictures:
        todo = Message("advice.convert_to_png", "convert {names} to png", names=pictures[:NAMES_SHOWN])
    elif films:
        todo = Message("advice.import_film", "import the frames of {name}", name=films[0])
    return InputError(what, where=recording_set.where(part), todo=todo)


def require_camera(recording_set: RecordingSet) -> None:
    """Raise InputError unless the set has pictures of the camera's target."""
    require_tables(recording_set.rig, recording_set.rig_file, "camera_target")
    if not recording_set.camera:
        raise _nothing_in(
            recording_set,
            "camera",
            Message("set.no_camera_pictures", "there are no pictures of the camera target"),
            Message("advice.record_views", "record ten or more"),
        )


def require_planes(recording_set: RecordingSet) -> None:
    """Raise InputError unless the set has pictures of the plane target with the fan on."""
    require_tables(recording_set.rig, recording_set.rig_file, "laser_fan", "plane_target")
    if not recording_set.planes:
        raise _nothing_in(
            recording_set,
            "planes",
            Message("set.no_plane_pictures", "there are no pictures of the plane target with the fan on"),
            Message("advice.record_poses", "record five or more poses"),
        )


def require_scan(recording_set: RecordingSet) -> None:
    """Raise InputError unless the set has frames of a scan, and rig.toml says what its known planes are."""
    if not recording_set.frames:
        raise _nothing_in(
            recording_set,
            "scan",
            Message("set.no_frames", "there are no frames of a scan"),
            Message("advice.record_sweeps", "record 30 or more sweep positions"),
        )
    untold = [plane for plane in recording_set.known_planes if plane.name not in recording_set.rig.known_planes]
    if untold and PLANE_TARGET in recording_set.rig.unstated:
        raise InputError(
            Message(
                "set.known_plane_unstated",
                "there is neither a table [known_planes.{name}] nor [plane_target] that says what is printed on it",
                name=untold[0].name,
            ),
            where=untold[0].pictures[0],
            todo=Message("advice.state_known_plane", "add one of them to rig.toml, or remove the picture"),
        )


def require_outside(recording_set: RecordingSet, out: Path) -> None:
    """Raise InputError if the folder `out` for results is within the recording set."""
    if recording_set.contains(out):
        raise InputError(
            Message("project.results_within_set", "the results cannot go into the recording set itself"),
            where=out,
            todo=Message("advice.results_into_set", "choose another --out"),
        )


def _listed(name: str, rig: Rig, folders: Mapping[str, Path], rig_hash: str) -> RecordingSet:
    camera, planes = pictures_in(folders.get("camera")), plane_pairs(folders.get("planes"))
    reference, frames = scan_frames(folders.get("scan"))
    check = plane_pairs(folders.get(CHECK))
    boards = board_pictures(folders.get(KNOWN_PLANES), rig.known_planes)
    known = tuple(
        PlanePictures(name, stated_board(rig, name), boards.get(name, ()))
        for name in sorted({*boards, *rig.known_planes})
    )
    further = {first: others for part in _BRACKETED for first, others in further_exposures(folders.get(part)).items()}
    return RecordingSet(name, rig, folders, camera, planes, reference, frames, check, further, rig_hash, known)


PLATE = "plate"
"""Name of the plane target's plate where it lies beside the part."""


def boards_beside(rig: Rig, *, plate: bool) -> tuple[str, ...]:
    """List the names of the boards that lie beside the part in a scan: those the rig states, and the `plate`."""
    names = sorted(rig.known_planes)
    return tuple(names) if not plate or PLATE in names or not rig.has_fan else (*names, PLATE)


def stated_board(rig: Rig, name: str) -> KnownPlaneTarget:
    """Return what a rig states of the board called `name`; without a table of its own it is the plane target."""
    as_plane_target = KnownPlaneTarget(
        rig.plane_target, rig.plane_board, rig.plane_margin_mm, PLANE_TARGET, temperature=rig.part.target
    )
    return rig.known_planes.get(name, as_plane_target)


def _paths(recording_set: RecordingSet, part: str) -> list[Path]:
    """All pictures of one part."""
    if part == "camera":
        return list(recording_set.camera)
    if part == KNOWN_PLANES:
        return recording_set.known_plane_pictures()
    if part == "scan":
        return recording_set.with_further(
            [*([recording_set.reference] if recording_set.reference else []), *recording_set.frames]
        )
    return recording_set.pictures_of(recording_set.check if part == CHECK else recording_set.planes)


def _rig_hash(rig: Rig, places: Sequence[Path]) -> str:
    """SHA-256 of the rig.toml beside one of `places` that says the same as `rig`, else of its own text."""
    for path in dict.fromkeys(place.parent / RIG for place in places):
        with contextlib.suppress(InputError):
            if read_rig(path) == rig:
                return file_hash(path)
    return hashlib.sha256(rig_to_toml(rig).encode()).hexdigest()


def excludable(recording_set: RecordingSet) -> tuple[str, ...]:
    """List the names of all that can be left out of a set: views, frames, and poses (fan on and off together)."""
    views = (recording_set.name_of(path) for path in recording_set.camera)
    frames = (recording_set.name_of(path) for path in recording_set.frames)
    return (*views, *(f"planes/{pair.name}" for pair in recording_set.planes), *frames)


def excluded_names(recording_set: RecordingSet, typed: Iterable[str]) -> frozenset[str]:
    """Convert the names in `typed` to those of the options: a pose may also be named by one of its pictures.

    Raises
    ------
    InputError
        If there is no such picture in the set; names the nearest one.
    """
    known = excludable(recording_set)
    poses = {
        recording_set.name_of(path): f"planes/{pair.name}"
        for pair in recording_set.planes
        for path in (pair.on, pair.off)
        if path is not None
    }
    names = [poses.get(name, name) for name in (one.replace("\\", "/") for one in typed)]
    for name in names:
        if name not in known:
            raise InputError(
                Message("set.no_such_picture_to_leave_out", "there is no picture {name} to leave out", name=name),
                where=recording_set.name,
                todo=_hint(name, known),
            )
    return frozenset(names)


def _hint(name: str, known: tuple[str, ...]) -> Message:
    near = get_close_matches(name, known, n=1, cutoff=0.5)
    if near:
        return Message("advice.nearest_picture", "the nearest is {name}", name=near[0])
    return Message("advice.name_as_in_set", "name it as in the set: camera/view00.png, planes/pose00")
