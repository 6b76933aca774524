"""Films: their frames as pictures, each as it is decoded, with its number and time. One that ends early is refused.

AVI, MP4, MOV and MKV are decoded by the FFmpeg that comes with OpenCV, in 8 bits; moving GIF, PNG and WebP by Pillow.
Frames are not turned, whatever a telephone says of how it was held: calibration and scan are to see the same pixels.

References
----------
AVI RIFF File Reference (Microsoft, 1992). ISO/IEC 14496-12 (2022), 4.2: boxes. RFC 8794 (2020), 4 to 6: EBML.
"""

from __future__ import annotations

import struct
import warnings
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import count, pairwise
from pathlib import Path
from typing import BinaryIO

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from core.errors import InputError
from core.files.compression import FilmLoss, with_film_loss
from core.files.jpeg import START, components_of
from core.files.limits import FILM_BYTES, FILM_FRAMES, FILM_PIXELS, FILM_SIDE_PX, check_file, check_pixels
from core.files.pictures import encode_png
from core.files.reading import cannot_read, resolved
from core.image.background import sample_indices
from core.image.repeated import pixels_of
from core.messages import Message
from core.progress import Progress, silent

FILMS = frozenset({".avi", ".mp4", ".m4v", ".mov", ".mkv", ".webm", ".gif", ".apng"})
"""Endings (lower case) of the files that are films by their names."""
PERHAPS_MOVING = frozenset({".png", ".webp"})
"""Endings (lower case) of pictures, some of which hold several frames."""
_MISSING_AT_MOST = 2
"""Frames fewer than a film says it has that are no damage: some programs count one that is never shown."""
_SOUND_LONGER_S = 1.0
"""By so much a sound track may go on beyond the last frame: a duration of the whole film then says too many frames. A
film that was cut without coding it anew keeps about as much before its beginning that is never shown."""
_ENCODED_EVERY = 32
"""One of so many frames tells how large all are as PNG."""
_LOSSLESS = frozenset({"FFV1", "HFYU", "FFVH", "MPNG", "PNG"})
"""Names of codings that keep every grey value."""
_JPEG, _JPEG_WITHIN = frozenset({"MJPG", "JPEG"}), 1 << 22
"""Names of codings that are a JPEG for each frame, and the bytes of a film within which the first one is."""
_ASSUMED = FilmLoss(((20.0, 1.0), (20.0, 2.0), (20.0, 2.0)), assumed=True)
"""Of a coding that does not tell: steps of 20 grey levels, as of H.264 at a QP of 30, and colours in half the pixels
both ways. Lines in MPEG-4, VP8 and VP9 of 1 to 18 Mbit/s (960 × 540, 30 frames a second) are off by 0.15 to 0.53 times
the σ this gives; tests/files/test_film_loss.py."""

_DAMAGED = (OSError, SyntaxError, ValueError, EOFError, IndexError, struct.error, Image.DecompressionBombError)
"""What Pillow raises for damaged files."""

_RECORD_ANEW = Message("film.advice_copy", "copy it again, or record it anew")

Picture = NDArray[np.uint8]
_Shown = tuple[float | None, Picture]
"""Time in s, if it is known, and picture (H, W, 3) in OpenCV's order."""


@dataclass(frozen=True, slots=True)
class FilmFrame:
    """Frame of a film: its number from 0, as the film counts, and its time in s; None where the film has no times."""

    number: int
    time_s: float | None


@dataclass(frozen=True, slots=True)
class Film:
    """Film that was read from its first frame to its last.

    `size` is its width and height in px; `frames` are those that are no copy of the one before: `doubled` were.
    `missing` are how many fewer it has than its duration says; 0 if it lists its frames.
    `coding` is its name, `loss` what that has lost; None if nothing. A film is `grey` if no frame has colours.
    `png_bytes` is about the room that the frames take.
    """

    path: Path
    size: tuple[int, int]
    frames: tuple[FilmFrame, ...]
    doubled: int
    coding: str
    loss: FilmLoss | None
    grey: bool
    png_bytes: int
    missing: int = 0


def is_film(path: Path) -> bool:
    """Whether a file is a film by its name, or a PNG or WebP that holds several frames."""
    ending = path.suffix.lower()
    if path.name.startswith(".") or ending not in PERHAPS_MOVING:
        return ending in FILMS and not path.name.startswith(".")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # one of damaged parts is a picture
            with Image.open(path, formats=("PNG", "WEBP")) as film:
                return bool(getattr(film, "is_animated", False))
    except _DAMAGED:
        return False


