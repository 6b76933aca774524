"""Named arrays in one .npz file: written whole, the same bytes for the same arrays, read with complaints."""

from __future__ import annotations

import io
import math
import re
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from tokenize import TokenError
from typing import Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from core.errors import InputError
from core.files.atomic import write_bytes
from core.files.limits import LARGEST
from core.files.reading import MISSING, read_bytes
from core.image.stripes.centreline import Centreline
from core.messages import Message, as_text, from_text, label

Arrays = Mapping[str, NDArray[Any]]

_KINDS = "biufU"
"""Numpy's letters of truth values, whole and real numbers, and texts."""
_HEADS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}
_KIND_WORDS = {
    "f": label("real numbers"), "i": label("whole numbers"), "u": label("whole numbers"), "b": label("true or false"),
    "U": label("texts"),
}  # fmt: skip
_NUMBER = re.compile(r"_[0-9]+$")
_LAST_CHARACTER = 0x10FFFF
"""The largest code point of Unicode."""
_HALVES = (0xD800, 0xDFFF)
"""Of Unicode: its last character, and the codes that are halves of one in UTF-16."""

_POINTS = ("uv", "normal", "width", "strength", "sigma", "saturated", "skewness")
_SINCE_LATER = "skewness"
"""Of points; files of earlier versions have none."""


def write_arrays(path: Path, arrays: Arrays) -> None:
    """Write named arrays to a file in numpy's npz format, whole or not at all; InputError if that fails."""
    data = io.BytesIO()
    np.savez(data, allow_pickle=False, **arrays)
    write_bytes(path, data.getvalue())


@dataclass(frozen=True, slots=True)
class Member:
    """Schema of one array of a file: its kind and shape.

    Parameters
    ----------
    kinds
        Numpy's letters of what it may hold; an array of nothing may be of any.
    shape
        Numbers, or names of numbers that are the same wherever they stand in the file; None: any number.
    optional
        Whether files of earlier versions, or of less, have none.
    """

    kinds: str
    shape: tuple[int | str | None, ...] = ()
    optional: bool = False


Schema = Mapping[str, Member]
"""What the arrays of a file must be, by their names; those whose names end in _0, _1 … stand there as name_*."""


def real(*shape: int | str | None, optional: bool = False) -> Member:
    """Schema entry of an array of finite real numbers of this shape; None in it stands for any length."""
    return Member("f", shape, optional)


def whole(*shape: int | str | None, optional: bool = False) -> Member:
    """Schema entry of an array of whole numbers of this shape; None in it stands for any length."""
    return Member("i", shape, optional)


def truth(*shape: int | str | None, optional: bool = False) -> Member:
    """Schema entry of an array of booleans of this shape; None in it stands for any length."""
    return Member("b", shape, optional)


def texts(*shape: int | str | None, optional: bool = False) -> Member:
    """Schema entry of an array of texts of this shape; a single text without a shape."""
    return Member("U", shape, optional)


def read_arrays(path: Path, schema: Schema, *, todo: Message) -> Arrays:
    """Read the arrays that `schema` names from a file, and check them; InputError if one is missing or wrong.

    Other arrays in the file are left out.

    Raises
    ------
    InputError
        If the file is missing or damaged, lacks an array, or one is not what it must be, or not finite.
    """
    if not path.exists():
        raise InputError(MISSING, where=path, todo=todo)
    data = read_bytes(path)
    try:
        arrays = _members(data)
    except (zipfile.BadZipFile, ValueError, EOFError, OSError, KeyError, NotImplementedError, RuntimeError) as error:
        what = Message("file.no_whole_arrays", "this is no whole file of arrays ({reason})", reason=str(error))
        raise InputError(what, where=path, todo=todo) from error
    sizes: dict[str, int] = {}
    for name in schema:
        if name not in arrays and not schema[name].optional and not name.endswith("*"):
            raise InputError(_missing(name), where=path, todo=todo)
    known = {name: member for name in arrays if (member := schema.get(_NUMBER.sub("_*", name), schema.get(name)))}
    for name, member in known.items():
        if (wrong := _wrong(name, arrays[name], member, sizes)) is not None:
            raise InputError(wrong, where=path, todo=todo)
    return {name: arrays[name] for name in known}


