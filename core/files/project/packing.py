"""A whole project in one file, to be sent and kept: NAME.trisectz, a ZIP file with a list of what is in it.

The list, `contents.json`, comes last and holds size and SHA-256 of every file. Unpacking checks all of them, and takes
nothing that is not in the list.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import tempfile
import zipfile
import zlib
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from core import __version__
from core.errors import InputError
from core.files.atomic import folder_beside, write_beside
from core.files.complaints import checked_json
from core.files.json_text import to_json
from core.files.limits import TEXT_BYTES, check_bytes, check_file
from core.files.project.data import ProjectFile
from core.files.project.folder import AUTOSAVE, PROJECT, read_project, require_free, source_folder
from core.files.project.json_form import project_text
from core.files.project.keys import relocated
from core.files.project.lock import LOCK
from core.files.project.report_template import logo_beside
from core.files.project.witness import Written, witnessed
from core.files.reading import cannot_read, json_of, resolved
from core.files.recording.recording_set import CHECK, PARTS
from core.files.recording.rig import Table
from core.files.results.nominal_surface import nominal_names
from core.files.tables import TIME_WORDS, Time
from core.held_files import rename
from core.messages import Message
from core.progress import Progress, silent, steps

PACKED = ".trisectz"
CONTENTS = "contents.json"
FILES_MOST = 200_000
"""Files a packed project may have."""
GATHERED = "recordings/packed"
"""Where folders of pictures from outside the project go in the pack."""
ENCLOSED = "enclosed"
"""The same for nominal surfaces and the report's template."""

_LEFT_BEHIND = re.compile(rf"^({re.escape(AUTOSAVE)}|{re.escape(LOCK)}|\.new|.*\.part)$")
_COMPRESSED = (".png", ".jpg", ".jpeg", ".npz", ".pdf", ".zip", ".xlsx", ".3mf")
_BLOCK = 1 << 20
"""Bytes that are copied at a time: progress is told and cancelling is possible between two of them."""
_RESERVED = re.compile(r"^(con|prn|aux|nul|com\d|lpt\d)(\..*)?$", re.IGNORECASE)


class _PackedFile(Table):
    bytes: Annotated[int, Field(ge=0, description="a number of bytes")]
    sha256: Annotated[str, Field(pattern="^[0-9a-f]{64}$", description="64 hex digits")]


class _Contents(Table):
    """All of contents.json."""

    kind: Literal["trisect project"] = Field(description='"trisect project"')
    format: Literal[1]
    version: str = ""
    packed: Time = Field(description=TIME_WORDS)
    files: dict[str, _PackedFile] = Field(description="a table of files")


@dataclass(frozen=True, slots=True)
class Packed:
    """Packed project: its file, how many files are in it, and their total size in bytes."""

    path: Path
    files: int
    bytes: int


def pack_project(folder: Path, to: Path, progress: Progress = silent) -> Packed:
    """Pack the project in `folder` into the file `to`, whole or not at all.

    Folders of pictures, nominal surfaces and the report's template (with a logo beside it) that lie outside the project
    come along, and are within it in the pack; the results stay as up to date as they are. What belongs to a program at
    work (lock, autosaved state) stays behind.

    Raises
    ------
    InputError
        If there is no project, a file of it cannot be read, or nothing can be written there.
    """
    file = read_project(folder)
    files = {
        path.relative_to(folder).as_posix(): path
        for path in sorted(folder.rglob("*"))
        if path.is_file() and resolved(path) != resolved(to) and not _left_behind(path.relative_to(folder))
    }
    packed, outside = _with_all_within(folder, file)
    files |= outside
    _check_names(files, folder)
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as beside:
        if packed != file:
            files |= _rewritten(folder, Path(beside), file, packed)
        return _pack(files, to, progress)


def _rewritten(folder: Path, beside: Path, file: ProjectFile, packed: ProjectFile) -> dict[str, Path]:
    """project.json of the project with its pictures within it, and what witnesses of that write beside it."""
    text = project_text(packed, folder / PROJECT)
    with witnessed(beside, Written("packed", file, packed, text, of=folder)):
        (beside / PROJECT).write_text(text, encoding="utf-8", newline="\n")
    return {path.name: path for path in sorted(beside.iterdir())}