def read_film(path: Path, progress: Progress = silent) -> tuple[Film, list[Picture]]:
    """Read a film through; return what it is, and a sample of its pictures (H, W, 3) in OpenCV's order of colours.

    Raises
    ------
    InputError
        If it is no film, has no frames or too many, ends early, or is of a coding that cannot be read.
    """
    opened = _opened(path)
    wanted = set(sample_indices(opened.told))
    frames, sample, encoded = list[FilmFrame](), list[Picture](), list[int]()
    size, grey, read, before = (0, 0), True, 0, b""
    for number, (time_s, picture) in enumerate(opened.shown):
        if max(number + 1, opened.told) > FILM_FRAMES:
            raise InputError(
                Message("film.too_long", "the film has more than {most:,} frames", most=FILM_FRAMES),
                where=path,
                todo=Message("film.advice_cut", "cut it to what belongs to the measurement"),
            )
        progress("reading the film", number, max(opened.told, number))
        read, size = number + 1, _same_size(path, size, picture)
        pixels = pixels_of(picture)
        if pixels and pixels == before:
            continue
        before, grey = pixels, grey and _is_grey(picture)
        if len(frames) % _ENCODED_EVERY == 0:
            encoded.append(len(encode_png(picture)))
        frames.append(FilmFrame(number, time_s))
        if number in wanted:
            sample.append(picture)
    _require_whole(path, opened, read)
    if not _rising([frame.time_s for frame in frames]):
        frames = [replace(frame, time_s=None) for frame in frames]
    loss = _palette_loss(sample) if opened.coding == "GIF" else opened.loss
    room = int(np.mean(encoded) * len(frames))
    missing = opened.told - read if read < opened.told - _MISSING_AT_MOST else 0
    return Film(path, size, tuple(frames), read - len(frames), opened.coding, loss, grey, room, missing), sample


def film_pictures(film: Film) -> Iterator[tuple[FilmFrame, Picture]]:
    """Yield the frames of a film with their pictures: (H, W) of a grey film, else (H, W, 3) in OpenCV's order.

    Raises
    ------
    InputError
        As `read_film`: it may have changed since.
    """
    left = list(reversed(film.frames))
    opened = _opened(film.path)
    for number, (_, picture) in enumerate(opened.shown):
        if left and number == left[-1].number:
            _same_size(film.path, film.size, picture)
            yield left.pop(), np.ascontiguousarray(picture[:, :, 0]) if film.grey else picture
    if left:
        raise _ends_early(film.path, len(film.frames) - len(left), len(film.frames))


def film_png(picture: Picture, film: Film) -> bytes:
    """Encode a picture of a film as PNG, without further loss, with a word on what the film's coding has lost."""
    png = bytes(encode_png(picture))
    return png if film.loss is None else with_film_loss(png, film.loss)


def film_picture(path: Path, number: int) -> Picture:
    """Read one frame (H, W, 3) of a film by its number from 0, in OpenCV's order of colours, without those before it.

    For looking at: of films whose list of frames is not in order it may be a neighbour.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    for _, picture in _opened(path, number).shown:
        return picture
    raise _ends_early(path, number, 0)


@dataclass(frozen=True, slots=True)
class _Opened:
    """A film as its decoder gives it, and how many frames it says it has; 0 if it does not say.

    `at_most_missing` of them may be missing from a whole film.
    """

    told: int
    coding: str
    loss: FilmLoss | None
    shown: Iterator[_Shown]
    at_most_missing: int = _MISSING_AT_MOST


def _opened(path: Path, first: int = 0) -> _Opened:
    """Open a film at its frame `first`; what is inside decides on the decoder, so that none gets anything but films."""
    check_file(path, FILM_BYTES)
    try:
        with path.open("rb") as file:
            head = file.read(16)
    except OSError as error:
        raise cannot_read(path, error) from error
    if head.startswith((b"GIF8", b"\x89PNG")) or (head.startswith(b"RIFF") and head[8:12] == b"WEBP"):
        return _by_pillow(path, first)
    if head.startswith(b"RIFF") and head[8:12] == b"AVI ":
        return _by_ffmpeg(path, first, counted=True)
    if head.startswith(_EBML) or head[4:8] in _FIRST_BOXES:
        return _by_ffmpeg(path, first, counted=False)
    raise _unreadable(path)


def _by_ffmpeg(path: Path, first: int, *, counted: bool) -> _Opened:
    """By OpenCV, whose number of frames is that of the film's list, or its duration times its rate if not `counted`."""
    capture = cv2.VideoCapture(str(resolved(path)), cv2.CAP_FFMPEG)
    if not capture.isOpened():
        raise _ends_early(path, 0, 0) if _is_cut(path) else _unreadable(path)
    capture.set(cv2.CAP_PROP_ORIENTATION_AUTO, 0)
    width, height = (int(capture.get(side)) for side in (cv2.CAP_PROP_FRAME_WIDTH, cv2.CAP_PROP_FRAME_HEIGHT))
    _check_size(width, height, path)
    told, code = int(capture.get(cv2.CAP_PROP_FRAME_COUNT)), int(capture.get(cv2.CAP_PROP_FOURCC))
    coding = code.to_bytes(4, "little", signed=True).decode("latin-1").strip("\0 ").upper()

    def shown() -> Iterator[_Shown]:
        try:
            if first:
                capture.set(cv2.CAP_PROP_POS_FRAMES, first)
            while True:
                read, picture = capture.read()
                if not read:
                    return
                yield capture.get(cv2.CAP_PROP_POS_MSEC) / 1000, np.asarray(picture, np.uint8)
        finally:
            capture.release()

    spare = 0 if counted else int(_SOUND_LONGER_S * max(capture.get(cv2.CAP_PROP_FPS), 0.0))
    return _Opened(max(told, 0), coding, _loss_of(path, coding), shown(), max(spare, _MISSING_AT_MOST))


