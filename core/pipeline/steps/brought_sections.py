"""What wings bring to the report: sections of their own, and the studies they read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from core.door import found_at
from core.errors import InputError
from core.files.project.folder import STUDY
from core.files.step_graph import FILES
from core.findings.brought import OURS, failure
from core.findings.table import note_of
from core.messages import Message
from core.report.content import BroughtSection, ReportContent, ReportedStudy
from core.report.facts.fact import Fact
from core.report.wording import Words
from core.wing import GEOMETRY, no_reader_of_studies, wings


def with_brought_sections(content: ReportContent, out: Path) -> ReportContent:
    """Add to a report's content the sections that plug-ins (wings) make of the results in `out`.

    A note tells of a section that fails, and of a comparison for which no wing is there.
    """
    sections, below, notes = list[BroughtSection](), dict[str, BroughtSection](), list[Message]()
    for wing, origin in wings().wings:
        for one in wing.sections:
            try:
                facts = tuple(found_at(one.facts)(out, content))
                _try(one.title, facts)
            except Exception as error:  # noqa: BLE001  (whatever a stranger's wing raises: the report is made)
                notes.append(failure(origin or OURS, one.title, error))
                continue
            section = BroughtSection(one.title, facts, origin, wing.section_name(one))
            if facts and one.below_results:
                below.setdefault(one.below_results, section)
            elif facts:
                sections.append(section)
    if (out / FILES["comparison"]).exists() and all(wing.name != GEOMETRY for wing in wings()):
        notes.append(note_of("plugin.comparison_not_printed", name=GEOMETRY))
    if not (sections or below or notes):
        return content
    return replace(content, brought=tuple(sections), below_results=below, notes=(*content.notes, *notes))


def with_studies(content: ReportContent, paths: Sequence[Path]) -> ReportContent:
    """Add the studies in `paths`, each a study.json or its folder; a note tells where the wing that reads them fails.

    Raises
    ------
    InputError
        If one cannot be read, or no wing that reads them is there.
    """
    if not paths:
        return content
    reading = next(((wing, origin) for wing, origin in wings().wings if wing.reads_study), None)
    if reading is None:
        what, todo = no_reader_of_studies()
        raise InputError(what, where=paths[0], todo=todo)
    wing, origin = reading
    found, failed = list[ReportedStudy](), dict[Message, list[str]]()
    for path in paths:
        try:
            study = found_at(wing.reads_study)(path / STUDY if path.is_dir() else path)
            _try(study.kind, study.facts)
        except InputError:
            raise
        except Exception as error:  # noqa: BLE001  (as above)
            name = path.parent.name if path.name == STUDY else path.name
            failed.setdefault(failure(origin or OURS, wing.name, error), []).append(name)
            continue
        found.append(study)
    notes = [
        Message("plugin.study_not_read", "No study can be read from {studies:and}: {why}", studies=names, why=why)
        for why, names in failed.items()
    ]
    return replace(content, studies=(*content.studies, *found), notes=(*content.notes, *notes))


def _try(title: str, facts: tuple[Fact, ...]) -> None:
    """Put it all into words, so that what cannot be printed fails here and not while the report is drawn."""
    words = Words()
    words(title)
    for fact in facts:
        fact.title(words)
        fact.text(words)
