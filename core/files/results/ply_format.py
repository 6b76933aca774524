"""The PLY format over numpy's structured arrays: scalar and list properties, comments, text and both byte orders.

The libraries the program has do not keep what a cloud needs: trimesh and VTK's writer drop comments or scalar
properties that are no colours, and a licence that binds the whole program is none for us.

References
----------
G. Turk: The PLY Polygon File Format, 1994.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Rows = NDArray[Any]

_ORDERS = {"ascii": "=", "binary_little_endian": "<", "binary_big_endian": ">"}
_TYPES = {
    "i1": ("char", "int8"), "u1": ("uchar", "uint8"), "i2": ("short", "int16"), "u2": ("ushort", "uint16"),
    "i4": ("int", "int32"), "u4": ("uint", "uint32"), "f4": ("float", "float32"), "f8": ("double", "float64"),
}  # fmt: skip
"""Numpy's types by what PLY calls them: the older name, which all programs know, and the newer."""
_NUMPY = {name: kind for kind, names in _TYPES.items() for name in names}
_END = b"end_header"
_HEADER_BYTES = 100_000
"""More than any header has: a file without its end is not searched to its own."""
_COUNT_DIGITS = 19
"""As many as a count of 64 bits has."""


@dataclass(frozen=True, eq=False, slots=True)
class Ply:
    """Elements of a PLY file by name, each a structured array, and the comments.

    A list property is a field of k values.
    """

    elements: Mapping[str, Rows]
    comments: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class _Property:
    name: str
    kind: str
    """Of its values, as numpy calls it."""
    count: str = ""
    """Of a list's length; "" if it is no list."""


def ply_bytes(ply: Ply, *, byte_order: str = "<") -> bytes:
    """Encode a PLY file as binary, little-endian ("<") or big-endian (">"); a list has at most 255 entries.

    Lists have their length in one byte.
    """
    form = next(name for name, order in _ORDERS.items() if order == byte_order)
    head = ["ply", f"format {form} 1.0", *(f"comment {line}" for line in ply.comments)]
    parts: list[bytes] = []
    for name, rows in ply.elements.items():
        properties = [
            _Property(field, rows.dtype[field].base.str[1:], "u1" if rows.dtype[field].shape else "")
            for field in rows.dtype.names or ()
        ]
        lengths = [rows.dtype[one.name].shape[0] if one.count else 0 for one in properties]
        packed = np.empty(len(rows), _packed(properties, lengths, byte_order))
        for one, length in zip(properties, lengths, strict=True):
            packed[one.name] = rows[one.name]
            if one.count:
                packed[_length(one)] = length
        head += [f"element {name} {len(rows)}", *map(_line, properties)]
        parts.append(packed.tobytes())
    return "\n".join([*head, "end_header\n"]).encode("ascii", "replace") + b"".join(parts)


def parse_ply(data: bytes) -> Ply:
    """Parse the bytes of a PLY file; its arrays are views on `data`, not copies.

    Raises
    ------
    ValueError
        If it is no PLY, ends early, or has lists of differing lengths.
    """
    lines, body = _head(data)
    order = _ORDERS.get(" ".join(lines[1].split()[1:2])) if len(lines) > 1 and lines[0] == "ply" else None
    if order is None:
        raise ValueError("no PLY header")
    comments: list[str] = []
    declared: list[tuple[str, int, list[_Property]]] = []
    for line in lines[2:]:
        word, _, rest = line.partition(" ")
        if word == "comment":
            comments.append(rest)
        elif word == "element":
            name, count = rest.split()
            if not (count.isascii() and count.isdigit() and len(count) < _COUNT_DIGITS and int(count) <= len(data)):
                raise ValueError(f"element {name} has no count that fits the file")
            declared.append((name, int(count), []))
        elif word == "property" and declared:
            declared[-1][2].append(_property(rest.split()))
        elif word not in ("obj_info", ""):
            raise ValueError(f"header line not understood: {line[:40]!r}")
    left = memoryview(data)[body:]
    elements: dict[str, Rows] = {}
    tokens = bytes(left).split() if order == "=" else []
    for name, length, properties in declared:
        if order == "=":
            rows, used = _text_rows(tokens, length, properties)
            tokens = tokens[used:]
        else:
            rows = _binary_rows(left, length, properties, order)
            left = left[rows.nbytes :]
        elements[name] = rows
    return Ply(elements, tuple(comments))


