"""Fonts with PostScript outlines, as most of East Asia's are, for reportlab, which embeds TrueType outlines alone.

Only the characters that are written are converted, as the file is put together: cubic curves become quadratic ones that
lie within a thousandth of an em of them. The metrics stay.
"""

from __future__ import annotations

import io
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from fontTools.fontBuilder import FontBuilder
from fontTools.pens.cu2quPen import Cu2QuPen
from fontTools.pens.ttGlyphPen import TTGlyphPen
from fontTools.ttLib import TTCollection, TTFont, TTLibError
from reportlab.pdfbase import ttfonts

OFF_BY_EM = 0.001
"""A converted curve lies so near to its own, in ems: a hundredth of a point in a title."""
CHINESE = " SC"
"""In the names of a collection's face with China's characters, which are taken where there are several."""


RESTRICTED, NO_SUBSET = 0x0002, 0x0300
"""A font's licence bits: not to be embedded; only whole, or only its bitmaps."""


def converted_font(name: str, path: str) -> ttfonts.TTFont:
    """Convert the font file at `path`, with PostScript outlines, to a TrueType font for reportlab called `name`.

    Raises
    ------
    ValueError
        If the file has no PostScript outlines, cannot be read, or its licence does not let it be embedded.
    """
    try:
        source = _face(path)
        characters: Mapping[int, str] = source.getBestCmap() or {}
        advances, scale = source["hmtx"].metrics, 1000 / source["head"].unitsPerEm
        font = ttfonts.TTFont(name, io.BytesIO(_truetype(source, characters, ())))
    except (TTLibError, KeyError, AttributeError, IndexError) as error:
        raise ValueError(f"{path} cannot be converted: {error}") from error
    font.face.charToGlyph = dict.fromkeys(characters, 0)  # asked only whether it has one
    font.face.charWidths = {code: scale * advances[glyph][0] for code, glyph in characters.items()}
    font.face.makeSubset = lambda codes: _subset(source, characters, codes)
    return font


def _subset(source: TTFont, characters: Mapping[int, str], codes: list[int]) -> bytes:
    """A TrueType font of these characters, as reportlab makes it of one that has no others."""
    face = ttfonts.TTFont("subset", io.BytesIO(_truetype(source, characters, codes))).face
    made: bytes = face.makeSubset(codes)
    return made


def _face(path: str) -> TTFont:
    """The file's font, of a collection China's or else the first; ValueError if its outlines are not PostScript."""
    data = Path(path).read_bytes()
    several, file = data[:4] == b"ttcf", io.BytesIO(data)
    fonts = TTCollection(file, lazy=True).fonts if several else [TTFont(file, lazy=True)]
    font = next((one for one in fonts if CHINESE in str(one["name"].getDebugName(1))), fonts[0])
    if "CFF " not in font:
        raise ValueError(f"{path} has no PostScript outlines")
    if font["OS/2"].fsType == RESTRICTED or font["OS/2"].fsType & NO_SUBSET:
        raise ValueError(f"{path} may not be embedded in part")  # reportlab asks that of fonts of 256 glyphs and more
    return font


def _truetype(source: TTFont, characters: Mapping[int, str], codes: Iterable[int]) -> bytes:
    """A TrueType font of the characters among `codes` that the source has; the same bytes whenever it is made."""
    outlines, metrics = source.getGlyphSet(), source["hmtx"].metrics
    mapped = {code: characters[code] for code in sorted(set(codes)) if code in characters}
    missing = source.getGlyphOrder()[0]
    glyphs = list(dict.fromkeys([missing, *mapped.values()]))
    builder = FontBuilder(source["head"].unitsPerEm, isTTF=True)
    builder.updateHead(created=source["head"].created, modified=source["head"].modified)  # else the time of day
    builder.setupGlyphOrder(glyphs)
    builder.setupCharacterMap(mapped)
    builder.setupGlyf({glyph: _converted(outlines[glyph], source["head"].unitsPerEm) for glyph in glyphs})
    shapes = builder.font["glyf"]
    builder.setupHorizontalMetrics({one: (metrics[one][0], getattr(shapes[one], "xMin", 0)) for one in glyphs})
    builder.setupHorizontalHeader(ascent=source["hhea"].ascent, descent=source["hhea"].descent)
    names = {key: str(source["name"].getDebugName(number) or "") for key, number in _NAMES.items()}
    builder.setupNameTable(names, mac=False)
    old = source["OS/2"]
    kept: dict[str, Any] = {key: getattr(old, key) for key in _KEPT if hasattr(old, key)}
    builder.setupOS2(**kept)
    builder.setupPost(keepGlyphNames=False)
    stream = io.BytesIO()
    builder.save(stream)
    return stream.getvalue()


_NAMES = {"familyName": 1, "styleName": 2, "uniqueFontIdentifier": 3, "fullName": 4, "psName": 6}
_KEPT = ("fsType", "usWeightClass", "sTypoAscender", "sTypoDescender", "sCapHeight", "sxHeight")


def _converted(outline: Any, units: int) -> Any:
    pen = TTGlyphPen(None)
    outline.draw(Cu2QuPen(pen, OFF_BY_EM * units, reverse_direction=True))
    return pen.glyph()
