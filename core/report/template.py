"""What may be chosen about a report: paper, language, sections, and how a company's reports look."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal, TypeAlias

from core.messages import label
from core.translations import languages
from core.wing import wings

Paper: TypeAlias = Literal["A4", "Letter"]
"""What a report is printed on."""

LANGUAGES = languages()
"""The languages a report can be in, by their names."""

PAPERS: tuple[Paper, ...] = ("A4", "Letter")


SECTIONS: Mapping[str, str] = MappingProxyType(
    {
        "surface": label("Measured surface"),
        "view": label("The surface as it was left in 3D"),
        "frame": label("One frame of the scan"),
        "profiles": label("Light profiles"),
        "sections": label("Cross-sections"),
        "points": label("Points the results rest on"),
        "maps": label("Residuals of both faces, or depth and σ of the cloud"),
        "deviation": label("Deviation from the nominal surface"),
        "budget": label("Uncertainty budget"),
        "repeats": label("Repeated scans"),
        "studies": label("Studies"),
        "artefacts": label("Checks by known artefacts"),
        "calibrations": label("Calibrations and rig"),
        "frames": label("Frames and calibration pictures"),
        "remarks": label("Remarks of the operator"),
        "reading": label("How to read this report"),
        "settings": label("Software and settings"),
        "inputs": label("Inputs, each with its hash"),
        "signatures": label("Signatures"),
    }
)
"""Name and title of each section that can be left out, in printing order.

What a reader must not miss is not among them: the result, what it does not cover, warnings, and the hash over all
inputs. Those of wings are not among them either: see `sections`.
"""


def sections() -> Mapping[str, str]:
    """List name and title of each section that can be left out, those that wings bring behind those of the house."""
    brought = {wing.section_name(one): one.title for wing in wings() for one in wing.sections}
    return {**SECTIONS, **{name: title for name, title in brought.items() if name not in SECTIONS}}


@dataclass(frozen=True, slots=True)
class ReportTemplate:
    """Company's own parts of a report.

    Parameters
    ----------
    name, address
        Of the laboratory, for the head of page one; `address` in lines.
    country
        Of the laboratory, two letters of ISO 3166-1: a digital calibration certificate wants it.
    logo
        The bytes of a PNG or JPEG picture for the head of page one; none if empty.
    accent
        The colour of headings, marks and lines, as "#RRGGBB".
    footer
        One line for the foot of every page.
    text
        A paragraph of the company's own, printed before the signatures.
    signatures
        Whose signature each line is for; none: one line for the operator.
    without
        Sections that this company leaves out.
    paper, language
        What it prints on and in; None: as the report says elsewhere.
    """

    name: str = ""
    address: tuple[str, ...] = ()
    country: str = ""
    logo: bytes = b""
    accent: str = "#14586E"
    footer: str = ""
    text: str = ""
    signatures: tuple[str, ...] = ()
    without: frozenset[str] = frozenset()
    paper: Paper | None = None
    language: str | None = None

    @property
    def words(self) -> tuple[object, ...]:
        """Texts of the template that are printed in a report; empty if there are none."""
        said = (self.name, self.address, self.footer, self.text, self.signatures)
        return said if any(said) else ()
