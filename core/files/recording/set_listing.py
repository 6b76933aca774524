"""What lies in the picture folders of a recording set, in the order of the names; nothing is decoded here."""

from __future__ import annotations

import contextlib
import re
import struct
from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from PIL import Image

from core.errors import InputError
from core.files.film import FILMS, is_film
from core.files.limits import check_file
from core.files.picture_size import opened_head
from core.files.pictures import is_picture
from core.files.reading import cannot_read
from core.findings.table import note_of
from core.messages import Message

OFF = "_off"
"""At the end of the name of a picture with the fan off, in small letters or in capitals."""
FURTHER = (2, 3)
"""Numbers of further exposures: NAME@2.png, NAME@3.png."""
_FURTHER = re.compile(rf"(.+)@({'|'.join(map(str, FURTHER))})")
_REFERENCE = "reference"
_NOT_READ = frozenset(
    {".webp", ".heic", ".heif", ".avif", ".jp2", ".raw", ".dng", ".cr2", ".cr3", ".nef", ".arw", ".ppm", ".pnm"}
    | {".wmv", ".mpg", ".mpeg"}
)
"""Endings (lower case) of pictures and films that a camera or a telephone may have written beside those that are read,
and that are no `FILMS`, which can be imported: what coding they have lost, a stripe's noise does not show."""
_NUMBERED = re.compile(r"(.+)_(?:[2-9]|[1-9]\d+)")
"""Name of a second or later picture of one board: NAME_2, NAME_3."""
NAMES_SHOWN = 3
"""So many files are named in a note."""


@dataclass(frozen=True, eq=False, slots=True)
class PlanePair:
    """Pictures of one pose of the plane target: with the fan on, and with it off if there is one."""

    name: str
    on: Path
    off: Path | None


def is_further(path: Path) -> bool:
    """Whether a picture's name is that of a second or third exposure: NAME@2.png or NAME@3.png."""
    return _FURTHER.fullmatch(path.stem) is not None


def pictures_in(folder: Path | None) -> tuple[Path, ...]:
    """List the pictures in a folder by name, without further exposures; () if there is no such folder.

    InputError if it cannot be listed.
    """
    return tuple(path for path in _all_in(folder) if not is_further(path))


def films_in(folder: Path) -> tuple[Path, ...]:
    """List the films in a folder by name, those that are known by their endings; InputError if it cannot be listed."""
    try:
        return tuple(sorted(path for path in folder.iterdir() if path.suffix.lower() in FILMS and is_film(path)))
    except OSError as error:
        raise cannot_read(folder, error) from error


def names_not_read(folder: Path | None, fits: Callable[[str], bool] = bool) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """List the names, in order, of what is not read in a folder, if `fits` accepts them: pictures, films to import.

    Films of a kind that is not imported either are among the pictures: both are to be converted.
    """
    if folder is None or not folder.is_dir():
        return (), ()
    try:
        names = sorted(path.name for path in folder.iterdir() if fits(path.name))
    except OSError as error:
        raise cannot_read(folder, error) from error
    pictures, films = (
        tuple(name for name in names if Path(name).suffix.lower() in endings) for endings in (_NOT_READ, FILMS)
    )
    return pictures, films


def notes_on_not_read(folder: Path | None, fits: Callable[[str], bool] = bool) -> tuple[Message, ...]:
    """Note pictures and films in a folder that are not read, if `fits` accepts their names; () if none."""
    pictures, films = names_not_read(folder, fits)
    within, notes = "" if folder is None else folder.name, list[Message]()
    if pictures:
        notes.append(note_of("set.not_read", n=len(pictures), folder=within, names=pictures[:NAMES_SHOWN]))
    if films:
        notes.append(note_of("set.films_not_read", n=len(films), folder=within, names=films[:NAMES_SHOWN]))
    return tuple(notes)


def further_exposures(folder: Path | None) -> dict[Path, dict[int, Path]]:
    """Find second and third exposures, by number, of pictures in a folder; InputError without a first."""
    every = _all_in(folder)
    firsts = {path.stem: path for path in every if not is_further(path)}
    found: dict[Path, dict[int, Path]] = {}
    for path in every:
        named = _FURTHER.fullmatch(path.stem)
        if named is None:
            continue
        name, number = named.groups()
        if name not in firsts:
            raise InputError(
                Message("set.no_first_exposure", "there is no picture {wanted} beside it", wanted=name + path.suffix),
                where=path,
                todo=Message("advice.add_first_exposure", "add it: NAME@2 and NAME@3 are further exposures of NAME"),
            )
        found.setdefault(firsts[name], {})[int(number)] = path
    return found


def _all_in(folder: Path | None) -> tuple[Path, ...]:
    if folder is None or not folder.is_dir():
        return ()
    try:
        found = [path for path in folder.iterdir() if is_picture(path)]
    except OSError as error:
        raise InputError(
            Message("set.cannot_be_listed", "cannot be listed ({reason})", reason=str(error.strerror or error)),
            where=folder,
        ) from error
    return tuple(sorted(found, key=lambda path: path.name))


