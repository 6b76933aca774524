"""Pictures in any folders, and films, as a recording set: what lies where, in which order, and which belong together.

Nothing is written here; `core.files.recording.import_pictures` does that, once a person has seen the plan.
"""

from __future__ import annotations

import re
import struct
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from enum import StrEnum
from pathlib import Path
from typing import TypeAlias

import numpy as np
from PIL import Image

from core.errors import InputError
from core.files.film import Film, FilmFrame, Picture, film_png, is_film, read_film
from core.files.jpeg import compression_by
from core.files.limits import check_file
from core.files.picture_size import opened_head
from core.files.pictures import read_picture
from core.files.reading import cannot_read, resolved
from core.files.recording.laser_channel import LitPicture, against_background, laser_channel
from core.files.recording.recording_set import CHECK, KNOWN_PLANES
from core.files.recording.set_listing import (
    OFF,
    check_sizes,
    films_in,
    is_off,
    notes_on_not_read,
    pictures_in,
    without_off,
)
from core.image.stripes.exchanged import PAIRS_TRIED, are_exchanged, light_off_over_on
from core.messages import Message, plural_message
from core.progress import Progress, silent

_REFERENCE = "reference"
_EXIF_TABLE, _TAKEN_AT, _TAKEN_AT_PART, _WRITTEN_AT = 0x8769, 0x9003, 0x9291, 0x0132
"""Tags of Exif: its own table, DateTimeOriginal, SubsecTimeOriginal, and DateTime of the file."""
_NAMES_SHOWN = 3
"""So many pictures are named in a note."""


class Order(StrEnum):
    """Order of pictures: by their names, numbers counted as numbers, or by when they were taken."""

    NAME = "name"
    TIME = "time"


@dataclass(frozen=True, slots=True)
class Where:
    """Pictures in `folder` whose names fit `pattern`: ``*`` stands for any text, ``?`` for one character.

    A film may lie there instead of pictures, or be `folder` itself.
    """

    folder: Path
    pattern: str = "*"

    @classmethod
    def typed(cls, text: str) -> Where:
        """Parse where pictures are, as typed: a folder, folder and pattern, ``shots/laser_*.jpg``, or a film."""
        path = Path(text)
        if set("*?") & set(path.name) and not path.is_dir():
            return cls(path.parent, path.name)
        return cls(path)

    def __str__(self) -> str:
        return str(self.folder if self.pattern == "*" else self.folder / self.pattern)


@dataclass(frozen=True, slots=True)
class ImportRequest:
    """Request for an import: which pictures are for which part; None for a part without pictures.

    `planes` are the poses of the plane target with the fan on, `planes_off` the same with it off; `scan` are frames,
    `reference` is the picture of the fan alone. `check` and `check_off` are as the poses, taken on the day of the scan.
    `known_planes` are boards lying beside the part during the scan, called as they are.
    """

    camera: Where | None = None
    planes: Where | None = None
    planes_off: Where | None = None
    scan: Where | None = None
    reference: Path | None = None
    order: Order = Order.NAME
    check: Where | None = None
    check_off: Where | None = None
    known_planes: Where | None = None


@dataclass(frozen=True, slots=True)
class ImportedPicture:
    """View, pose or frame: its `name` in the `part` of the set, where it lies, its off picture, when it was taken.

    `taken_at` is None unless pictures are ordered by time. Of a film, which `source` is then, it is one `frame`.
    """

    part: str
    name: str
    source: Path
    off: Path | None = None
    taken_at: datetime | None = None
    frame: FilmFrame | None = None

    @property
    def shown_name(self) -> str:
        """Name of the source to show, of a film with the frame's number from 1."""
        return self.source.name if self.frame is None else f"{self.source.name} {self.frame.number + 1}"

    def files(self) -> tuple[tuple[str, Path], ...]:
        """Pairs (name within the set, source) of the picture, and of its partner with the fan off, if any."""
        ending = self.source.suffix if self.frame is None else ".png"
        on = (f"{self.part}/{self.name}{ending}", self.source)
        return (on,) if self.off is None else (on, (f"{self.part}/{self.name}{OFF}{self.off.suffix}", self.off))


