"""Seeded mutations of a file: of its bytes, of its words, and of what it says."""

from __future__ import annotations

import io
import json
import re
import tomllib
import zlib
from collections.abc import Callable, MutableMapping, MutableSequence
from tokenize import TokenError
from typing import Any
from zipfile import BadZipFile

import numpy as np

from core.files.toml_text import toml_text

Draw = np.random.Generator

WORDS = (
    b"NaN", b"Infinity", b"-Infinity", b"inf", b"1e300", b"-1e300", b"1e999", b"0", b"-0.0", b"-1", b"1", b"true",
    b"null", b'""', b"[]", b"{}", b"1" + b"0" * 50, b"9" * 5000, b"2147483648", b"9223372036854775808", b"1e-320",
    b"[" * 50, b"[" * 3000, b"{" * 3000, b'{"a":' * 3000, b"a." * 3000, b"\x00", b"\x1b[31m", b"\r", b"[/b]", b"{x}",
    b"{0.__class__}", b"%n", b"\xff\xfe", b"\xed\xa0\x80", b'"\\ud800"', b"x" * 140_000, b"\n", b"#", b"'''", b"=1+1",
    "\u202e".encode(), b"../../../etc/passwd", b"/dev/zero",
)  # fmt: skip
VALUES: tuple[Any, ...] = (
    None, True, False, 0, 1, -1, 2**31, 2**63, -(2**63), 10**90, 1e300, -1e300, 1e-320, 1e308, float("nan"),
    float("inf"), -float("inf"), "", "x", "x" * 100_000, "a\x00b", "\x1b[2J", "[/b]", "{x}", "1", "nan", [], {}, [[]],
    [1], [1, 2, 3], {"": 1}, {"kind": "x"}, [None], [True] * 3, [1e300] * 3, "../..", "/dev/zero", "2026-01-01",
)  # fmt: skip


def mutated(data: bytes, name: str, draw: Draw) -> bytes:
    """The file `name` changed once or a few times."""
    by_meaning = _MEANINGS.get(name.rpartition(".")[2])
    for _ in range(1 + int(draw.geometric(0.6)) if draw.random() < 0.5 else 1):
        if by_meaning is not None and draw.random() < 0.6:
            try:
                data = by_meaning(data, draw)
                continue
            except (
                ValueError,
                LookupError,
                TypeError,
                RecursionError,
                OverflowError,
                EOFError,
                OSError,
                BadZipFile,
                AttributeError,
                TokenError,
                RuntimeError,
            ):
                pass  # it no longer is what it was: its bytes are left to change
        data = _one_of(_BYTES, draw)(data, draw)
    return data


def _one_of(things: Any, draw: Draw) -> Any:
    return things[int(draw.integers(len(things)))]


def _place(data: bytes, draw: Draw) -> int:
    """Heads are small and say the most."""
    return int(draw.integers(min(len(data), 300) + 1 if draw.random() < 0.4 else len(data) + 1))


def _flip(data: bytes, draw: Draw) -> bytes:
    changed = bytearray(data)
    for _ in range(int(draw.integers(1, 9))):
        if changed:
            changed[_place(data, draw) - 1] = int(draw.integers(256))
    return bytes(changed)


def _truncate(data: bytes, draw: Draw) -> bytes:
    return data[: _place(data, draw)]


def _cut(data: bytes, draw: Draw) -> bytes:
    at = _place(data, draw)
    return data[:at] + data[at + int(draw.integers(1, 200)) :]


def _double(data: bytes, draw: Draw) -> bytes:
    at, size = _place(data, draw), int(draw.integers(1, 200))
    return data[: at + size] + data[at : at + size] * int(draw.integers(1, 20)) + data[at + size :]


def _swap(data: bytes, draw: Draw) -> bytes:
    a, b, size = _place(data, draw), _place(data, draw), int(draw.integers(1, 64))
    a, b = min(a, b), max(a, b)
    return data[:a] + data[b : b + size] + data[a + size : b] + data[a : a + size] + data[b + size :]


def _insert(data: bytes, draw: Draw) -> bytes:
    at = _place(data, draw)
    return data[:at] + _one_of(WORDS, draw) + data[at:]


def _word(data: bytes, draw: Draw) -> bytes:
    """A number or a word replaced by an extreme one."""
    found = list(re.finditer(rb"[-+0-9.eE]+|\w+", data[:50_000]))
    if not found:
        return _insert(data, draw)
    one = _one_of(found, draw)
    return data[: one.start()] + _one_of(WORDS, draw) + data[one.end() :]