def _head(data: bytes) -> tuple[list[str], int]:
    """The header's lines without its end, and where the data begin."""
    end = data.find(b"\n" + _END, 0, _HEADER_BYTES)
    begin = data.find(b"\n", end + 1) + 1
    if end < 0 or begin <= 0:
        raise ValueError("the header has no end")
    return [line.strip() for line in data[:end].decode("utf-8", "replace").splitlines()], begin


def _property(words: Sequence[str]) -> _Property:
    kinds = [_NUMPY.get(word, "") for word in words[:-1]]
    if len(words) == 2 and kinds[0]:
        return _Property(words[1], kinds[0])
    if len(words) == 4 and words[0] == "list" and kinds[1] and kinds[1][0] != "f" and kinds[2]:
        return _Property(words[3], kinds[2], kinds[1])
    raise ValueError(f"property not understood: {' '.join(words)[:40]!r}")


def _line(one: _Property) -> str:
    kind = _TYPES[one.kind][0]
    return f"property list {_TYPES[one.count][0]} {kind} {one.name}" if one.count else f"property {kind} {one.name}"


def _length(one: _Property) -> str:
    """The field that holds how long a list is; no property is called so, for names have no space."""
    return f"{one.name} length"


def _packed(properties: Sequence[_Property], lengths: Sequence[int], order: str) -> np.dtype[Any]:
    """One row as it lies in a binary file whose lists are `lengths` long."""
    fields: list[Any] = []
    for one, length in zip(properties, lengths, strict=True):
        if one.count:
            fields.append((_length(one), order + one.count))
        fields.append((one.name, order + one.kind, (length,)) if one.count else (one.name, order + one.kind))
    return np.dtype(fields)


def _binary_rows(data: memoryview, count: int, properties: Sequence[_Property], order: str) -> Rows:
    lengths: list[int] = []
    for place, one in enumerate(properties):
        # The first row says how long the lists are, one after the other.
        before = _packed(properties[:place], lengths, order).itemsize
        read = np.dtype(order + one.count) if one.count and count else None
        lengths.append(int(np.frombuffer(data, read, 1, before)[0]) if read else 0)
        if lengths[-1] < 0 or lengths[-1] > len(data):
            raise ValueError(f"a list {one.name} ends early")
    form = _packed(properties, lengths, order)
    if count * form.itemsize > len(data):
        raise ValueError(f"the data end early: {len(data)} bytes, not {count * form.itemsize}")
    if not form.itemsize:
        return np.zeros(0, form)
    rows: Rows = np.frombuffer(data, form, count)
    _check_lengths(rows, properties, lengths)
    return rows


def _text_rows(tokens: Sequence[bytes], count: int, properties: Sequence[_Property]) -> tuple[Rows, int]:
    """Rows of a text file, and how many of the tokens they are."""
    lengths: list[int] = []
    width = 0
    for one in properties:
        if one.count and count and width >= len(tokens):
            raise ValueError("the data end early")
        lengths.append(int(tokens[width]) if one.count and count else 0)
        if not 0 <= lengths[-1] <= len(tokens):
            raise ValueError(f"a list {one.name} ends early")
        width += lengths[-1] + 1 if one.count else 1
    if count * width > len(tokens):
        raise ValueError(f"the data end early: {len(tokens)} numbers, not {count * width}")
    numbers = np.array(tokens[: count * width], dtype=np.float64).reshape(count, width)
    rows = np.zeros(count, _packed(properties, lengths, "="))
    column = 0
    for one, length in zip(properties, lengths, strict=True):
        for field, size in ((_length(one), 1), (one.name, length)) if one.count else ((one.name, 1),):
            values = numbers[:, column : column + size]
            kind = rows.dtype[field].base
            if kind.kind != "f" and not _fits(values, np.iinfo(kind)):
                raise ValueError(f"property {one.name} has values that are no {_TYPES[kind.str[1:]][0]}")
            rows[field] = values if field == one.name and one.count else values[:, 0]
            column += size
    _check_lengths(rows, properties, lengths)
    return rows, count * width


def _fits(values: NDArray[np.float64], info: np.iinfo[Any]) -> bool:
    return bool(np.all((values >= info.min) & (values <= info.max) & (values == np.trunc(values))))


def _check_lengths(rows: Rows, properties: Sequence[_Property], lengths: Sequence[int]) -> None:
    for one, length in zip(properties, lengths, strict=True):
        if one.count and np.any(rows[_length(one)] != length):
            raise ValueError(f"the lists {one.name} are not all of one length")