@dataclass(frozen=True, slots=True)
class ImportPlan:
    """Plan of an import: every picture in its order, by which rule, for each part, films by part, and notes.

    `proposals` tell what was chosen for the frames of a film; nothing is wrong with them.
    """

    request: ImportRequest
    pictures: tuple[ImportedPicture, ...]
    rules: Mapping[str, Message] = field(default_factory=dict)
    notes: tuple[Message, ...] = ()
    films: Mapping[str, Film] = field(default_factory=dict)
    proposals: tuple[Message, ...] = ()

    @property
    def parts(self) -> dict[str, tuple[ImportedPicture, ...]]:
        """Pictures to be imported, by the part of the set, for each part that gets any."""
        names = dict.fromkeys(one.part for one in self.pictures)
        return {part: tuple(one for one in self.pictures if one.part == part) for part in names}


def plan_import(request: ImportRequest, progress: Progress = silent) -> ImportPlan:
    """Plan which picture gets which part and name in a recording set; reads picture sizes, three pairs, and films.

    Raises
    ------
    InputError
        If nothing is asked for, a folder or its pictures are not there, the pictures are not all of one size, a film
        cannot be read, or nothing says which pictures have the fan on.
    """
    poses, check = (request.planes, request.planes_off), (request.check, request.check_off)
    asked = (request.camera, *poses, request.scan, request.reference, *check, request.known_planes)
    if all(one is None for one in asked):
        raise InputError(
            Message("import.nothing", "nothing says which pictures to import"),
            todo=Message("import.advice_folders", "name a folder for camera, planes, scan or check"),
        )
    for on, off in (poses, check):
        if on is None and off is not None:
            raise InputError(
                Message("import.off_without_on", "these have the fan off, and nothing says which have it on"),
                where=off,
                todo=Message("import.advice_planes", "name those, too: the poses are measured in them"),
            )
    if request.scan is None and request.reference is not None:
        raise InputError(
            Message("import.reference_without_frames", "this is a reference, and nothing says which are its frames"),
            where=request.reference,
            todo=Message("import.advice_scan", "name the folder of the scan, too"),
        )
    found: list[_Part] = []
    for part, where, off in (
        ("camera", request.camera, None),
        ("planes", *poses),
        ("scan", request.scan, None),
        (CHECK, *check),
    ):
        film = None if where is None else film_at(where)
        if off is not None and (film is not None or film_at(off) is not None):
            raise InputError(
                Message("import.film_with_off", "frames of a film find no partners with the fan on or off"),
                where=off,
                todo=Message("import.advice_film_poses", "import the film alone, or its frames as pictures"),
            )
        if film is not None:
            found.append(_of_film(part, film, request.reference, progress))
        elif where is not None:
            found.append(_of_pictures(part, where, request, off))
    if request.known_planes is not None:
        found.append(_boards(request.known_planes))
    pictures = tuple(one for part in found for one in part.pictures)
    films = {part.pictures[0].part: part.film for part in found if part.film is not None}
    paths = dict.fromkeys(path for one in pictures if one.frame is None for _, path in one.files())
    check_sizes(list(paths), {film.path: film.size for film in films.values()})
    rules = {part.pictures[0].part: part.rule for part in found}
    notes = tuple(note for part in found for note in part.notes)
    return ImportPlan(request, pictures, rules, notes, films, tuple(one for part in found for one in part.proposals))


def film_at(where: Where) -> Path | None:
    """Find the film at a place: itself, or the only one in a folder without pictures; None for a folder of pictures.

    Raises
    ------
    InputError
        If several films lie there and nothing says which.
    """
    if not where.folder.is_dir():
        return where.folder if where.folder.is_file() and is_film(where.folder) else None
    if any(_matched(where.pattern, path.name) is not None for path in pictures_in(where.folder)):
        return None
    films = [path for path in films_in(where.folder) if _matched(where.pattern, path.name) is not None]
    if len(films) > 1:
        raise InputError(
            Message("import.several_films", "there are {n} films, as {names}", n=len(films),
                    names=tuple(path.name for path in films[:_NAMES_SHOWN])),
            where=where,
            todo=Message("import.advice_one_film", "name one of them: a part is made of one film"),
        )  # fmt: skip
    return films[0] if films else None


@dataclass(frozen=True, slots=True)
class _Part:
    pictures: tuple[ImportedPicture, ...]
    rule: Message
    notes: tuple[Message, ...] = ()
    film: Film | None = None
    proposals: tuple[Message, ...] = ()


