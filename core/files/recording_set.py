"""A recording set: the folder of pictures that one measurement is made from.

The layout is fixed, so that any program can write one::

    SET/rig.toml
    SET/camera/*            target views, lasers off
    SET/planes/NAME.png     target with the fan on it; NAME_off.png = same pose, laser off (optional)
    SET/scan/reference.png  fan only (optional)
    SET/scan/*              frames, in the order of their names
"""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from PIL import Image

from core.acquire.folder import read_ahead
from core.errors import InputError
from core.files.pictures import Picture, decode_picture, is_picture, read_bytes
from core.files.rig import Rig, read_rig

_OFF = "_off"
_REFERENCE = "reference"


@dataclass(frozen=True, eq=False, slots=True)
class PlanePair:
    """One pose of the plane target: the picture with the fan on, and the one with it off, if there is one."""

    name: str
    on: Path
    off: Path | None


@dataclass(frozen=True, eq=False, slots=True)
class RecordingSet:
    """The files of one recording set, in the order of their names, and the readers for them.

    `hashes` fills up with the SHA-256 of every file as it is read, by its name within the set.
    """

    folder: Path
    rig: Rig
    camera: tuple[Path, ...]
    planes: tuple[PlanePair, ...]
    reference: Path | None
    frames: tuple[Path, ...]
    hashes: dict[str, str] = field(default_factory=dict)

    def name_of(self, path: Path) -> str:
        """The name of a file within the set, with forward slashes on every system."""
        return path.relative_to(self.folder).as_posix()

    def read(self, path: Path) -> Picture:
        """Read one picture of the set as the rig wants it, and take its hash.

        Raises
        ------
        InputError
            If it is damaged or unreadable; names the file.
        """
        data = read_bytes(path)
        self.hashes[self.name_of(path)] = hashlib.sha256(data).hexdigest()
        return decode_picture(data, path, self.rig.channel)

    def stream(self, paths: Sequence[Path]) -> Iterator[tuple[str, Picture | str]]:
        """Yield name and picture of each of `paths`, a few read ahead; for a damaged one, why it cannot be read.

        Raises
        ------
        InputError
            If a picture's depth (8 or 16 bit) is not that of the first one.
        """

        def attempt(path: Path) -> Picture | str:
            try:
                return self.read(path)
            except InputError as error:
                return error.what

        first: tuple[str, Picture] | None = None
        for path, result in read_ahead(paths, attempt):
            name = self.name_of(path)
            if not isinstance(result, str):
                first = first or (name, result)
                self._check_depth(path, result, *first)
            yield name, result

    def _check_depth(self, path: Path, picture: Picture, first_name: str, first: Picture) -> None:
        if picture.dtype != first.dtype:
            raise InputError(
                f"the picture has {picture.dtype.itemsize * 8} bit, but {first_name} has {first.dtype.itemsize * 8}",
                where=path,
                todo="record all pictures with one depth",
            )


def open_set(folder: Path) -> RecordingSet:
    """List and check a recording set without decoding its pictures.

    Raises
    ------
    InputError
        If the folder is missing or empty, rig.toml is wrong, or the pictures are not all of one size.
    """
    if not folder.is_dir():
        what = "is a file, not a folder" if folder.exists() else "there is no such folder"
        raise InputError(what, where=folder, todo="name the folder of a recording set")
    if not any(folder.iterdir()):
        raise InputError(
            "the recording set is empty",
            where=folder,
            todo="it needs rig.toml and pictures in camera, planes and scan",
        )
    rig_file = folder / "rig.toml"
    rig = read_rig(rig_file)
    scan = _pictures(folder / "scan")
    references = [path for path in scan if path.stem.lower() == _REFERENCE]
    if len(references) > 1:
        raise InputError(
            f"there are {len(references)} references ({', '.join(path.name for path in references)})",
            where=folder / "scan",
            todo="keep one of them",
        )
    found = RecordingSet(
        folder,
        rig,
        _pictures(folder / "camera"),
        _pairs(folder / "planes"),
        references[0] if references else None,
        tuple(path for path in scan if path not in references),
        {rig_file.name: hashlib.sha256(read_bytes(rig_file)).hexdigest()},
    )
    _check_sizes(found)
    return found


def require_camera(found: RecordingSet) -> None:
    """InputError unless the set has views of the camera target."""
    if not found.camera:
        raise InputError(
            "there are no pictures of the camera target", where=found.folder / "camera", todo="record ten or more"
        )


def require_planes(found: RecordingSet) -> None:
    """InputError unless the set has pictures of the plane target with the fan on."""
    if not found.planes:
        raise InputError(
            "there are no pictures of the plane target with the fan on",
            where=found.folder / "planes",
            todo="record five or more poses",
        )


def require_scan(found: RecordingSet) -> None:
    """InputError unless the set has frames of a scan."""
    if not found.frames:
        raise InputError(
            "there are no frames of a scan", where=found.folder / "scan", todo="record 30 or more sweep positions"
        )


def _pictures(folder: Path) -> tuple[Path, ...]:
    if not folder.is_dir():
        return ()
    return tuple(sorted((path for path in folder.iterdir() if is_picture(path)), key=lambda path: path.name))


def _pairs(folder: Path) -> tuple[PlanePair, ...]:
    """Pictures with the fan on, each with its partner NAME_off; an off picture without partner is an error."""
    pictures = {path.stem: path for path in _pictures(folder)}
    pairs = [
        PlanePair(stem, path, pictures.get(stem + _OFF)) for stem, path in pictures.items() if not stem.endswith(_OFF)
    ]
    partners = {pair.off for pair in pairs}
    for stem, path in pictures.items():
        if stem.endswith(_OFF) and path not in partners:
            wanted = stem.removesuffix(_OFF) + path.suffix
            raise InputError(
                f"there is no picture {wanted} with the fan on beside it", where=path, todo="add it or remove this one"
            )
    return tuple(pairs)


def _check_sizes(found: RecordingSet) -> None:
    """InputError naming the odd ones out unless all pictures have one size. Reads only the files' heads."""
    planes = [path for pair in found.planes for path in (pair.on, pair.off) if path is not None]
    scan = [*([found.reference] if found.reference else []), *found.frames]
    sizes = {path: size for path in (*found.camera, *planes, *scan) if (size := _size(path)) is not None}
    if len(set(sizes.values())) <= 1:
        return
    usual = Counter(sizes.values()).most_common(1)[0][0]
    odd = [path for path, size in sizes.items() if size != usual]
    width, height = sizes[odd[0]]
    others = f" (and {len(odd) - 1} more like it)" if len(odd) > 1 else ""
    raise InputError(
        f"the picture has {width} × {height} pixels{others}, but the others of the set have {usual[0]} × {usual[1]}",
        where=odd[0],
        todo="record all pictures with one camera setting, or take this one out",
    )


def _size(path: Path) -> tuple[int, int] | None:
    """(width, height) from the head of a picture file, or None if it has none; reading it will tell why."""
    try:
        with Image.open(path) as picture:
            return picture.size
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError):
        return None
