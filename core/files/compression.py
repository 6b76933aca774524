"""How far compression leaves grey values off: by a JPEG's own tables, or by what a frame says of the film it is from.

A frame taken from a film is a PNG; what the film's coding had lost before goes with it, in a chunk of its own.

References
----------
PNG 3 (W3C, 2025), 5.3 (chunks) and 11.3.3.2 (tEXt).
"""

from __future__ import annotations

import json
import math
import zlib
from dataclasses import dataclass

from core.acquire.channel import Channel
from core.files import jpeg
from core.image.stripes.noise import UNCOMPRESSED, Compression

PNG = b"\x89PNG\r\n\x1a\n"
_HEAD_END = len(PNG) + 25
"""Where the first chunk of a PNG, IHDR, ends."""
_TEXT, _KEYWORD = b"tEXt", b"Film compression\0"


@dataclass(frozen=True, slots=True)
class FilmLoss:
    """Loss by a film's coding: what its `components` are rounded to, as `jpeg.components_of` tells it of a JPEG.

    `assumed` where the film does not tell.
    """

    components: tuple[jpeg.Component, ...]
    assumed: bool = False

    def __post_init__(self) -> None:
        if not all(0 <= value < math.inf for one in self.components for value in one):
            raise ValueError(f"{self.components} are not zero or positive")


def compression_of(data: bytes, channel: Channel | None = None) -> Compression:
    """Estimate the errors that compression makes in a channel of a picture, from the head of its file's bytes.

    None for files that do not tell of any: PNG, TIFF, BMP, PGM. `data` may end behind the tables.
    """
    if data.startswith(jpeg.START):
        return jpeg.compression_by(jpeg.components_of(data), channel)
    loss = _film_loss(data)
    return UNCOMPRESSED if loss is None else jpeg.compression_by(loss.components, channel, assumed=loss.assumed)


def with_film_loss(png: bytes, loss: FilmLoss) -> bytes:
    """Put into the bytes of a PNG what the film that it is a frame of had lost."""
    told = {"components": loss.components, "assumed": loss.assumed}
    body = _TEXT + _KEYWORD + json.dumps(told).encode("ascii")
    chunk = (len(body) - len(_TEXT)).to_bytes(4, "big") + body + zlib.crc32(body).to_bytes(4, "big")
    return png[:_HEAD_END] + chunk + png[_HEAD_END:]


def _film_loss(data: bytes) -> FilmLoss | None:
    """What a frame says of its film; None of other pictures, or if it is damaged: decoding it tells that."""
    begin = _HEAD_END + 8
    if not data.startswith(PNG) or data[begin - 4 : begin + len(_KEYWORD)] != _TEXT + _KEYWORD:
        return None
    text = data[begin + len(_KEYWORD) : begin + int.from_bytes(data[begin - 8 : begin - 4], "big")]
    try:
        told = json.loads(text)
        components = tuple((float(step), float(coarser)) for step, coarser in told["components"])
        return FilmLoss(components, bool(told["assumed"]))
    except (ValueError, TypeError, KeyError, RecursionError):
        return None