def _of_pictures(part: str, where: Where, request: ImportRequest, off: Where | None) -> _Part:
    if part == "camera":
        return _views(where, request.order)
    if part == "scan":
        return _frames(where, request.reference, request.order)
    return _poses(part, where, off, request.order)


def _of_film(part: str, path: Path, reference: Path | None, progress: Progress) -> _Part:
    """The frames of a film; a scan's reference may be a picture beside them."""
    film, sample = read_film(path, progress)
    digits = len(str(film.frames[-1].number))
    stem = path.stem.lstrip(".") or "film"
    pictures = [ImportedPicture(part, f"{stem}-{frame.number:0{digits}d}", path, frame=frame) for frame in film.frames]
    proposals: tuple[Message, ...] = ()
    if part == "scan" and reference is not None:
        pictures.insert(0, ImportedPicture(part, _REFERENCE, _existing(reference)))
    elif part == "scan":
        proposals = proposed_channel(film, sample)
    rule = Message("import.frames_of_film", "the frames of the film {name} in their order", name=path.name)
    return _Part(tuple(pictures), rule, tuple(_notes_on_film(film)), film, proposals)


def _notes_on_film(film: Film) -> Iterator[Message]:
    """What is to be known of a film: frames that lack or are the one before again, and what its coding has lost."""
    if film.missing:
        yield Message(
            "import.film_shorter_than_said",
            "{name} has {frames} frames, {missing} fewer than its duration says: a longer sound track or a cut at its "
            "beginning would explain it; otherwise frames are lost.",
            name=film.path.name,
            frames=len(film.frames) + film.doubled,
            missing=film.missing,
        )
    if film.doubled:
        yield plural_message(
            "import.film_doubled",
            "{n} frame of {name} is the one before again, in every pixel, and is left out.",
            "{n} frames of {name} are the one before again, in every pixel, and are left out.",
            n=film.doubled,
            name=film.path.name,
        )
    if film.loss is None:
        return
    grey = compression_by(film.loss.components).grey
    if film.loss.assumed:
        yield Message(
            "import.film_lossy_assumed",
            "{name} is coded with loss ({coding}), how much is not known: {grey:.1f} grey levels are assumed, and go "
            "into σ. Record without loss, or as MJPEG, which tells.",
            name=film.path.name,
            coding=film.coding,
            grey=grey,
        )
    else:
        yield Message(
            "import.film_lossy",
            "{name} is coded with loss ({coding}): {grey:.1f} grey levels, which go into σ.",
            name=film.path.name,
            coding=film.coding,
            grey=grey,
        )


def proposed_channel(film: Film, sample: Sequence[Picture]) -> tuple[Message, ...]:
    """Propose the channel that shows the hand-held laser best in a sample of a film's pictures; () for grey."""
    if film.grey:
        return ()
    frames = [LitPicture(picture, data=film_png(picture, film)) for picture in sample]
    return laser_channel(against_background(frames)).proposal(film.path.name)


def _boards(where: Where) -> _Part:
    """Their names say which board they show, so they are kept."""
    files, notes = _listed(where)
    pictures = tuple(ImportedPicture(KNOWN_PLANES, path.stem, path) for path in files)
    return _Part(pictures, Message("import.names_kept", "called as they are"), notes)


def _views(where: Where, order: Order) -> _Part:
    files, notes = _listed(where)
    ordered, rule, more = _in_order(files, order)
    names = _set_names([path for path, _ in ordered])
    pictures = [
        ImportedPicture("camera", name, path, taken_at=at) for name, (path, at) in zip(names, ordered, strict=True)
    ]
    return _Part(tuple(pictures), rule, (*notes, *more))


def _frames(where: Where, reference: Path | None, order: Order) -> _Part:
    files, notes = _listed(where)
    if reference is None:
        reference = next((path for path in files if path.stem.lower() == _REFERENCE), None)
    else:
        reference = _existing(reference)
    frames = [path for path in files if reference is None or resolved(path) != resolved(reference)]
    if not frames:
        raise InputError(Message("import.no_frames", "there are no frames beside the reference"), where=where)
    ordered, rule, more = _in_order(frames, order)
    names = _set_names([path for path, _ in ordered], taken=(_REFERENCE,))
    pictures = [
        ImportedPicture("scan", name, path, taken_at=at) for name, (path, at) in zip(names, ordered, strict=True)
    ]
    if reference is not None:
        pictures.insert(0, ImportedPicture("scan", _REFERENCE, reference))
    return _Part(tuple(pictures), rule, (*notes, *more))


