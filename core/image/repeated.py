"""Pictures that are others again: a camera or a film that repeats frames, and files copied under another name.

The noise of two exposures always differs, so pictures that are equal in every pixel are one exposure. Measured twice,
it would be taken for two independent observations.
"""

from __future__ import annotations

import hashlib
import zlib
from typing import Any

from numpy.typing import NDArray

_ROWS = 8
"""Every so many rows the noise is hashed safely; of the rest a checksum is enough, which takes a fifth of the time."""


def pixels_of(picture: NDArray[Any]) -> bytes:
    """Compute a hash of a picture's pixels, by which equal pictures are known; b"" if all its pixels are equal.

    One without noise, as an all black one, has nothing to know it by.
    """
    rows = picture[::_ROWS]
    if rows.min() == rows.max() and picture.min() == picture.max():
        return b""
    known = hashlib.blake2b(rows.tobytes(), digest_size=16, person=f"{picture.dtype}".encode())
    known.update(repr(picture.shape).encode())
    return known.digest() + zlib.crc32(picture.tobytes()).to_bytes(4, "big")


class Repeats:
    """Detector of pictures that repeat earlier ones."""

    def __init__(self) -> None:
        self._seen: set[bytes] = set()

    def is_repeat(self, *pixels: bytes) -> bool:
        """Whether one of these hashes of `pixels`, but for b"", was given in an earlier call; remembers all."""
        known = {one for one in pixels if one}
        repeated = not self._seen.isdisjoint(known)
        self._seen |= known
        return repeated
