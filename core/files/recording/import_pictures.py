"""The pictures of an `ImportPlan` into a recording set, as links, with a record of where each came from.

Frames of films are written, as PNG, with their times in the recording's log.
"""

from __future__ import annotations

import shutil
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final, Literal

from core import __version__
from core.errors import InputError
from core.files.atomic import beside_of, cannot_write, make_folder, remove_leftovers, write_bytes
from core.files.film import Film, film_pictures, film_png
from core.files.json_text import write_json
from core.files.linking import Way, link
from core.files.reading import MISSING, read_bytes, read_json, resolved
from core.files.recording.import_plan import ImportedPicture, ImportPlan, Where
from core.files.recording.recording_log import LoggedFrame, RecordingLog
from core.files.recording.recording_set import CHECK, KNOWN_PLANES, PARTS, RIG
from core.files.recording.rig import read_rig
from core.files.recording.set_listing import check_sizes, pictures_in
from core.held_files import remove_tree, rename
from core.messages import Message, as_json, plural_message
from core.progress import Progress, silent

IMPORTED = "import.json"
"""In the set: what was imported, when, from where and by which rule; the latest last."""


FRAME: Final = "frame of a film"
Placed = Way | Literal["frame of a film"]
"""How a picture got into the set."""
_ROOM_LEFT = 200_000_000
"""Bytes that a disk is left with: a measurement wants some, too."""


@dataclass(frozen=True, slots=True)
class Imported:
    """Result of an import: the set, how many files in which way, and notes.

    `no_rig` is a word on a rig.toml that the set has not, which a window needs not; None if it has one.
    """

    folder: Path
    ways: Mapping[Placed, int]
    notes: tuple[Message, ...]
    no_rig: Message | None = None

    @property
    def all_notes(self) -> tuple[Message, ...]:
        """Notes of the import, with one that the set has no rig.toml, if so."""
        return self.notes if self.no_rig is None else (*self.notes, self.no_rig)


def import_pictures(plan: ImportPlan, target: Path, rig: Path | None = None, progress: Progress = silent) -> Imported:
    """Put the pictures of `plan` into the recording set `target`; each part appears whole or not at all.

    Parameters
    ----------
    plan
        Which pictures, under which names.
    target
        The set. It may have other parts already, known planes without their scan among them, and a rig.toml.
    rig
        A rig.toml to copy into it.
    progress
        Called with how many files are linked.

    Raises
    ------
    InputError
        If a part is there already, pictures differ in size from those that are, rig.toml is wrong, or the set cannot
        be written.
    """
    parts = plan.parts
    require_free(plan, target, rig)
    log = earlier_imports(target)
    make_folder(target)
    ways: dict[str, Placed] = {}
    total = sum(len(one.files()) for one in plan.pictures)
    made: dict[Path, Path] = {}
    filled: dict[str, Path] = {}
    try:
        for part, pictures in parts.items():
            around, _, within = part.rpartition("/")
            if around in filled:
                filled[part] = filled[around] / within
            else:
                make_folder((target / part).parent)
                remove_leftovers(target / part)
                filled[part] = beside_of(target / part)
                made[filled[part]] = target / part
            filled[part].mkdir()
            for one in pictures:
                for name, source in one.files() if one.frame is None else ():
                    if not source.is_file():
                        raise InputError(MISSING, where=source)
                    ways[name] = link(source, filled[part] / name.removeprefix(f"{part}/"), symbolic=True)
                    progress("importing", len(ways), total)
            if part in plan.films:
                frames = [one for one in pictures if one.frame is not None]
                for name in _written(plan.films[part], frames, filled[part]):
                    ways[name] = FRAME
                    progress("importing", len(ways), total)
        for beside, place in made.items():
            _put(beside, place, target / KNOWN_PLANES)
    except OSError as error:
        raise cannot_write(target, error) from error
    finally:
        for beside in made:
            remove_tree(beside, leave=True)
    if rig is not None:
        write_bytes(target / RIG, read_bytes(rig))
    counts: Counter[Placed] = Counter(ways.values())
    notes, no_rig = (*plan.notes, *plan.proposals, *_notes(counts)), None if (target / RIG).exists() else _NO_RIG
    imported = Imported(target, dict(counts), notes, no_rig)
    write_json(target / IMPORTED, {"imports": [*log, _record(plan, ways, imported.all_notes)]})
    return imported


def require_free(plan: ImportPlan, target: Path, rig: Path | None) -> None:
    """Raise InputError if the pictures of the plan, or `rig` as rig.toml, have no place in the set `target`."""
    if target.exists() and not target.is_dir():
        raise InputError(Message("set.file_not_folder", "is a file, not a folder"), where=target)
    for part in plan.parts:
        place = target / part
        if place.exists() and not (place.is_dir() and all(path == target / KNOWN_PLANES for path in place.iterdir())):
            raise InputError(
                Message("import.part_is_there", "the set has its {part} pictures already", part=part),
                where=place,
                todo=Message("import.advice_other_set", "name another set, or remove this folder first"),
            )
    kept = [path for part in (*PARTS, CHECK, KNOWN_PLANES) for path in pictures_in(target / part)]
    new = [path for one in plan.pictures if one.frame is None for _, path in one.files()]
    check_sizes([*kept, *new], {film.path: film.size for film in plan.films.values()})
    _require_room(plan, target)
    if rig is not None:
        read_rig(rig)
        if (target / RIG).exists() and not (target / RIG).samefile(rig):
            raise InputError(
                Message("import.rig_is_there", "the set has a rig.toml already"),
                where=target / RIG,
                todo=Message("import.advice_one_rig", "keep one of the two"),
            )