def _existing(reference: Path) -> Path:
    if not reference.is_file():
        raise InputError(Message("import.no_reference", "there is no such picture"), where=reference)
    return reference


def _poses(part: str, on: Where, off: Where | None, order: Order) -> _Part:
    files, notes = _listed(on)
    if off is None:
        offs = {without_off(path): path for path in files if is_off(path)}
        files = [path for path in files if not is_off(path)]
        if not offs:
            _refuse_two_kinds(on, files)
        partners, left = {path: offs.pop(path.stem) for path in files if path.stem in offs}, list(offs.values())
        how = (
            Message("import.pairs_by_off", "each NAME with its NAME_off")
            if partners
            else Message("import.no_off", "each by itself, without a picture with the fan off")
        )
    else:
        off_files, more = _listed(off)
        partners, left, how = _paired(on, files, off, off_files, order)
        notes = (*notes, *more)
    ordered, rule, more = _in_order(files, order)
    names = _set_names([path for path, _ in ordered], ends_with_off=True)
    pictures = tuple(
        ImportedPicture(part, name, path, partners.get(path), at)
        for name, (path, at) in zip(names, ordered, strict=True)
    )
    told = (*notes, *more, *_without_partner(pictures, left), *_exchanged(pictures))
    return _Part(pictures, Message("import.order_and_pairs", "{order}; {pairs}", order=rule, pairs=how), told)


def _listed(where: Where) -> tuple[list[Path], tuple[Message, ...]]:
    """The pictures that fit, and a note on files that look like pictures of a kind that is not read."""
    folder = where.folder
    if not folder.is_dir():
        what = (
            Message("import.file_not_folder", "is a file, not a folder, a pattern of names, or a film")
            if folder.exists()
            else Message("source.no_such_folder", "there is no such folder")
        )
        raise InputError(what, where=folder)
    pictures = pictures_in(folder)
    fitting = [path for path in pictures if _matched(where.pattern, path.name) is not None]
    if not fitting:
        raise InputError(
            plural_message(
                "import.none_fits",
                "no picture fits; there is one other: {names}",
                "no picture fits; there are {n} others, as {names}",
                n=len(pictures),
                names=tuple(path.name for path in pictures[:_NAMES_SHOWN]),
            )
            if pictures
            else Message("import.no_pictures", "there are no pictures in this folder"),
            where=where,
            todo=Message(
                "import.advice_formats", "pictures are png, tif, bmp, jpg and pgm, films avi, mp4, mov, mkv and gif"
            ),
        )
    return fitting, notes_on_not_read(folder, lambda name: _matched(where.pattern, name) is not None)


def _matched(pattern: str, name: str) -> tuple[str, ...] | None:
    """What the stars and question marks of a pattern stand for in a name, or None if it does not fit."""
    parts = {"*": "(.*)", "?": "(.)"}
    rule = "".join(parts.get(one, re.escape(one)) for one in pattern)
    found = re.fullmatch(rule, name, re.IGNORECASE)
    return None if found is None else found.groups()


_Key: TypeAlias = tuple[tuple[int, int, str], ...]


def natural_key(text: str) -> _Key:
    """Make the sort key that puts "view2" before "view10", and takes "02" and "2" as the same number."""
    return tuple((0, int(part), "") if part.isdecimal() else (1, 0, part.lower()) for part in re.split(r"(\d+)", text))


