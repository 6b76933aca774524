"""A company's template of reports: a TOML file, and its logo beside it.

::

    name = "Werkzeugbau Süd GmbH"
    address = ["Messraum 2", "Industriestraße 5", "70565 Stuttgart"]
    logo = "logo.png"                  # beside this file; PNG or JPEG
    accent = "#14586E"                 # of headings, marks and lines
    footer = "Amtsgericht Stuttgart HRB 12345 · www.example.com"
    text = "Results refer to the item measured only."
    signatures = ["Measured by: M. Jørgensen", "Approved by: Dr. A. Brandt"]
    without = ["frame", "inputs"]      # sections left out
    paper = "A4"                       # or "Letter"
    language = "de"                    # or "en"

All keys may be left out; an unknown one is refused by name.
"""

from __future__ import annotations

import io
from pathlib import Path
from typing import Annotated

from PIL import Image
from pydantic import Field

from core.errors import InputError
from core.files.complaints import checked
from core.files.limits import check_pixels
from core.files.picture_size import declared_sizes
from core.files.reading import read_bytes, read_toml, resolved
from core.files.recording.rig import Table
from core.messages import Message
from core.report.template import LANGUAGES, PAPERS, Paper, ReportTemplate, sections

_LARGEST_LOGO = 4_000_000
"""Bytes of a logo: it is in every report."""
_LOGO_PIXELS = 20_000_000
"""Largest logo in pixels: it is a few centimetres wide on paper, and more would only need memory."""


_Line = Annotated[str, Field(max_length=200)]


class _Template(Table):
    name: _Line = Field("", description="a text of at most 200 characters")
    address: list[_Line] = Field(
        default_factory=list, max_length=10, description="a list of at most 10 lines of at most 200 characters"
    )
    country: Annotated[str, Field(pattern="^([A-Z]{2})?$")] = Field(
        "", description='two letters of ISO 3166-1, as "DE"'
    )
    logo: str = ""
    accent: Annotated[str, Field(pattern=r"^#[0-9A-Fa-f]{6}$")] = Field("#14586E", description='a colour as "#14586E"')
    footer: str = Field("", max_length=500, description="a text of at most 500 characters")
    text: str = Field("", max_length=5000, description="a text of at most 5000 characters")
    signatures: list[_Line] = Field(
        default_factory=list, max_length=6, description="a list of at most 6 names of at most 200 characters"
    )
    without: list[str] = Field(default_factory=list, description="a list of names of sections")
    paper: Paper | None = Field(None, description=" or ".join(f'"{one}"' for one in PAPERS))
    language: str | None = Field(
        None, pattern=f"^({'|'.join(LANGUAGES)})$", description=" or ".join(f'"{one}"' for one in LANGUAGES)
    )


def read_report_template(path: Path) -> ReportTemplate:
    """Read and check a report template (TOML) and its logo; InputError if one is missing or wrong.

    Raises
    ------
    InputError
        If it is missing or no TOML, a key is unknown or wrong, there is no such section, or the logo is no picture.
    """
    file = checked(_Template, read_toml(path), path)
    return ReportTemplate(
        name=file.name,
        address=tuple(file.address),
        country=file.country,
        logo=_logo(path.parent / file.logo) if file.logo else b"",
        accent=file.accent,
        footer=file.footer,
        text=file.text,
        signatures=tuple(file.signatures),
        without=section_set(file.without, where=f"{path}: without"),
        paper=file.paper,
        language=file.language,
    )


def logo_beside(path: Path) -> Path | None:
    """Find the logo of the report template in `path`, beside or below it; None if it has none there."""
    logo = resolved(path.parent / checked(_Template, read_toml(path), path).logo)
    return logo if logo.is_file() and logo.is_relative_to(resolved(path.parent)) else None


def section_set(names: list[str], *, where: str) -> frozenset[str]:
    """Return the `names` of a report's sections as a set; InputError, naming `where`, if there is no such section."""
    for name in names:
        if name not in sections():
            raise InputError(
                Message("project.no_such_section", 'there is no section "{name}" to leave out', name=name),
                where=where,
                todo=Message("advice.choose_among", "choose among {choices}", choices=tuple(sections())),
            )
    return frozenset(names)


def _logo(path: Path) -> bytes:
    """The bytes of a logo, after it has proved to be a picture that the report can print."""
    data = read_bytes(path)
    if len(data) > _LARGEST_LOGO:
        raise InputError(
            Message("project.logo_too_large", "the logo has {data:.1f} MB", data=len(data) / 1e6),
            where=path,
            todo=Message("advice.make_logo_smaller", "make it smaller than 4 MB"),
        )
    for width, height in declared_sizes(data):
        check_pixels(width, height, path, _LOGO_PIXELS)
    try:
        with Image.open(io.BytesIO(data), formats=("PNG", "JPEG")) as picture:
            picture.load()
    except (OSError, ValueError, Image.DecompressionBombError) as error:
        raise InputError(
            Message("project.logo_unreadable", "the logo is no PNG or JPEG picture that can be read"), where=path
        ) from error
    return data