def _pack(files: Mapping[str, Path], to: Path, progress: Progress) -> Packed:
    total = 0

    def put(beside: Path) -> None:
        nonlocal total
        listed: dict[str, dict[str, object]] = {}
        with zipfile.ZipFile(beside, "x", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
            for name, path in steps(files.items(), progress, "packing", len(files)):
                listed[name] = _put_in(archive, name, path)
                total += int(str(listed[name]["bytes"]))
            now = datetime.now().astimezone().isoformat()
            about = {"kind": "trisect project", "format": 1, "version": __version__, "packed": now, "files": listed}
            archive.writestr(CONTENTS, to_json(about))
        with beside.open("rb") as whole:
            os.fsync(whole.fileno())

    write_beside(to, put)
    return Packed(to, len(files), total)


def unpack_project(path: Path, to: Path, progress: Progress = silent) -> Path:
    """Unpack the packed project `path` into the new folder `to`, whole or not at all, and return that folder.

    Raises
    ------
    InputError
        If `to` is there already, the file is no packed project or damaged, names files outside its folder, a hash is
        not what the list says, or nothing can be written there.
    """
    require_free(to)
    check_file(path)
    with _opened(path) as archive:
        contents = _contents(archive, path)
        _check_room(sum(one.bytes for one in contents.files.values()), to)
        with folder_beside(to) as beside:
            for name, one in steps(contents.files.items(), progress, "unpacking", len(contents.files)):
                place = beside / name
                place.parent.mkdir(parents=True, exist_ok=True)
                _take_out(archive, name, one, place, path)
            read_project(beside)
            rename(beside, to)
    return to


def _left_behind(path: Path) -> bool:
    return any(_LEFT_BEHIND.match(part) for part in path.parts)


def _with_all_within(folder: Path, file: ProjectFile) -> tuple[ProjectFile, Mapping[str, Path]]:
    """The project as it is once all it names lies within it, and the files from outside by their places there."""
    moved, files = _enclosed(folder, file)
    for part in (*PARTS, CHECK):
        stored = getattr(file.project.sources, part)
        pictures = source_folder(folder, stored)
        if pictures is None or not pictures.is_dir() or resolved(pictures).is_relative_to(resolved(folder)):
            continue
        place = f"{GATHERED}/{part}"
        while (folder / place).exists():
            place += "-1"
        moved[stored] = place
        for path in sorted(pictures.rglob("*")):
            if path.is_file() and not _left_behind(path.relative_to(pictures)):
                files[f"{place}/{path.relative_to(pictures).as_posix()}"] = path
    return relocated(file, moved), files


def _enclosed(folder: Path, file: ProjectFile) -> tuple[dict[str, str], dict[str, Path]]:
    """Nominal surfaces and the template: their names in the pack, where these are others, and what lies outside."""
    moved: dict[str, str] = {}
    files: dict[str, Path] = {}
    for stored in sorted({*nominal_names(file.project.inspection), file.project.report.template} - {""}):
        path = resolved(folder / stored)
        if path.is_relative_to(resolved(folder)):
            moved[stored] = path.relative_to(resolved(folder)).as_posix()
        elif path.is_file():
            place = f"{ENCLOSED}/{len(files) + 1}"
            moved[stored] = f"{place}/{path.name}"
            files[moved[stored]] = path
            if stored == file.project.report.template and (logo := logo_beside(path)) is not None:
                files[f"{place}/{logo.relative_to(path.parent).as_posix()}"] = logo
    return {name: place for name, place in moved.items() if name != place}, files


def _put_in(archive: zipfile.ZipFile, name: str, path: Path) -> dict[str, object]:
    """Copy a file into the pack; what it says of it in the list."""
    digest, count = hashlib.sha256(), 0
    info = zipfile.ZipInfo.from_file(path, name, strict_timestamps=False)
    info.compress_type = zipfile.ZIP_STORED if path.suffix.lower() in _COMPRESSED else zipfile.ZIP_DEFLATED
    try:
        source = path.open("rb")
    except OSError as error:
        raise cannot_read(path, error) from error
    with source, archive.open(info, "w", force_zip64=True) as target:
        while block := source.read(_BLOCK):
            digest.update(block)
            count += len(block)
            target.write(block)
    return {"bytes": count, "sha256": digest.hexdigest()}


def _opened(path: Path) -> zipfile.ZipFile:
    try:
        return zipfile.ZipFile(path)
    except OSError as error:
        raise cannot_read(path, error) from error
    except (zipfile.BadZipFile, ValueError, NotImplementedError) as error:
        raise _damaged(path, str(error)) from error


def _contents(archive: zipfile.ZipFile, path: Path) -> _Contents:
    """The list, checked: names that stay within a folder, and the very files that are in the pack."""
    names = [info.filename for info in archive.infolist()]
    if len(names) > FILES_MOST or CONTENTS not in names:
        raise _damaged(path, f"{len(names)} files, {CONTENTS} {'among' if CONTENTS in names else 'not among'} them")
    check_bytes(archive.getinfo(CONTENTS).file_size, path, TEXT_BYTES)
    text = b"".join(_blocks(archive, CONTENTS, TEXT_BYTES, path))
    contents = checked_json(_Contents, json_of(text.decode("utf-8", "replace"), path), path)
    if len(set(names)) != len(names) or {*names} != {*contents.files, CONTENTS}:
        raise _damaged(path, Message("project.pack_files", "its files are not those of {list}", list=CONTENTS))
    _check_names(contents.files, path)
    return contents


def _check_names(names: Collection[str], path: Path) -> None:
    """InputError unless each name stays within its folder, and names one file alone, on every system."""
    for name in names:
        if not all(map(_is_harmless, name.split("/"))):
            raise InputError(
                Message("project.file_name", "not every system takes a file called {name}", name=name), where=path
            )
    if len({name.casefold() for name in names}) != len(names):
        what = Message("project.file_names_alike", "names of files differ in capital letters alone")
        raise InputError(what, where=path)


def _is_harmless(part: str) -> bool:
    """Whether a part of a name stays where it is put."""
    bad = any(sign in ":\\" or ord(sign) < 32 for sign in part)
    return part not in ("", ".", "..", LOCK) and not bad and not _RESERVED.match(part)


def _check_room(wanted: int, to: Path) -> None:
    """InputError if the disk has no room for so many bytes: better said before than after."""
    there = next((one for one in (to.parent, *to.parents) if one.exists()), Path.cwd())
    if wanted > shutil.disk_usage(there).free:
        raise InputError(
            Message("project.no_room", "the project needs {mb:.0f} MB, and the disk has less", mb=wanted / 1e6),
            where=to,
            todo=Message("advice.free_space_or_elsewhere", "free some space, or choose another folder"),
        )


def _take_out(archive: zipfile.ZipFile, name: str, one: _PackedFile, place: Path, path: Path) -> None:
    digest, count = hashlib.sha256(), 0
    with place.open("xb") as target:
        for block in _blocks(archive, name, one.bytes, path):
            digest.update(block)
            count += len(block)
            target.write(block)
    if count != one.bytes or digest.hexdigest() != one.sha256:
        raise InputError(
            Message("project.hash_differs", "{name} is not what it was when it was packed", name=name),
            where=path,
            todo=Message("advice.ask_for_file_again", "ask for the file again"),
        )


def _blocks(archive: zipfile.ZipFile, name: str, most: int, path: Path) -> Iterator[bytes]:
    """A file of the pack, block by block; InputError if it is damaged, or longer than it is said to be."""
    try:
        with archive.open(name) as source:
            left = most
            while block := source.read(_BLOCK):
                left -= len(block)
                if left < 0:
                    raise _damaged(
                        path, Message("project.pack_longer", "{name} is longer than it is said to be", name=name)
                    )
                yield block
    except (zipfile.BadZipFile, zlib.error, EOFError, RuntimeError, ValueError) as error:
        raise _damaged(path, str(error)) from error


def _damaged(path: Path, reason: Message | str) -> InputError:
    return InputError(
        Message("project.no_pack", "this is no whole packed project ({reason})", reason=reason),
        where=path,
        todo=Message("advice.ask_for_file_again", "ask for the file again"),
    )