def _in_order(
    files: Sequence[Path], order: Order
) -> tuple[list[tuple[Path, datetime | None]], Message, tuple[Message, ...]]:
    """Files in their order with the time each was taken, the rule in words, and what is to be told of it."""
    by_name = sorted(files, key=lambda path: (natural_key(path.name), path.name))
    if order is Order.NAME:
        return [(path, None) for path in by_name], Message("import.by_name", "in the order of their names"), ()
    taken = {path: _taken_at(path) for path in by_name}
    notes: list[Message] = []
    without = [path for path, at in taken.items() if at is None]
    if without:
        taken = {path: _changed_at(path) for path in by_name}
        notes.append(
            plural_message(
                "import.no_time_in_picture",
                "{n} picture does not say when it was taken ({names}): the times of the files order all of them, "
                "and a copied file may have a new one.",
                "{n} pictures do not say when they were taken ({names}): the times of the files order all of them, "
                "and a copied file may have a new one.",
                n=len(without),
                names=tuple(path.name for path in without[:_NAMES_SHOWN]),
            )
        )
    ties = sum(count - 1 for count in Counter(taken.values()).values())
    if ties:
        notes.append(
            plural_message(
                "import.same_time",
                "{n} picture has the same time as another one: their names order these.",
                "{n} pictures have the same time as another one: their names order these.",
                n=ties,
            )
        )
    rule = (
        Message("import.by_file_time", "in the order of their files' times")
        if without
        else Message("import.by_time", "in the order in which they were taken")
    )
    ordered = sorted(by_name, key=lambda path: taken[path] or datetime.max)
    return [(path, taken[path]) for path in ordered], rule, tuple(notes)


def _taken_at(path: Path) -> datetime | None:
    """When the camera says it took a picture (EXIF 2.32: DateTimeOriginal, else DateTime); None if it does not."""
    check_file(path)
    try:
        with opened_head(path) as picture:
            head = picture.getexif()
            own = head.get_ifd(_EXIF_TABLE)
            text = str(own.get(_TAKEN_AT) or head.get(_WRITTEN_AT) or "")
            part = str(own.get(_TAKEN_AT_PART) or "").strip() if own.get(_TAKEN_AT) else ""
        at = datetime.strptime(text.strip("\0 "), "%Y:%m:%d %H:%M:%S")  # the camera's clock: no zone
    except (OSError, SyntaxError, ValueError, TypeError, struct.error, Image.DecompressionBombError):
        return None
    return at.replace(microsecond=int(f"{part:0<6}"[:6])) if part.isdecimal() else at


def _changed_at(path: Path) -> datetime:
    try:
        return datetime.fromtimestamp(path.stat().st_mtime, UTC).replace(tzinfo=None)
    except OSError as error:
        raise cannot_read(path, error) from error


def _set_names(files: Sequence[Path], *, taken: Iterable[str] = (), ends_with_off: bool = False) -> list[str]:
    """Names (without ending) by which files keep their order when sorted: their own where these do, else numbered."""
    stems = [path.stem for path in files]
    lowered = [stem.lower() for stem in stems]
    clash = len({*lowered, *taken}) < len(lowered) + len(tuple(taken))
    off = ends_with_off and any(map(is_off, files))
    names = [path.name for path in files]
    if names == sorted(names) and not clash and not off:
        return stems
    digits = len(str(len(files) - 1))
    bare = [without_off(path) if ends_with_off else path.stem for path in files]
    return [f"{place:0{digits}d}-{stem}" for place, stem in enumerate(bare)]


def _paired(
    on: Where, on_files: Sequence[Path], off: Where, off_files: Sequence[Path], order: Order
) -> tuple[dict[Path, Path], list[Path], Message]:
    """The off picture of each on picture that has one, the off pictures left over, and by which rule."""
    if same := sorted(set(on_files) & set(off_files)):
        raise InputError(
            Message("import.on_and_off", "the picture is to have the fan on and off at once"),
            where=same[0],
            todo=Message("import.advice_patterns", "give both as FOLDER/PATTERN, as shots/laser_* and shots/board_*"),
        )
    rules: list[tuple[Message, Callable[[Path], object], Callable[[Path], object]]] = [
        (Message("import.pairs_by_name", "pairs of the same name"), lambda p: p.stem.lower(), lambda p: p.stem.lower()),
        (Message("import.pairs_by_number", "pairs of the same number in the name"), _number, _number),
    ]
    if "*" in on.pattern and on.pattern.count("*") == off.pattern.count("*") and {on.pattern, off.pattern} != {"*"}:
        how = Message(
            "import.pairs_by_pattern", "pairs by what the stars in {on} and {off} stand for", on=on.pattern,
            off=off.pattern,
        )  # fmt: skip
        rules.insert(0, (how, _star_key(on.pattern), _star_key(off.pattern)))
    for how, key, off_key in rules:
        ons, offs = _by_key(on_files, key), _by_key(off_files, off_key)
        if ons is not None and offs is not None and (common := ons.keys() & offs.keys()):
            partners = {ons[one]: offs[one] for one in common}
            return partners, [path for one, path in offs.items() if one not in common], how
    if len(on_files) != len(off_files):
        raise InputError(
            Message(
                "import.cannot_pair",
                "nothing in the names says which picture belongs to which, and there are {on} with the fan on but "
                "{off} with it off",
                on=len(on_files),
                off=len(off_files),
            ),
            where=off,
            todo=Message("import.advice_patterns", "give both as FOLDER/PATTERN, as shots/laser_* and shots/board_*"),
        )
    first, second = (_in_order(files, order)[0] for files in (on_files, off_files))
    partners = {a: b for (a, _), (b, _) in zip(first, second, strict=True)}
    return partners, [], Message("import.pairs_by_order", "pairs by their order alone: look at them")