def _by_pillow(path: Path, first: int) -> _Opened:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of sizes, which are checked below, and of what it goes on without
            film = Image.open(path, formats=("GIF", "PNG", "WEBP"))
    except _DAMAGED as error:
        raise (_ends_early(path, 0, 0) if _is_cut(path) else _unreadable(path)) from error
    coding, told = film.format or "", 0
    with suppress(*_DAMAGED):  # told when it is read
        told = int(getattr(film, "n_frames", 1))

    def shown() -> Iterator[_Shown]:
        time_ms = 0.0
        with film:
            _check_size(*film.size, path)
            for number in count(first):
                try:
                    film.seek(number)
                except EOFError:
                    return
                except _DAMAGED as error:
                    raise _ends_early(path, number, told) from error
                try:
                    picture = np.asarray(film.convert("RGB"), np.uint8)
                except _DAMAGED as error:
                    raise _ends_early(path, number, told) from error
                yield time_ms / 1000, np.ascontiguousarray(picture[:, :, ::-1])
                time_ms += float(film.info.get("duration") or 0)

    lossy = coding == "WEBP" and _contains(path, b"VP8 ")
    return _Opened(told, coding, _ASSUMED if lossy else None, shown())


def _check_size(width: int, height: int, path: Path) -> None:
    """InputError if a film declares frames larger than any camera's."""
    check_pixels(width, height, path, FILM_PIXELS)
    if max(width, height) > FILM_SIDE_PX:
        raise InputError(
            Message(
                "film.side_too_long",
                "the film's frames are said to have {width} × {height} pixels, and at most {most:,} a side are read",
                width=width,
                height=height,
                most=FILM_SIDE_PX,
            ),
            where=path,
            todo=_RECORD_ANEW,
        )


def _same_size(path: Path, size: tuple[int, int], picture: Picture) -> tuple[int, int]:
    """The size of a picture, which is to be that of those before; (0, 0) for the first one."""
    own = (picture.shape[1], picture.shape[0])
    if size not in ((0, 0), own):
        raise InputError(
            Message("film.size_changes", "the film's frames change their size"), where=path, todo=_RECORD_ANEW
        )
    return own


def _is_grey(picture: Picture) -> bool:
    return all(np.array_equal(picture[:, :, 0], picture[:, :, channel]) for channel in (1, 2))


def _rising(times: Sequence[float | None]) -> bool:
    """Whether all times are known, each later than the one before."""
    known = [time for time in times if time is not None]
    return len(known) == len(times) and all(later > earlier for earlier, later in pairwise(known))


def _require_whole(path: Path, opened: _Opened, read: int) -> None:
    """InputError if a film that was read to its end is not whole."""
    if read < opened.told - opened.at_most_missing or _is_cut(path):
        raise _ends_early(path, min(read, opened.told - 1) if opened.told else read, opened.told)
    if not read:
        raise InputError(
            Message("film.empty", "the film has no frames that can be read"), where=path, todo=_RECORD_ANEW
        )


def _ends_early(path: Path, read: int, told: int) -> InputError:
    what = (
        Message(
            "film.ends_early_of",
            "the film ends early or is damaged: {read} of its {told} frames can be read",
            read=read,
            told=told,
        )
        if told
        else Message("film.ends_early", "the film ends early or is damaged: {read} frames can be read", read=read)
    )
    return InputError(what, where=path, todo=_RECORD_ANEW)