def _wrong(name: str, array: NDArray[Any], member: Member, sizes: dict[str, int]) -> Message | None:
    """What is wrong with an array, if anything; `sizes` gathers the numbers that have names."""
    if array.size and array.dtype.kind not in member.kinds:
        return Message(
            "file.array_kind", "the array {name} holds {found}, not {wanted}",
            name=name, found=_KIND_WORDS[array.dtype.kind], wanted=_KIND_WORDS[member.kinds[0]],
        )  # fmt: skip
    wanted = tuple(sizes.get(one, one) if isinstance(one, str) else one for one in member.shape)
    if len(wanted) != array.ndim or any(
        isinstance(one, int) and one != found for one, found in zip(wanted, array.shape, strict=True)
    ):
        return wrong_shape(name, array, wanted)
    sizes |= {one: found for one, found in zip(wanted, array.shape, strict=True) if isinstance(one, str)}
    if array.dtype.kind == "f" and not (np.abs(array) <= min(LARGEST, float(np.finfo(array.dtype).max))).all():
        return Message("file.array_not_finite", "the array {name} holds values that are not finite", name=name)
    return None


def wrong_shape(name: str, array: NDArray[Any], wanted: Sequence[int | str | None]) -> Message:
    """Make the message that the array `name` has another shape than `wanted`, in which None stands for any length."""
    return Message(
        "file.array_shape", "the array {name} has shape {shape}, not {wanted}",
        name=name, shape=str(array.shape), wanted=" × ".join("n" if one is None else str(one) for one in wanted),
    )  # fmt: skip


def _members(data: bytes) -> dict[str, NDArray[Any]]:
    """The arrays of a file as `write_arrays` writes it; ValueError if one is packed, or is not as long as it says."""
    arrays = {}
    with zipfile.ZipFile(io.BytesIO(data)) as file:
        members = file.infolist()
        if sum(one.file_size for one in members) > len(data) or any(one.compress_type for one in members):
            raise ValueError("its arrays are packed, or longer than the file")
        for one in members:
            arrays[one.filename.removesuffix(".npy")] = _array(file.read(one))
    return arrays


def _array(data: bytes) -> NDArray[Any]:
    """One array, of numbers or texts; its head is read before room is made for what it declares."""
    stream = io.BytesIO(data)
    version = npy.read_magic(stream)
    if version not in _HEADS:
        raise ValueError(f"an array is of version {version[0]}.{version[1]}")
    try:
        shape, _, dtype = _HEADS[version](stream)
    except (SyntaxError, TypeError, RecursionError, MemoryError, TokenError) as error:
        raise ValueError("an array has no head") from error
    if dtype.kind not in _KINDS or not dtype.itemsize or not dtype.isnative:
        raise ValueError(f"an array is of type {dtype}")
    if min(shape, default=0) < 0 or math.prod(shape) * dtype.itemsize != len(data) - stream.tell():
        raise ValueError("an array is not as long as it says")
    stream.seek(0)
    array: NDArray[Any] = npy.read_array(stream, allow_pickle=False)
    if dtype.kind == "U":
        _check_characters(array.reshape(-1).view(np.uint32))
    return array


def _check_characters(codes: NDArray[np.uint32]) -> None:
    """ValueError if one is beyond Unicode, or half of a pair: no text could be made or written of it."""
    if np.any((codes > _LAST_CHARACTER) | ((codes >= _HALVES[0]) & (codes <= _HALVES[1]))):
        raise ValueError("a text holds no characters")