def _put(beside: Path, place: Path, known_planes: Path) -> None:
    """Put a filled folder in its place, which is free or holds the boards of a scan alone: they stay as they are."""
    aside = None
    if known_planes.parent == place and known_planes.is_dir():
        if any(known_planes.iterdir()):
            aside = beside_of(place.with_name(f"{place.name}-{known_planes.name}"))  # no name of leftovers, which go
            rename(known_planes, aside)
        else:
            known_planes.rmdir()
    try:
        if place.is_dir():
            place.rmdir()  # empty: looked at before
        rename(beside, place)
    finally:
        if aside is not None:
            place.mkdir(exist_ok=True)
            rename(aside, known_planes)


def _require_room(plan: ImportPlan, target: Path) -> None:
    """Raise InputError if the frames of the plan's films have no room on the disk of the set."""
    wanted = sum(film.png_bytes for film in plan.films.values())
    there = next(folder for folder in (target, *resolved(target).parents) if folder.is_dir())
    free = shutil.disk_usage(there).free
    if wanted and wanted + _ROOM_LEFT > free:
        raise InputError(
            Message(
                "import.no_room",
                "the frames take about {wanted_gb:.1f} GB, and {free_gb:.1f} GB are free",
                wanted_gb=wanted / 1e9,
                free_gb=free / 1e9,
            ),
            where=target,
            todo=Message("advice.free_space_or_elsewhere", "free some space, or choose another folder"),
        )


def _written(film: Film, pictures: Sequence[ImportedPicture], beside: Path) -> Iterator[str]:
    """Write the frames of a film into a folder, with its log; yields each name within the set."""
    log = RecordingLog(beside)
    try:
        for one, (frame, picture) in zip(pictures, film_pictures(film), strict=True):
            name = one.files()[0][0]
            file = name.partition("/")[2]
            write_bytes(beside / file, film_png(picture, film), sync=False)
            if frame.time_s is not None:
                log.add(LoggedFrame(file, frame.number, frame.time_s, dropped=0))
            yield name
    finally:
        log.close()


def earlier_imports(target: Path) -> list[Any]:
    """Read the entries of earlier imports in a set's import.json; [] without one, InputError if it is not ours."""
    path = target / IMPORTED
    if not path.exists():
        return []
    advice = Message("import.advice_log", "move it away; no picture needs it")
    kept = read_json(path, todo=advice)
    imports = kept.get("imports") if isinstance(kept, dict) else None
    if not isinstance(imports, list):
        what = Message("import.log_damaged", "this is no record of imported pictures")
        raise InputError(what, where=path, todo=advice)
    return imports


_NO_RIG = Message(
    "import.no_rig",
    "The set has no rig.toml yet; it says what the targets and the laser are, and is written by hand.",
)


def _notes(ways: Mapping[Placed, int]) -> tuple[Message, ...]:
    notes = []
    if "symbolic link" in ways:
        notes.append(
            plural_message(
                "import.linked_by_name",
                "{n} file is linked by its name, since it lies on another disk: it must stay where it is.",
                "{n} files are linked by their names, since they lie on another disk: they must stay where they are.",
                n=ways["symbolic link"],
            )
        )
    if "copy" in ways:
        notes.append(
            plural_message(
                "import.copied",
                "{n} file was copied: this disk takes no links to it.",
                "{n} files were copied: this disk takes no links to them.",
                n=ways["copy"],
            )
        )
    return tuple(notes)


def _record(plan: ImportPlan, ways: Mapping[str, Placed], notes: tuple[Message, ...]) -> dict[str, Any]:
    """One import as the log keeps it; every file with its place, so that its origin stays known."""
    taken = {name: one.taken_at for one in plan.pictures for name, _ in one.files()[:1]}
    request = plan.request
    names = ("camera", "planes", "planes_off", "scan", "check", "check_off", "known_planes")
    asked: dict[str, Where | None] = {name: getattr(request, name) for name in names}
    return {
        "imported_at": datetime.now(UTC).astimezone().isoformat(timespec="seconds"),
        "version": __version__,
        "from": {name: _place(where) for name, where in asked.items() if where},
        "films": {part: _film_record(film) for part, film in plan.films.items()},
        "order": request.order.value,
        "rules": {part: as_json(rule) for part, rule in plan.rules.items()},
        "pictures": [
            {"name": name, "from": str(resolved(path)), "as": ways[name]}
            | ({"taken_at": at.isoformat()} if (at := taken.get(name)) else {})
            | ({} if one.frame is None else {"frame": one.frame.number, "time_s": one.frame.time_s})
            for one in plan.pictures
            for name, path in one.files()
        ],
        "notes": [as_json(note) for note in notes],
    }


def _place(where: Where) -> str:
    folder = resolved(where.folder)
    return str(folder / where.pattern if folder.is_dir() else folder)


def _film_record(film: Film) -> dict[str, Any]:
    """What a film was: of its loss what the frames say as well."""
    lost = {} if film.loss is None else {"components": film.loss.components, "assumed": film.loss.assumed}
    return {"from": str(resolved(film.path)), "coding": film.coding, "doubled": film.doubled, "lost": lost}
