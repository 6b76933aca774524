"""Wings: what is beside the mission, each as one whole that the house does not import and works without.

The house asks `wings` for them where it makes its list of commands; it knows a wing by its names alone. One of our own
is a folder of `core.wings` whose module `wing` has the constant WING. Another package names its `Wing` under
`trisect.wings` among its entry points; its code runs in this program with all rights of the user. TRISECT_WITHOUT_WINGS
leaves wings out by their names.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from itertools import chain
from typing import Generic, Protocol, TypeGuard, TypeVar

from core.door import WITHOUT, Brought, Origin, by_entry_points, by_folders, found_at, left_out, names_of_entry_points
from core.messages import Message

OURS, GROUP, WINDOW_GROUP = "core.wings", "trisect.wings", "trisect.window_wings"
STUDIES = "studies"
"""Our own wing that reads studies."""
GEOMETRY = "geometry"
"""Our own wing that compares the part with other surfaces, and measures orientation, position and deviation."""
AUDIT = "audit"
"""Our own wing that keeps the trail of a project's changes, and knows who may make them."""
OUR_COMMANDS: Mapping[str, str] = {
    "compare": GEOMETRY,
    "plan": "rig_planning",
    "study": STUDIES,
    **dict.fromkeys(("verify", "audit", "people"), AUDIT),
}
"""The commands of our own wings, and which wing each is of: known where the wing's folder is gone, too."""
OUR_KINDS: Mapping[str, str] = dict.fromkeys(("parallelism", "perpendicularity", "position", "deviation"), GEOMETRY)
"""The kinds of features of our own wings, likewise."""
OUR_EXPORTS: Mapping[str, str] = {"compared": GEOMETRY, "compared-csv": GEOMETRY}
"""The kinds of export of our own wings, likewise."""

Row = TypeVar("Row")

_NOT_THERE = Message("plugin.not_there", "which is not there")
INSTALL_ALL = Message("advice.wing_missing", "install Trisect with all its folders")
_NO_WING = Message("plugin.why_no_wing", "it is no Wing with a name of its own")


@dataclass(frozen=True, slots=True)
class ReportSection:
    """Section of the report: a heading and facts.

    Parameters
    ----------
    title
        Its heading: English words that the report translates.
    facts
        "module:name" of a function of the folder of results (a path) and the `core.report.content.ReportContent` so
        far, that gives the `core.report.facts.fact.Fact` of the section. Without facts the section is not printed.
    below_results
        "": it stands behind the checks by artefacts. Else its facts stand below the results on the first page, and by
        this name among the facts of the XLSX workbook.
    """

    title: str
    facts: str
    below_results: str = ""


@dataclass(frozen=True, slots=True)
class Wing:
    """Commands, steps and results that a wing adds. What it names is imported when it is asked for.

    Parameters
    ----------
    name
        Of the wing; no two have the same.
    commands
        Its commands of `trisect`, as "module:name" of a `typer.Typer` that is light to import; "": it has none.
    after
        The command behind which they stand in `trisect --help`; "": at the end.
    sections
        What it adds to the report.
    findings
        "module:name" of the rows it adds to the table of findings, each a `core.findings.finding.Finding`, in a module
        that is light to import; "": none.
    exports
        "module:name" of the kinds of files it can export, each a `core.files.results.export_list.BroughtExport`, in a
        module that is light to import; "": none.
    feature_kinds
        "module:name" of the kinds of features it measures, each a `core.inspect.plan.feature_kind.FeatureKind`, in a
        module that is light to import; "": none.
    reads_study
        "module:name" of a function of the path of a study.json that gives the `core.report.content.ReportedStudy`, or
        raises InputError; "": it reads none.
    witness
        "module:name" of the `core.files.project.witness.Witness` that is told of what is written into projects, in a
        module that is light to import; "": none.
    """

    name: str
    commands: str = ""
    after: str = ""
    sections: tuple[ReportSection, ...] = ()
    findings: str = ""
    exports: str = ""
    feature_kinds: str = ""
    reads_study: str = ""
    witness: str = ""

    def section_name(self, section: ReportSection) -> str:
        """Return the name by which a section of this wing is left out of the report."""
        return section.below_results or self.name


class Named(Protocol):
    """Object with the name of a wing."""

    @property
    def name(self) -> str:
        """Name by which a wing, a part of the program, is found and left out."""
        ...


AWing = TypeVar("AWing", bound=Named)


@dataclass(frozen=True, slots=True)
class Found(Generic[AWing]):
    """Wings of one kind, ours first, each with the package it comes from, and what cannot be used.

    The origin of one of ours is None. Of those left out only wings of other packages are among `away`.
    """

    wings: tuple[tuple[AWing, Origin | None], ...]
    unusable: tuple[Brought, ...]
    away: tuple[AWing, ...] = ()

    def __iter__(self) -> Iterator[AWing]:
        return (wing for wing, _ in self.wings)