def _unreadable(path: Path) -> InputError:
    return InputError(
        Message("film.unreadable", "this is no film, or one of a coding that is not read"),
        where=path,
        todo=Message("film.advice_convert", "convert it to AVI with the coding FFV1, or to png picture by picture"),
    )


def _loss_of(path: Path, coding: str) -> FilmLoss | None:
    """What a coding has lost: by the tables of its first JPEG, if that is what it is made of."""
    if coding in _LOSSLESS:
        return None
    if coding in _JPEG:
        try:
            with path.open("rb") as file:
                data = file.read(_JPEG_WITHIN)
        except OSError as error:
            raise cannot_read(path, error) from error
        at = data.find(START + b"\xff")
        components = components_of(data[at:]) if at >= 0 else ()
        if any(step for step, _ in components):
            return FilmLoss(components)
    return _ASSUMED


def _palette_loss(sample: Sequence[Picture]) -> FilmLoss | None:
    """What 256 colours have lost: each colour stands for what is nearer to it than to another one that is used."""
    squares = list[float]()
    for picture in sample:
        flat = picture.reshape(-1, 3).astype(np.int32)
        colours = np.unique(flat @ np.array([1, 1 << 8, 1 << 16]))
        colours = np.stack([colours & 255, colours >> 8 & 255, colours >> 16], axis=1)[:: 1 + len(colours) // 1024]
        apart = np.abs(colours[:, None] - colours).max(axis=2)
        np.fill_diagonal(apart, 256)
        if len(colours) > 1:
            squares.append(float(np.mean(apart.min(axis=1).astype(np.float64) ** 2)))
    step = float(np.sqrt(np.mean(squares))) if squares else 0.0
    return FilmLoss(((step, 1.0),)) if step > 1 else None


def _contains(path: Path, mark: bytes) -> bool:
    """Whether a file holds a mark; it is looked through piece by piece."""
    before = b""
    try:
        with path.open("rb") as file:
            while piece := file.read(1 << 20):
                if mark in before + piece:
                    return True
                before = piece[-len(mark) :]
    except OSError as error:
        raise cannot_read(path, error) from error
    return False


_FIRST_BOXES = (b"ftyp", b"moov", b"mdat", b"wide", b"free", b"skip", b"pnot")
_EBML, _SEGMENT = b"\x1a\x45\xdf\xa3", b"\x18\x53\x80\x67"


def _is_cut(path: Path) -> bool:
    """Whether a film is shorter than its head says, or its end mark is missing."""
    try:
        size = path.stat().st_size
        with path.open("rb") as file:
            head = file.read(12)
            if head.startswith(b"GIF8"):
                file.seek(max(0, size - 1024))
                return not file.read().rstrip(b"\0").endswith(b";")
            if head.startswith(b"RIFF"):
                return _cut_pieces(file, size)
            if head.startswith(_EBML):
                return _cut_segment(file, size)
            return head[4:8] in _FIRST_BOXES and _cut_boxes(file, size)
    except OSError as error:
        raise cannot_read(path, error) from error


def _cut_pieces(file: BinaryIO, size: int) -> bool:
    """Of AVI and WebP: pieces called RIFF, each with its length; 0 if it was not closed."""
    at = 0
    while at + 8 <= size:
        file.seek(at)
        name, length = struct.unpack("<4sI", file.read(8))
        if name != b"RIFF":
            break
        at += 8 + length + length % 2
        if not length or at - length % 2 > size:
            return True
    return at == 0


def _cut_boxes(file: BinaryIO, size: int) -> bool:
    """Of MP4 and MOV: boxes to the end, one of them with the list of the frames."""
    at, listed = 0, False
    while at + 8 <= size:
        file.seek(at)
        length, name = struct.unpack(">I4s", file.read(8))
        if length == 1:
            length = int.from_bytes(file.read(8), "big")
        listed = listed or name == b"moov"
        if length == 0:  # to the end
            return not listed
        if length < 8:
            return True
        at += length
    return at > size or not listed


def _cut_segment(file: BinaryIO, size: int) -> bool:
    """Of MKV: a head, then one segment with all frames, whose length may be left open."""
    file.seek(len(_EBML))
    length, _ = _length(file)
    file.seek(length, 1)
    if file.read(len(_SEGMENT)) != _SEGMENT:
        return True
    length, is_open = _length(file)
    return not is_open and file.tell() + length > size


def _length(file: BinaryIO) -> tuple[int, bool]:
    """The length of an EBML element, and whether it is left open: all its bits are set."""
    first = file.read(1) or b"\0"
    more = 8 - first[0].bit_length()
    bits = 7 * (more + 1)
    value = int.from_bytes(first + file.read(more), "big") & ((1 << bits) - 1)
    return value, value == (1 << bits) - 1
