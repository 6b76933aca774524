"""Two recordings of one thing become one: the pictures that were there, and the new ones."""

from __future__ import annotations

import re
from pathlib import Path

from core.files.atomic import cannot_write
from core.files.linking import link
from core.files.recording.set_listing import OFF, further_exposures, is_off, pictures_in, without_off
from core.held_files import rename
from core.progress import Progress, silent


def add_recording(before: Path, recorded: Path, progress: Progress = silent) -> Path:
    """Add the pictures of the folder `before` to those just `recorded` in another one, and return the latter.

    Those of `before` keep their names, so that what was left out by hand stays so; new ones of the same name get the
    next free number, the two of a pair the same one. `before` is left as it is: its files are linked where the disk
    can, else copied.

    Raises
    ------
    InputError
        If a folder cannot be read or written.
    """
    old = pictures_in(before)
    taken = {without_off(path) for path in old}
    try:
        new = _renamed(pictures_in(recorded), taken)
        for path, name in new.items():
            rename(path, path.with_name(name))
        further = further_exposures(before)
        for number, path in enumerate(old, start=1):
            for one in (path, *further.get(path, {}).values()):
                link(one, recorded / one.name)
            progress("adding pictures", number, len(old))
    except OSError as error:
        raise cannot_write(recorded, error) from error
    return recorded


def _renamed(new: tuple[Path, ...], taken: set[str]) -> dict[Path, str]:
    """New names of those pictures whose names are taken."""
    poses = {without_off(path) for path in new}
    used, names = taken | poses, dict[str, str]()
    for pose in sorted(poses & taken):
        names[pose] = _free(pose, used)
        used.add(names[pose])
    return {
        path: f"{names[without_off(path)]}{OFF if is_off(path) else ''}{path.suffix}"
        for path in new
        if without_off(path) in names
    }


def _free(name: str, used: set[str]) -> str:
    """The name with the next number that is free."""
    found = re.fullmatch(r"(.*?)(\d+)", name)
    stem, number, width = (found[1], int(found[2]), len(found[2])) if found else (f"{name}-", 1, 1)
    while (candidate := f"{stem}{number:0{width}d}") in used:
        number += 1
    return candidate
