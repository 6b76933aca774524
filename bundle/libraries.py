"""Less of the shared libraries that wheels bring, on Linux: of the folder they are nine tenths.

What is taken out is never run or read: names for a debugger, links to libraries of which nothing is used and then these
libraries, second copies, and what Qt's ICU knows of languages that the program does not speak.
"""

from __future__ import annotations

import hashlib
import re
import shutil
import struct
import subprocess
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from contents import LANGUAGES

LIBRARY = re.compile(r"\.so(\.\d+)*$")
"""How the name of a shared library ends."""
WORTH_IT = 100_000
"""Bytes of a file that is worth a look: what is smaller is a hundredth of the folder."""
PAGE = 4096
"""Bytes of a page of memory."""
DT_NULL, DT_NEEDED = 0, 1
ICU_ALIGNED = 16
"""Bytes: where an item of ICU's data may begin."""


def lessen(folder: Path, work: Path) -> None:
    """Make the libraries in a folder smaller, and leave out those that nothing uses; `work` is for files in between."""
    strip(folder, work / "stripped")
    for library in libraries(folder):
        if library.name.startswith("libicudata."):
            cut_icu(library, work)
    drop_unused(folder)
    link_copies(folder)


def libraries(folder: Path) -> list[Path]:
    """The shared libraries in a folder, without links to them."""
    return sorted(path for path in folder.rglob("*") if LIBRARY.search(path.name) and not path.is_symlink())


def strip(folder: Path, stripped: Path) -> None:
    """Take the names for a debugger out of the libraries that bring them.

    What was changed after it was linked, as many libraries in wheels were, may be spoilt by it: it is left as it is.
    """
    for library in libraries(folder):
        if library.stat().st_size < WORTH_IT or ".symtab" not in readelf("-S", library):
            continue
        subprocess.run(("strip", "--strip-unneeded", "-o", stripped, library), check=True)
        if can_be_mapped(stripped):
            shutil.copyfile(stripped, library)
    stripped.unlink(missing_ok=True)


def can_be_mapped(library: Path) -> bool:
    """Whether each loaded part of a library lies in the file where its pages can be mapped from."""
    loaded = [line.split() for line in readelf("-l", library).splitlines() if line.split()[:1] == ["LOAD"]]
    return all((int(offset, 16) - int(address, 16)) % PAGE == 0 for _, offset, address, *_ in loaded)


def readelf(what: str, library: Path) -> str:
    """What a shared library says of its sections (-S), of what is loaded of it (-l), its links (-d) or symbols."""
    return subprocess.run(["readelf", "-W", what, str(library)], capture_output=True, text=True, check=True).stdout


def cut_icu(library: Path, work: Path) -> None:
    """Leave ICU, which Qt sorts texts by, the languages of the program: 30 of its 32 MB are others and old encodings.

    The library is nothing but ICU's "common data": a header, a table of names and places, and the items by name.
    """
    held = library.read_bytes()
    begin = held.index(b"CmnD") - 12
    table = begin + struct.unpack_from("<H", held, begin)[0]
    (count,) = struct.unpack_from("<I", held, table)
    entries = [struct.unpack_from("<II", held, table + 4 + 8 * k) for k in range(count)]
    (symbol,) = re.findall(rb"icudt\d+_dat", held)[:1]
    end = begin + int(re.findall(rf"(\w+) OBJECT .* {symbol.decode()}", readelf("--dyn-syms", library))[0], 0)
    ends = [*(table + place for _, place in entries[1:]), end]
    items = {}
    for (name_at, place), until in zip(entries, ends, strict=True):
        name = held[table + name_at : held.index(b"\0", table + name_at)]
        if icu_is_wanted(name.decode().split("/", 1)[1]):
            items[name] = held[table + place : until]

    names, places, body = b"", [], b""
    first = 4 + 8 * len(items) + sum(len(name) + 1 for name in items)
    first += -(table - begin + first) % ICU_ALIGNED
    for name, item in items.items():
        places.append((4 + 8 * len(items) + len(names), first + len(body)))
        names += name + b"\0"
        body += item + bytes(-len(item) % ICU_ALIGNED)
    toc = struct.pack("<I", len(items)) + b"".join(struct.pack("<II", *place) for place in places) + names
    link_data(held[begin:table] + toc.ljust(first, b"\0") + body, symbol.decode(), library, work)


def icu_is_wanted(name: str) -> bool:
    """Whether an item of ICU's data is kept: of characters; how the program's languages sort, and call time zones."""
    folder, _, base = name.rpartition("/")
    if not folder and base.endswith((".icu", ".nrm")):
        return True
    kept = (*LANGUAGES, "res_index", "pool", "ucadata", "supplementalData", "likelySubtags", "numberingSystems")
    zones = ("metaZones", "timezoneTypes", "zoneinfo64", "tzdbNames")
    return folder in ("", "coll", "zone") and base.endswith((".res", ".icu")) and base.startswith(kept + zones)


