"""Named arrays in one .npz file: written whole, the same bytes for the same arrays, read with complaints."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.files.atomic import write_bytes
from core.files.reading import MISSING, read_bytes
from core.image.stripes.centreline import Centreline
from core.messages import Message, as_text, from_text

Arrays = Mapping[str, NDArray[Any]]

_POINTS = ("uv", "normal", "width", "strength", "sigma", "saturated")


def write_arrays(path: Path, arrays: Arrays) -> None:
    """Write `arrays`; InputError if they cannot be written."""
    data = io.BytesIO()
    np.savez(data, allow_pickle=False, **arrays)
    write_bytes(path, data.getvalue())


def read_arrays(path: Path, names: Sequence[str], *, todo: Message) -> Arrays:
    """Read all arrays, of which `names` must be there.

    Raises
    ------
    InputError
        If the file is missing or damaged, lacks an array, or holds numbers that are not finite.
    """
    if not path.exists():
        raise InputError(MISSING, where=path, todo=todo)
    try:
        with np.load(io.BytesIO(read_bytes(path)), allow_pickle=False) as file:
            arrays = dict(file)
    except (zipfile.BadZipFile, ValueError, EOFError, OSError) as error:
        what = Message("file.no_whole_arrays", "this is no whole file of arrays ({reason})", reason=str(error))
        raise InputError(what, where=path, todo=todo) from error
    for name in names:
        if name not in arrays:
            raise InputError(_missing(name), where=path, todo=todo)
    for name, array in arrays.items():
        if array.dtype.kind == "f" and not np.isfinite(array).all():
            what = Message("file.array_not_finite", "the array {name} holds values that are not finite", name=name)
            raise InputError(what, where=path, todo=todo)
    return arrays


@contextmanager
def unpacking(path: Path, *, todo: Message) -> Iterator[None]:
    """Tell as InputError that an array of `path` is missing, or that arrays do not fit together, which unpacking finds.

    Within it, KeyError is for a missing array, ValueError and TypeError for what does not fit.
    """
    try:
        yield
    except KeyError as error:
        raise InputError(_missing(str(error.args[0])), where=path, todo=todo) from error
    except (ValueError, TypeError) as error:
        what = Message("file.arrays_do_not_fit", "its arrays do not fit together ({reason})", reason=str(error))
        raise InputError(what, where=path, todo=todo) from error


def _missing(name: str) -> Message:
    return Message("file.array_missing", "the array {name} is missing", name=name)


def pack_centrelines(prefix: str, groups: Sequence[Sequence[Centreline]]) -> dict[str, NDArray[Any]]:
    """Arrays that hold centrelines end to end: how many each group has, how long each is, and its points."""
    pieces = [piece for group in groups for piece in group]
    packed: dict[str, NDArray[Any]] = {
        f"{prefix}_counts": np.array([len(group) for group in groups], dtype=np.int64),
        f"{prefix}_lengths": np.array([len(piece) for piece in pieces], dtype=np.int64),
        f"{prefix}_correlation_px": np.array([piece.correlation_px for piece in pieces], dtype=np.float64),
    }
    for name in _POINTS:
        empty = np.zeros((0, 2) if name in ("uv", "normal") else 0)
        packed[f"{prefix}_{name}"] = np.concatenate([getattr(piece, name) for piece in pieces]) if pieces else empty
    return packed


def unpack_centrelines(prefix: str, arrays: Arrays) -> tuple[tuple[Centreline, ...], ...]:
    """The groups that `pack_centrelines` packed; KeyError or ValueError if the arrays do not fit together."""
    ends = np.cumsum(arrays[f"{prefix}_lengths"])[:-1]
    columns = {name: np.split(arrays[f"{prefix}_{name}"], ends) for name in _POINTS}
    pieces = [
        Centreline(**{name: column[i] for name, column in columns.items()}, correlation_px=correlation)
        for i, correlation in enumerate(arrays[f"{prefix}_correlation_px"].tolist())
    ]
    starts = np.concatenate([[0], np.cumsum(arrays[f"{prefix}_counts"])])
    return tuple(tuple(pieces[a:b]) for a, b in pairwise(starts.tolist()))


def pack_messages(messages: Sequence[Message | None]) -> NDArray[Any]:
    """An array of messages as texts; '' for none. `unpack_messages` reads it."""
    return pack_texts([as_text(message) for message in messages])


def unpack_messages(texts: NDArray[Any]) -> list[Message | None]:
    """The messages that `pack_messages` packed; older files hold bare sentences."""
    return [from_text(text) for text in texts.tolist()]


def pack_texts(texts: Sequence[str]) -> NDArray[Any]:
    """An array of texts; numpy's arrays of texts drop trailing NULs only."""
    return np.array(list(texts), dtype=np.str_) if texts else np.zeros(0, dtype="<U1")
