"""Fonts for the scripts that the report's own do not have: this computer's, else those a reader's program brings.

A font of this computer is embedded like the report's own, its outlines converted where they are PostScript's. Adobe's
four East Asian ones are only named in the file, so that whether their characters are seen hangs on the program that
shows it. What no font has is printed by code point.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from functools import cache, lru_cache
from pathlib import Path

import matplotlib
from matplotlib import font_manager
from matplotlib.ft2font import FT2Font
from reportlab.pdfbase import pdfmetrics
from reportlab.pdfbase.cidfonts import UnicodeCIDFont
from reportlab.pdfbase.ttfonts import TTFError, TTFont

USUAL = ("Sans CJK SC", "CJK SC", "CJK", "Sans SC", "Sans JP", "Sans KR", "YaHei", "SimSun", "SimHei", "Meiryo",
         "Yu Gothic", "MS Gothic", "Malgun", "Batang", "PingFang", "Hiragino", "SD Gothic", "AppleGothic",
         "WenQuanYi", "Droid Sans Fallback", "IPA", "Takao", "Nanum", "Unicode MS", "Noto Sans", "Segoe UI",
         "Tahoma")  # fmt: skip
"""In the names of fonts of many scripts: looked into before all others."""
REGULAR = (400, "normal", "regular", "book")
"""Weights that a text is set in, as matplotlib names them."""
NO_LETTERS = "Last Resort"
"""A font that has a box for every character."""
_HANGUL, _JAPANESE, _CHINESE = "HYSMyeongJo-Medium", "HeiseiKakuGo-W5", "STSong-Light"


def system_fonts() -> Sequence[tuple[str, str]]:
    """List the upright fonts of this computer as (family, path): common families first, then regular weights."""
    own = str(Path(matplotlib.get_data_path()))
    found = {
        (
            next((at for at, part in enumerate(USUAL) if part in font.name), len(USUAL)),
            font.weight not in REGULAR,
            font.fname,
            font.name,
        )
        for font in font_manager.fontManager.ttflist
        if not font.fname.startswith(own) and NO_LETTERS not in font.name and font.style == "normal"
    }
    paths: dict[str, str] = {}  # of a collection the best of its families
    for _, _, path, name in sorted(found):
        paths.setdefault(path, name)
    return tuple((name, path) for path, name in paths.items())


def truetype(name: str, path: str) -> TTFont:
    """Load a TrueType font for reportlab under `name`, with glyph widths as in the file at `path`.

    reportlab takes the advance that the last glyphs of a font share in thousandths of an em, and writes it as if it
    were in the font's own units: a monospaced font would be embedded with widths that are not its own.
    """
    font = TTFont(name, path)
    (full,) = struct.unpack(">H", font.face.get_table("hhea")[34:36])
    metrics = font.face.hmetrics
    metrics[full:] = [(metrics[full - 1][0], bearing) for _, bearing in metrics[full:]]
    return font


@cache
def drawn_family(character: str) -> str:
    """Find a font family of this computer that has `character`, for matplotlib; "" if there is none.

    A plot is a picture: it takes fonts that may not be embedded as well.
    """
    return next((family for family, _ in _having(character)), "")


@cache
def embedded_font(character: str) -> str:
    """Find a font of this computer that has `character` and may be embedded; return its reportlab name, or ""."""
    for _, path in _having(character):
        name = f"Foreign-{Path(path).stem}"
        if name in pdfmetrics.getRegisteredFontNames():
            return name
        font = _embeddable(name, path)
        if font is not None and ord(character) in font.face.charToGlyph:
            pdfmetrics.registerFont(font)
            return name
    return ""


@cache
def _embeddable(name: str, path: str) -> TTFont | None:
    """A font for reportlab; None where its licence forbids it, which is known once all of it has been read."""
    try:
        return truetype(name, path)
    except (TTFError, OSError, ValueError):
        pass
    from core.report.layout.converted_font import converted_font  # its library is loaded where there is such a font

    try:
        return converted_font(name, path)
    except (TTFError, OSError, ValueError):
        return None


@lru_cache(maxsize=16)
def _opened(path: str) -> FT2Font:
    """One of this computer's fonts; those asked last stay open, as most characters of a text are in the same one."""
    return FT2Font(path)


def _having(character: str) -> Iterator[tuple[str, str]]:
    """Those of this computer's fonts that have it."""
    for family, path in system_fonts():
        try:
            if _opened(path).get_char_index(ord(character)):
                yield family, path
        except (RuntimeError, OSError):
            continue


@cache
def named_font(name: str) -> str:
    """Register one of Adobe's East Asian fonts, which is not embedded in the PDF; return its name."""
    pdfmetrics.registerFont(UnicodeCIDFont(name))
    return name


def east_asian_font(text: str) -> str:
    """Choose the Adobe font (not embedded) that suits the East Asian characters of `text`."""
    if any(0xAC00 <= ord(c) <= 0xD7A3 or 0x1100 <= ord(c) <= 0x11FF for c in text):
        return named_font(_HANGUL)
    if any(0x3040 <= ord(c) <= 0x30FF for c in text):
        return named_font(_JAPANESE)
    return named_font(_CHINESE)


def is_east_asian(character: str) -> bool:
    """Whether one of Adobe's East Asian fonts, which are not embedded, has the character."""
    point = ord(character)
    return (
        0x1100 <= point <= 0x11FF
        or 0x2E80 <= point <= 0x9FFF
        or 0xAC00 <= point <= 0xD7A3
        or (0xF900 <= point <= 0xFAFF or 0xFF00 <= point <= 0xFFEF)
    )