@cache
def wings() -> Found[Wing]:
    """Return all wings, loaded once, with notes on those that cannot be used."""
    return found_wings(Wing, chain(by_folders(OURS, "WING"), by_entry_points(GROUP)))


def studies_can_be_read() -> bool:
    """Whether a wing is there that reads studies."""
    return any(wing.reads_study for wing in wings())


def found_wings(kind: type[AWing], brought: Iterable[Brought]) -> Found[AWing]:
    """Sort loaded objects into wings of this `kind`, unusable ones and wings left out; of one name the first counts."""
    found, unusable, away = dict[str, tuple[AWing, Origin | None]](), list[Brought](), list[AWing]()
    for one in brought:
        wing = one.what
        if one.name in left_out() or (isinstance(wing, kind) and wing.name in left_out()):
            away += [wing] if isinstance(wing, kind) else []
            continue
        if isinstance(wing, kind) and wing.name not in found:
            found[wing.name] = wing, one.origin
        else:
            unusable.append(one if one.why else replace(one, why=_NO_WING))
    return Found(tuple(found.values()), tuple(unusable), tuple(away))


def rows_of_wings(
    place: Callable[[Wing], str],
    is_row: Callable[[object], TypeGuard[Row]],
    name_of: Callable[[Row], str],
    taken: Container[str],
    why: Callable[[str], Message],
) -> tuple[Mapping[str, tuple[Row, Origin | None]], tuple[Brought, ...]]:
    """Collect the rows that wings add to a table of the house, by their names, and those that cannot be used.

    With each row is the package it comes from; None: the program itself.

    Parameters
    ----------
    place
        Where a wing has its rows, "module:name"; "": it has none.
    is_row
        Whether an object is a row of the table.
    name_of
        The name of a row; of one name the first row counts.
    taken
        The names of the house's own rows.
    why
        What is wrong with a row whose name is taken, or, with the name "", with what is no row.
    """
    found, unusable = dict[str, tuple[Row, Origin | None]](), list[Brought]()
    for wing, origin in wings().wings:
        try:
            rows = tuple(found_at(place(wing))) if place(wing) else ()
        except Exception as error:  # noqa: BLE001  (whatever a stranger's module raises: the house has its own rows)
            unusable.append(Brought(wing.name, None, f"{type(error).__name__}: {error}", origin))
            continue
        for row in rows:
            if not is_row(row):
                unusable.append(Brought(wing.name, row, why(""), origin))
            elif name_of(row) in taken or name_of(row) in found:
                unusable.append(Brought(wing.name, row, why(name_of(row)), origin))
            else:
                found[name_of(row)] = row, origin
    return found, tuple(unusable)


def no_reader_of_studies() -> tuple[Message, Message]:
    """Return what is wrong where no wing reads studies, and what to do."""
    why, todo = why_away(STUDIES)
    what = Message("plugin.no_reader_of_studies", "studies are read by the wing {name}, {why}", name=STUDIES, why=why)
    return what, todo


def why_away(name: str) -> tuple[Message, Message]:
    """Return what is wrong with a wing that is not there, as it follows its name in a sentence, and what to do."""
    if name in left_out() or any(wing.name == name for wing in wings().away):
        return _NOT_THERE, Message("advice.wing_left_out", "take it out of {variable}", variable=WITHOUT)
    if why := _why_not_loaded(name):
        return Message("plugin.not_loaded", "which cannot be loaded ({why})", why=why), INSTALL_ALL
    return _NOT_THERE, INSTALL_ALL


def _why_not_loaded(name: str) -> Message | str:
    """Why a wing of our own, or its commands, cannot be loaded; "" where no folder of the name is there."""
    for one in wings().unusable:
        if one.name == name and one.origin is None:
            return one.why
    for wing, origin in wings().wings:
        if wing.name == name and origin is None and wing.commands:
            try:
                found_at(wing.commands)
            except Exception as error:  # noqa: BLE001  (whatever hinders the import is the reason)
                return f"{type(error).__name__}: {error}"
    return ""


def note_on_no_wings() -> Message | None:
    """Note which names in the environment variable WITHOUT are of no wing; None where each is of one."""
    there, declared = wings(), names_of_entry_points(GROUP)
    of_windows = names_of_entry_points(WINDOW_GROUP) - declared
    known = {*OUR_COMMANDS.values(), *(wing.name for wing in (*there, *there.away))}
    if not (unknown := sorted(left_out() - known - declared - of_windows)):
        return None
    broken = {one.name for one in there.unusable}
    return Message(
        "plugin.no_such_wing",
        "{variable} names {unknown:and}, but the wings are {known:and}.",
        variable=WITHOUT,
        unknown=unknown,
        known=sorted(known | broken | of_windows),
    )
