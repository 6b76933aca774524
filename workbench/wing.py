"""Wings of the window: what is beside the mission, each as one whole that the window does not import and opens without.

One of our own is a folder of `workbench.wings` whose module `wing` has the constant WINDOW_WING. Another package names
its `WindowWing` under `trisect.window_wings` among its entry points. A wing has the same name here as in `core.wing`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import chain
from typing import Any, Protocol, TypeVar

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QMainWindow, QWidget

from core.door import Brought, Origin, by_entry_points, by_folders, found_at
from core.files.results.export_list import unusable_exports
from core.findings.brought import OURS as PROGRAM
from core.findings.brought import failure, note_on_unusable
from core.findings.table import unusable_findings
from core.messages import Message
from core.report.facts.fact import Fact
from core.report.wording import ENGLISH
from core.wing import WINDOW_GROUP, Found, found_wings, note_on_no_wings
from workbench.bench import Bench
from workbench.language import text_of
from workbench.notices import Notices

Thing = TypeVar("Thing")

OURS = "workbench.wings"

_NO_WIDGET = Message("plugin.why_no_widget", "what it makes is no widget")


@dataclass(frozen=True, slots=True)
class MenuEntry:
    """Entry of a menu that opens a page of a wing.

    Parameters
    ----------
    name
        Of the entry: no two have the same.
    text
        English words that the window translates.
    opens
        "module:name" of a function of (`Bench`, `QMainWindow`) that returns what the entry calls without arguments. It
        is called once, when the window is made.
    after
        The entry behind which it stands, in the same menu.
    needs_project
        Whether it can only be chosen while a project is open.
    """

    name: str
    text: str
    opens: str
    after: str = "script"
    needs_project: bool = False


@dataclass(frozen=True, slots=True)
class InspectTab:
    """A tab of the page Inspect, behind those of the house.

    Parameters
    ----------
    title, tip
        English words that the window translates.
    opens
        "module:name" of a function of the page's presenter that returns the widget; its `refresh` is called when what
        the page shows has changed.
    """

    title: str
    tip: str
    opens: str


class RepeatsPart(Protocol):
    """A widget below the statistics of the repeats."""

    def refresh(self) -> None:
        """Show what the part's presenter says now, below the statistics of the repeats."""

    def facts(self) -> Sequence[Fact]:
        """Return the facts that this part shows, to be copied together with the repeats."""


@dataclass(frozen=True, slots=True)
class WindowWing:
    """What a wing adds to the window. What it names is imported when the window is made.

    Parameters
    ----------
    name
        Of the wing.
    entries
        Of the menus.
    tabs
        Of the page Inspect.
    below_repeats
        "module:name" of a function of the presenter of the page Inspect that returns a `RepeatsPart`, a widget that
        stands below the statistics of the repeats; "": nothing.
    """

    name: str
    entries: tuple[MenuEntry, ...] = ()
    tabs: tuple[InspectTab, ...] = ()
    below_repeats: str = ""


@cache
def window_wings() -> Found[WindowWing]:
    """Load all wings of the window; further calls return the first result."""
    return found_wings(WindowWing, chain(by_folders(OURS, "WINDOW_WING"), by_entry_points(WINDOW_GROUP)))


def opened_by_entries(bench: Bench, window: QMainWindow) -> Mapping[MenuEntry, Callable[[], object]]:
    """What each entry of the wings does; a notice tells of those that cannot be made."""
    for one in (*window_wings().unusable, *unusable_findings(), *unusable_exports()):
        bench.notices.warning(text_of(note_on_unusable(one)))
    if note := note_on_no_wings():
        bench.notices.warning(text_of(note))
    entries = ((one, one.opens, one.name, origin) for wing, origin in window_wings().wings for one in wing.entries)
    return dict(_made(bench, entries, bench, window))


def inspect_tabs(bench: Bench, presenter: QObject) -> Sequence[tuple[InspectTab, Any]]:
    """Make the wings' tabs for the page Inspect, each with its widget; a notice tells of those that fail."""
    tabs = ((one, one.opens, one.title, origin) for wing, origin in window_wings().wings for one in wing.tabs)
    return list(_made(bench, tabs, presenter, kind=QWidget))


class PartOfWing:
    """Widget of a wing below the statistics of the repeats; a notice tells what of it fails, once."""

    def __init__(self, widget: Any, name: str, origin: Origin, notices: Notices) -> None:
        self.widget: QWidget = widget
        self._part: RepeatsPart = widget
        self._name, self._origin, self._notices = name, origin, notices
        self._told = set[str]()

    def refresh(self) -> None:
        """Refresh the widget."""
        self._tried(lambda: self._part.refresh(), None)

    def facts(self) -> Sequence[Fact]:
        """Return the facts of the widget; nothing where it fails, or where they cannot be put into words."""
        return self._tried(self._facts, ())

    def _facts(self) -> Sequence[Fact]:
        facts = tuple(self._part.facts())
        for fact in facts:
            fact.title(ENGLISH)
            fact.text(ENGLISH)
        return facts

    def _tried(self, call: Callable[[], Thing], otherwise: Thing) -> Thing:
        try:
            return call()
        except Exception as error:  # noqa: BLE001  (whatever a stranger's widget raises: the page goes on)
            text = text_of(failure(self._origin, self._name, error))
            if text not in self._told:
                self._told.add(text)
                self._notices.warning(text)
            return otherwise


def repeats_parts(bench: Bench, presenter: QObject) -> Sequence[PartOfWing]:
    """What the wings put below the statistics of the repeats; a notice tells of what cannot be made."""
    parts = (((w, origin), w.below_repeats, w.name, origin) for w, origin in window_wings().wings if w.below_repeats)
    return [
        PartOfWing(widget, wing.name, origin or PROGRAM, bench.notices)
        for (wing, origin), widget in _made(bench, parts, presenter, kind=QWidget)
    ]


def _made(
    bench: Bench, wanted: Iterable[tuple[Thing, str, str, Origin | None]], *given: object, kind: type = object
) -> Iterator[tuple[Thing, Any]]:
    """Call the function at each place; each wanted thing has its place, the name it is told by, and its origin."""
    for thing, place, name, origin in wanted:
        made: object = None
        why: Message | str = ""
        try:
            made = found_at(place)(*given)
        except Exception as error:  # noqa: BLE001  (whatever a stranger's page raises: the window opens)
            why = f"{type(error).__name__}: {error}"
        else:
            why = "" if isinstance(made, kind) else _NO_WIDGET
        if why:
            bench.notices.warning(text_of(note_on_unusable(Brought(name, made, why, origin))))
        else:
            yield thing, made