_BYTES = (_flip, _truncate, _cut, _double, _swap, _insert, _word, _word)


def _change_tree(tree: Any, draw: Draw) -> Any:
    """A value somewhere in lists and tables replaced, left out, doubled, wrapped or swapped with another."""
    places: list[tuple[Any, Any]] = []
    waiting = [tree]
    while waiting and len(places) < 20_000:
        one = waiting.pop(0)
        if isinstance(one, dict | list):
            inner = list(one.items() if isinstance(one, dict) else enumerate(one))
            places += [(one, key) for key, _ in inner]
            waiting += [value for _, value in inner]
    if not places:
        return _one_of(VALUES, draw)
    owner, key = _one_of(places, draw)
    way = int(draw.integers(7))
    if way == 0:
        del owner[key]
    elif way == 1:
        other, its = _one_of(places, draw)
        owner[key] = json.loads(json.dumps(other[its])) if other is not owner else other[its]
    elif way == 2:
        for _ in range(int(draw.integers(1, 80))):
            owner[key] = [owner[key]] if draw.random() < 0.5 else {"a": owner[key]}
    elif way == 3 and isinstance(owner, MutableMapping):
        owner[_one_of(("", "x", "__class__", "kind", "[/b]"), draw)] = owner.pop(key)
    elif way == 4 and isinstance(owner, MutableSequence):
        owner.extend([owner[key]] * int(draw.integers(1, 50)))
    else:
        owner[key] = _one_of(VALUES, draw)
    return tree


def _json(data: bytes, draw: Draw) -> bytes:
    return json.dumps(_change_tree(json.loads(data), draw)).encode()


def _toml(data: bytes, draw: Draw) -> bytes:
    return toml_text(_change_tree(tomllib.loads(data.decode()), draw)).encode()


def _npz(data: bytes, draw: Draw) -> bytes:
    with np.load(io.BytesIO(data), allow_pickle=False) as file:
        arrays = dict(file)
    name = _one_of(sorted(arrays), draw)
    if draw.random() < 0.1:
        del arrays[name]
    elif draw.random() < 0.1:
        arrays[name] = arrays[_one_of(sorted(arrays), draw)]
    else:
        arrays[name] = _one_of(_ARRAYS, draw)(arrays[name], draw)
    out = io.BytesIO()
    np.savez(out, allow_pickle=False, **arrays)
    return out.getvalue()


def _spoilt(array: Any, draw: Draw) -> Any:
    changed = array.copy()
    if changed.size:
        value = _one_of(
            (0, 1, -1, 2**31 - 1, 2**62, -(2**62), 1e300, 1e-300, np.nan, np.inf, "x" * 40, '{"code": '), draw
        )
        at = int(draw.integers(changed.size)) if draw.random() < 0.7 else slice(None)
        with np.errstate(all="ignore"):
            changed.reshape(-1)[at] = value if changed.dtype.kind == "U" or not isinstance(value, str) else 7
    return changed


def _cast(array: Any, dtype: str) -> Any:
    with np.errstate(invalid="ignore"):  # of NaN as a whole number, say
        return array.astype(dtype)


_ARRAYS: tuple[Callable[[Any, Draw], Any], ...] = (
    _spoilt, _spoilt, _spoilt, _spoilt,
    lambda array, draw: array[: len(array) // 2] if array.ndim else array[None],
    lambda array, draw: array[:0] if array.ndim else np.zeros(0, array.dtype),
    lambda array, draw: np.concatenate([array, array]) if array.ndim else array[None, None],
    lambda array, draw: array.reshape(-1),
    lambda array, draw: array[..., None],
    lambda array, draw: array.T,
    lambda array, draw: _cast(array, _one_of(("U5", "f4", "i1", "?"), draw)),
    lambda array, draw: np.array(_one_of((0, -1, 1e300, "x", True, 2**62), draw)),
)  # fmt: skip


def _png(data: bytes, draw: Draw) -> bytes:
    """A value of the head, its checksum right."""
    head = bytearray(data[16:29])
    at = int(draw.integers(len(head)))
    head[at] = _one_of((0, 1, 2, 3, 4, 6, 8, 16, 127, 255), draw)
    return data[:16] + head + zlib.crc32(b"IHDR" + head).to_bytes(4, "big") + data[33:]


_MEANINGS: dict[str, Callable[[bytes, Draw], bytes]] = {"json": _json, "toml": _toml, "npz": _npz, "png": _png}
