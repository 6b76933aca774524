"""How a company's reports look and what they say on every page: the same for all its parts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

Paper: TypeAlias = Literal["A4", "Letter"]
"""What a report is printed on."""

Language: TypeAlias = Literal["en", "de"]
"""The language of a report's fixed words."""

LANGUAGES: tuple[Language, ...] = ("en", "de")
PAPERS: tuple[Paper, ...] = ("A4", "Letter")


@dataclass(frozen=True, slots=True)
class ReportTemplate:
    """A company's own in a report.

    Parameters
    ----------
    name, address
        Of the laboratory, for the head of page one; `address` in lines.
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
    logo: bytes = b""
    accent: str = "#14586E"
    footer: str = ""
    text: str = ""
    signatures: tuple[str, ...] = ()
    without: frozenset[str] = frozenset()
    paper: Paper | None = None
    language: Language | None = None

    @property
    def words(self) -> tuple[object, ...]:
        """All that it makes a report say; empty if it says nothing."""
        said = (self.name, self.address, self.footer, self.text, self.signatures)
        return said if any(said) else ()