def _star_key(pattern: str) -> Callable[[Path], object]:
    def key(path: Path) -> object:
        stars = _matched(pattern, path.name) or ()
        # A star at the end holds the file's ending, and the two need not be of one kind.
        return tuple(natural_key(Path(star).stem if star.endswith(path.suffix) else star) for star in stars)

    return key


def _number(path: Path) -> int | None:
    """The last number in a name."""
    found = re.findall(r"\d+", path.stem)
    return int(found[-1]) if found else None


def _by_key(files: Sequence[Path], key: Callable[[Path], object]) -> dict[object, Path] | None:
    """Files by a key, or None if it does not tell them apart."""
    keyed = {key(path): path for path in files}
    return None if None in keyed or len(keyed) < len(files) else keyed


def _refuse_two_kinds(where: Where, files: Sequence[Path]) -> None:
    """InputError if the names are of two kinds with the same numbers: one of them probably has the fan off."""
    if where.pattern != "*":
        return
    kinds: dict[str, set[int | None]] = {}
    for path in files:
        kinds.setdefault(re.sub(r"\d+(?!.*\d)", "*", path.stem), set()).add(_number(path))
    if len(kinds) != 2:
        return
    (one, numbers), (other, others) = sorted(kinds.items())
    if None not in numbers and numbers == others:
        raise InputError(
            Message(
                "import.two_kinds", "there are pictures {one} and {other}, and nothing says which have the fan on",
                one=one, other=other,
            ),
            where=where,
            todo=Message(
                "import.advice_two_kinds", "name those with the fan on and those with it off as patterns, "
                "{folder}/{one} and {folder}/{other}", folder=where.folder.name, one=one, other=other,
            ),
        )  # fmt: skip


def _without_partner(pictures: Sequence[ImportedPicture], left: Sequence[Path]) -> tuple[Message, ...]:
    notes = []
    alone = [one.source.name for one in pictures if one.off is None]
    if alone and len(alone) < len(pictures):
        notes.append(
            plural_message(
                "import.no_partner",
                "{n} pose has no picture with the fan off ({names}).",
                "{n} poses have no picture with the fan off ({names}).",
                n=len(alone),
                names=tuple(alone[:_NAMES_SHOWN]),
            )
        )
    if left:
        notes.append(
            plural_message(
                "import.off_left_over",
                "{n} picture with the fan off belongs to no pose and is left out ({names}).",
                "{n} pictures with the fan off belong to no pose and are left out ({names}).",
                n=len(left),
                names=tuple(path.name for path in left[:_NAMES_SHOWN]),
            )
        )
    return tuple(notes)


def _exchanged(pictures: Sequence[ImportedPicture]) -> tuple[Message, ...]:
    """A note if the light is in the off pictures: by the median of three pairs."""
    pairs = [one for one in pictures if one.off is not None]
    if not pairs:
        return ()
    tried = [pairs[place] for place in np.unique(np.linspace(0, len(pairs) - 1, PAIRS_TRIED).astype(int))]
    try:
        pairs_read = [(read_picture(one.source), read_picture(one.off)) for one in tried if one.off]
    except InputError:
        return ()  # a damaged picture is told by name when it is measured
    if not are_exchanged([light_off_over_on(on, off) for on, off in pairs_read]):
        return ()
    return (
        Message(
            "import.exchanged",
            "In {name} the light is in the picture that is to have the fan off: are on and off exchanged?",
            name=tried[0].name,
        ),
    )