def is_off(path: Path) -> bool:
    """Whether a picture's name says that the fan was off: NAME_off or NAME_OFF."""
    return path.stem.lower().endswith(OFF)


def without_off(path: Path) -> str:
    """Return a picture's name without its ending and without the mark "_off"."""
    return path.stem[: -len(OFF)] if is_off(path) else path.stem


def plane_pairs(folder: Path | None) -> tuple[PlanePair, ...]:
    """Pair the pictures NAME with NAME_off in a folder; InputError for an off picture without a partner.

    Names that differ in small letters and capitals alone are the same, unless there is one that does not.
    """
    pictures = pictures_in(folder)
    offs = [path for path in pictures if is_off(path)]
    by_name = {without_off(path).lower(): path for path in offs} | {without_off(path): path for path in offs}
    pairs = [
        PlanePair(path.stem, path, by_name.get(path.stem, by_name.get(path.stem.lower())))
        for path in pictures
        if not is_off(path)
    ]
    partners = {pair.off for pair in pairs}
    for path in offs:
        if path not in partners:
            raise InputError(
                Message(
                    "set.no_picture_with_fan",
                    "there is no picture {wanted} with the fan on beside it",
                    wanted=without_off(path) + path.suffix,
                ),
                where=path,
                todo=Message("advice.add_or_remove", "add it or remove this one"),
            )
    return tuple(pairs)


def board_pictures(folder: Path | None, stated: Collection[str] = ()) -> dict[str, tuple[Path, ...]]:
    """List the pictures of each board in a folder by its name: NAME, NAME_2, NAME_3 … show the board NAME.

    So named pictures are of NAME only where there is a picture NAME, or a board that is `stated` to be called so; else,
    or where NAME_2 itself is stated, they show a board of their own.
    """
    pictures = pictures_in(folder)
    known = {*stated, *(path.stem for path in pictures)}
    found: dict[str, list[Path]] = {}
    for path in pictures:
        numbered = None if path.stem in stated else _NUMBERED.fullmatch(path.stem)
        name = numbered[1] if numbered is not None and numbered[1] in known else path.stem
        found.setdefault(name, []).append(path)
    return {name: tuple(sorted(paths, key=_by_number)) for name, paths in found.items()}


def _by_number(path: Path) -> tuple[int, str]:
    number = path.stem.rpartition("_")[2]
    return (int(number) if _NUMBERED.fullmatch(path.stem) else 1), path.name


def scan_frames(folder: Path | None) -> tuple[Path | None, tuple[Path, ...]]:
    """List the reference picture, or None, and the frames in a scan's folder; InputError if it has two references."""
    scan = pictures_in(folder)
    references = [path for path in scan if path.stem.lower() == _REFERENCE]
    if len(references) > 1:
        raise InputError(
            Message(
                "set.several_references",
                "there are {references} references ({references2})",
                references=len(references),
                references2=tuple(path.name for path in references),
            ),
            where=folder,
            todo=Message("advice.keep_one", "keep one of them"),
        )
    return references[0] if references else None, tuple(path for path in scan if path not in references)


def taken_at(paths: Sequence[Path]) -> datetime:
    """Return when the newest of these pictures was taken, as far as their files tell; now, if all are gone."""
    times = []
    for path in paths:
        with contextlib.suppress(OSError):
            times.append(path.stat().st_mtime)
    return datetime.fromtimestamp(max(times), UTC) if times else datetime.now(UTC)


def check_sizes(paths: Sequence[Path], films: Mapping[Path, tuple[int, int]] | None = None) -> None:
    """Raise InputError, naming those that differ, unless all pictures have one size; reads their heads alone.

    The sizes of `films` count as well, each as one picture.
    """
    sizes = dict(films or {}) | {path: size for path in paths if (size := _size(path)) is not None}
    if len(set(sizes.values())) <= 1:
        return
    usual = Counter(sizes.values()).most_common(1)[0][0]
    odd = [path for path, size in sizes.items() if size != usual]
    width, height = sizes[odd[0]]
    sizes_px = {"width": width, "height": height, "usual_width": usual[0], "usual_height": usual[1]}
    raise InputError(
        Message(
            "set.size_differs",
            "the picture has {width} × {height} pixels, but the others of the set have {usual_width} × {usual_height}",
            **sizes_px,
        )
        if len(odd) == 1
        else Message(
            "set.sizes_differ",
            "the picture has {width} × {height} pixels (and {n} more like it), "
            "but the others of the set have {usual_width} × {usual_height}",
            n=len(odd) - 1,
            **sizes_px,
        ),
        where=odd[0],
        todo=Message(
            "advice.record_with_one_setting", "record all pictures with one camera setting, or take this one out"
        ),
    )


def _size(path: Path) -> tuple[int, int] | None:
    """(width, height) from the head of a picture file, or None if it has none; reading it will tell why."""
    check_file(path)
    try:
        with opened_head(path) as picture:
            return picture.size
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError, TypeError, struct.error):
        return None
