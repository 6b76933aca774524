"""The sections that wings bring to the report."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from core.door import found_at
from core.findings.brought import OURS, failure
from core.messages import Message
from core.report.content import BroughtSection, ReportContent
from core.report.facts.fact import Fact
from core.report.wording import Words
from core.wing import wings


def with_brought_sections(content: ReportContent, out: Path) -> ReportContent:
    """Add the sections of all wings on the results in the folder `out`; a note tells of one that fails."""
    sections, failed = list[BroughtSection](), list[Message]()
    for wing, origin in wings().wings:
        for one in wing.sections:
            try:
                facts = tuple(found_at(one.facts)(out, content))
                _try(one.title, facts)
            except Exception as error:  # noqa: BLE001  (whatever a stranger's wing raises: the report is made)
                failed.append(failure(origin or OURS, one.title, error))
                continue
            sections += [BroughtSection(one.title, facts, origin)] if facts else []
    if not sections and not failed:
        return content
    return replace(content, brought=tuple(sections), notes=(*content.notes, *failed))


def _try(title: str, facts: tuple[Fact, ...]) -> None:
    """Put it all into words, so that what cannot be printed fails here and not while the report is drawn."""
    words = Words()
    words(title)
    for fact in facts:
        fact.title(words)
        fact.text(words)
