"""Films of a hand-held laser's sweep for tests: frames, and files of every kind that can be read."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image

Picture = NDArray[np.uint8]


def sweep(count: int = 12, *, size: tuple[int, int] = (96, 64), colour: int = 2, seed: int = 5) -> list[Picture]:
    """Pictures (H, W, 3) of a room with noise, and of a line that moves through it in one of their colours."""
    rng, (width, height) = np.random.default_rng(seed), size
    room = rng.integers(40, 70, (height, width, 1)) + np.zeros(3)
    u, pictures = np.arange(width), []
    for number in range(count):
        picture = room + rng.normal(0, 1.5, room.shape)
        at = (number + 0.5) * width / count
        picture[:, :, colour] += 120 * np.exp(-((u - at) ** 2) / (2 * 1.5**2))
        pictures.append(np.clip(np.rint(picture), 0, 255).astype(np.uint8))
    return pictures


def write_film(path: Path, pictures: Sequence[Picture], coding: str = "FFV1", rate: float = 10.0) -> Path:
    """Write pictures as a film by FFmpeg, in a coding by its four letters, or by Pillow where none are named."""
    if not coding:
        first, *others = (Image.fromarray(np.ascontiguousarray(one[:, :, ::-1])) for one in pictures)
        first.save(path, save_all=True, append_images=others, duration=round(1000 / rate))
        return path
    height, width = pictures[0].shape[:2]
    film = cv2.VideoWriter(str(path), cv2.CAP_FFMPEG, cv2.VideoWriter.fourcc(*coding), rate, (width, height))
    assert film.isOpened(), coding
    for picture in pictures:
        film.write(picture)
    film.release()
    return path


def say_longer(path: Path, more_s: float) -> Path:
    """Make an MKV say that it is longer by `more_s` than its frames are, as one with a longer sound track does."""
    data = path.read_bytes()
    at = data.index(b"\x44\x89\x88") + 3  # Duration, 8 bytes: RFC 9559
    (length_ms,) = struct.unpack_from(">d", data, at)
    path.write_bytes(data[:at] + struct.pack(">d", length_ms + 1000 * more_s) + data[at + 8 :])
    return path
