"""Names of the pictures that can be left out by hand, and what a person typed instead."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

from core.errors import InputError
from core.files.recording_set import RecordingSet


def excludable(found: RecordingSet) -> tuple[str, ...]:
    """All that can be left out of a set: views and frames as files, poses (on and off together) by their name."""
    views = (found.name_of(path) for path in found.camera)
    frames = (found.name_of(path) for path in found.frames)
    return (*views, *(f"planes/{pair.name}" for pair in found.planes), *frames)


def excluded_names(found: RecordingSet, typed: Iterable[str]) -> frozenset[str]:
    """The names in `typed` as the options want them: a pose may also be named by one of its pictures.

    Raises
    ------
    InputError
        If there is no such picture in the set; names the nearest one.
    """
    known = excludable(found)
    poses = {
        found.name_of(path): f"planes/{pair.name}"
        for pair in found.planes
        for path in (pair.on, pair.off)
        if path is not None
    }
    names = [poses.get(name, name) for name in (one.replace("\\", "/") for one in typed)]
    for name in names:
        if name not in known:
            raise InputError(f"there is no picture {name} to leave out", where=found.name, todo=_hint(name, known))
    return frozenset(names)


def _hint(name: str, known: tuple[str, ...]) -> str:
    near = get_close_matches(name, known, n=1, cutoff=0.5)
    return f"the nearest is {near[0]}" if near else "name it as in the set: camera/view00.png, planes/pose00"