@contextmanager
def unpacking(path: Path, *, todo: Message) -> Iterator[None]:
    """Within the `with` block, turn errors of missing arrays or arrays that do not fit into an InputError about `path`.

    Within it, KeyError is for a missing array, ValueError and TypeError for what does not fit.
    """
    try:
        yield
    except KeyError as error:
        raise InputError(_missing(str(error.args[0])), where=path, todo=todo) from error
    except (ValueError, TypeError, IndexError, OverflowError, RecursionError) as error:
        what = Message("file.arrays_do_not_fit", "its arrays do not fit together ({reason})", reason=str(error))
        raise InputError(what, where=path, todo=todo) from error


def _missing(name: str) -> Message:
    return Message("file.array_missing", "the array {name} is missing", name=name)


def pack_centrelines(prefix: str, groups: Sequence[Sequence[Centreline]]) -> dict[str, NDArray[Any]]:
    """Pack groups of centrelines into arrays named by `prefix`: counts, lengths, and all points end to end."""
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


def centreline_members(prefix: str, groups: str | int) -> Schema:
    """Make the schema of the arrays that `pack_centrelines` names by `prefix`, for this number of groups."""
    pieces, points = f"{prefix} pieces", f"{prefix} points"
    return {
        f"{prefix}_counts": whole(groups),
        f"{prefix}_lengths": whole(pieces),
        f"{prefix}_correlation_px": real(pieces),
        f"{prefix}_uv": real(points, 2),
        f"{prefix}_normal": real(points, 2),
        f"{prefix}_width": real(points),
        f"{prefix}_strength": real(points),
        f"{prefix}_sigma": real(points),
        f"{prefix}_saturated": truth(points),
        f"{prefix}_{_SINCE_LATER}": real(points, optional=True),
    }


def unpack_centrelines(prefix: str, arrays: Arrays) -> tuple[tuple[Centreline, ...], ...]:
    """Rebuild groups of centrelines from `pack_centrelines`' arrays; KeyError or ValueError if they do not fit."""
    lengths, counts = arrays[f"{prefix}_lengths"], arrays[f"{prefix}_counts"]
    check_parts(lengths, len(arrays[f"{prefix}_uv"]))
    check_parts(counts, len(lengths))
    ends = np.cumsum(lengths)[:-1]
    known = [name for name in _POINTS if name != _SINCE_LATER or f"{prefix}_{name}" in arrays]
    columns = {name: np.split(arrays[f"{prefix}_{name}"], ends) for name in known}
    pieces = [
        Centreline(**{name: column[i] for name, column in columns.items()}, correlation_px=correlation)
        for i, correlation in enumerate(arrays[f"{prefix}_correlation_px"].tolist())
    ]
    starts = np.concatenate([[0], np.cumsum(counts)])
    return tuple(tuple(pieces[a:b]) for a, b in pairwise(starts.tolist()))


def check_parts(lengths: NDArray[Any], total: int) -> None:
    """Raise ValueError unless all `lengths` are at least 0 and their sum is `total`."""
    if np.any(lengths < 0) or np.any(lengths > total) or int(lengths.sum()) != total:
        raise ValueError(f"its parts do not make {total}")


def pack_messages(messages: Sequence[Message | None]) -> NDArray[Any]:
    """Pack messages into an array of texts for `unpack_messages`; None becomes ''."""
    return pack_texts([as_text(message) for message in messages])


def unpack_messages(texts: NDArray[Any]) -> list[Message | None]:
    """Read the messages of `pack_messages`: '' is None, an older file's bare sentence has no code."""
    return [from_text(text) for text in unpack_texts(texts)]


def pack_texts(texts: Sequence[str]) -> NDArray[Any]:
    """Pack texts into an array of texts that keeps them, except for NUL characters at their ends."""
    return np.array(list(texts), dtype=np.str_) if texts else np.zeros(0, dtype="<U1")


def unpack_texts(texts: NDArray[Any]) -> list[str]:
    """Read the texts of `pack_texts` as a list; ValueError if the array does not hold texts."""
    if texts.ndim != 1 or texts.dtype.kind != "U":
        raise ValueError("an array of texts holds something else")
    return [str(text) for text in texts.tolist()]
