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
import tomllib
from pathlib import Path
from typing import Annotated

from PIL import Image
from pydantic import Field, ValidationError

from core.errors import InputError
from core.files.complaints import complaint
from core.files.pictures import read_bytes
from core.files.rig_tables import Table
from core.report.section_names import SECTIONS
from core.report.template import LANGUAGES, PAPERS, Language, Paper, ReportTemplate

_LARGEST_LOGO = 4_000_000
"""Bytes of a logo: it is in every report."""


class _Template(Table):
    name: str = ""
    address: list[str] = Field(default_factory=list, description="a list of lines")
    logo: str = ""
    accent: Annotated[str, Field(pattern=r"^#[0-9A-Fa-f]{6}$")] = Field("#14586E", description='a colour as "#14586E"')
    footer: str = ""
    text: str = ""
    signatures: list[str] = Field(default_factory=list, max_length=6, description="a list of at most 6 names")
    without: list[str] = Field(default_factory=list, description="a list of names of sections")
    paper: Paper | None = Field(None, description=" or ".join(f'"{one}"' for one in PAPERS))
    language: Language | None = Field(None, description=" or ".join(f'"{one}"' for one in LANGUAGES))


def read_report_template(path: Path) -> ReportTemplate:
    """Read a template and its logo.

    Raises
    ------
    InputError
        If it is missing or no TOML, a key is unknown or wrong, there is no such section, or the logo is no picture.
    """
    try:
        tables = tomllib.loads(read_bytes(path).decode("utf-8"))
        file = _Template.model_validate(tables)
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"this is no valid TOML: {error}", where=path) from error
    except ValidationError as error:
        raise complaint(path, error, _Template) from error
    return ReportTemplate(
        name=file.name,
        address=tuple(file.address),
        logo=_logo(path.parent / file.logo) if file.logo else b"",
        accent=file.accent,
        footer=file.footer,
        text=file.text,
        signatures=tuple(file.signatures),
        without=section_set(file.without, where=f"{path}: without"),
        paper=file.paper,
        language=file.language,
    )


def section_set(names: list[str], *, where: str) -> frozenset[str]:
    """Names of sections to be left out; InputError if there is no such section."""
    for name in names:
        if name not in SECTIONS:
            raise InputError(f'there is no section "{name}" to leave out', where=where,
                             todo=f"choose among {', '.join(SECTIONS)}")  # fmt: skip
    return frozenset(names)


def _logo(path: Path) -> bytes:
    """The bytes of a logo, after it has proved to be a picture that the report can print."""
    data = read_bytes(path)
    if len(data) > _LARGEST_LOGO:
        raise InputError(f"the logo has {len(data) / 1e6:.1f} MB", where=path, todo="make it smaller than 4 MB")
    try:
        with Image.open(io.BytesIO(data), formats=("PNG", "JPEG")) as picture:
            picture.load()
    except (OSError, ValueError, Image.DecompressionBombError) as error:
        raise InputError("the logo is no PNG or JPEG picture that can be read", where=path) from error
    return data