def link_data(data: bytes, symbol: str, library: Path, work: Path) -> None:
    """Write a shared library that holds nothing but data under one symbol, in the place of another."""
    (work / "data").write_bytes(data)
    subprocess.run(("ld", "-r", "-b", "binary", "-o", "data.o", "data"), cwd=work, check=True)
    aligned = ("--set-section-alignment", f".data={ICU_ALIGNED}", "--redefine-sym", f"_binary_data_start={symbol}")
    subprocess.run(
        ("objcopy", *aligned, "-N", "_binary_data_end", "-N", "_binary_data_size", "data.o"), cwd=work, check=True
    )
    # data says nothing of the stack, which counts as if it wanted to execute code there: refused from glibc 2.41 on
    shared = ("ld", "-shared", "-z", "noexecstack", "-soname", library.name)
    subprocess.run((*shared, "-o", library, "data.o"), cwd=work, check=True)
    for name in ("data", "data.o"):
        (work / name).unlink()


@dataclass(frozen=True)
class Linked:
    """What a shared library offers, what it asks for, and which libraries it is linked to, by their names."""

    offers: frozenset[str]
    asks: frozenset[str]
    links: tuple[str, ...]


def linked(library: Path) -> Linked:
    """Read what a library is linked to and by which symbols."""
    rows = [row for line in readelf("--dyn-syms", library).splitlines() if len(row := line.split()) > 7]
    of = defaultdict(set)
    for row in rows:
        of[row[6] == "UND"].add(row[7].split("@")[0])
    links = re.findall(r"\(NEEDED\).*\[(.*)\]", readelf("-d", library))
    return Linked(frozenset(of[False]), frozenset(of[True]), tuple(links))


def drop_unused(folder: Path) -> None:
    """Leave out the libraries that others are linked to but use nothing of, and cut the links to them."""
    found = {path: linked(path) for path in libraries(folder)}
    named = {path.name: path for path in found}
    all_linked = {name for one in found.values() for name in one.links}
    used = {path for path in found if path.name not in all_linked}
    waiting = list(used)
    while waiting:
        one = waiting.pop()
        for other in reached(one, found, named) - used:
            if found[one].asks & found[other].offers:
                used.add(other)
                waiting.append(other)
    unused = {path.name for path in found} - {path.name for path in used}
    for path in found:
        if path.name in unused:
            path.unlink()
        elif unused.intersection(found[path].links):
            cut_links(path, unused)
    for path in folder.rglob("*"):
        if path.is_symlink() and not path.exists():
            path.unlink()


def reached(library: Path, found: dict[Path, Linked], named: dict[str, Path]) -> set[Path]:
    """The libraries of the folder that are loaded with one, by its links and theirs."""
    seen: set[Path] = set()
    waiting = [library]
    while waiting:
        for name in found[waiting.pop()].links:
            if name in named and named[name] not in seen:
                seen.add(named[name])
                waiting.append(named[name])
    return seen


def cut_links(library: Path, names: Iterable[str]) -> None:
    """Take links to other libraries out of a library's table, which is a list that ends with zeros; no byte moves."""
    place = re.search(r"Dynamic section at offset (0x[0-9a-f]+) ", readelf("-d", library))
    assert place is not None
    held = bytearray(library.read_bytes())
    begin, kept, size = int(place[1], 16), [], struct.calcsize("<qQ")
    links = iter(re.findall(r"\(NEEDED\).*\[(.*)\]", readelf("-d", library)))
    count = 0
    for tag, value in struct.iter_unpack("<qQ", held[begin : begin + (len(held) - begin) // size * size]):
        count += 1
        if tag == DT_NULL:
            break
        if tag != DT_NEEDED or next(links) not in names:
            kept.append(struct.pack("<qQ", tag, value))
    held[begin : begin + count * size] = b"".join(kept).ljust(count * size, b"\0")
    library.write_bytes(held)


def link_copies(folder: Path) -> None:
    """Let files of the same content be one file with several names."""
    first: dict[bytes, Path] = {}
    for path in sorted(folder.rglob("*")):
        if path.is_symlink() or not path.is_file() or path.stat().st_size < WORTH_IT:
            continue
        kept = first.setdefault(hashlib.sha256(path.read_bytes()).digest(), path)
        if kept is not path and not kept.samefile(path):
            path.unlink()
            path.hardlink_to(kept)
