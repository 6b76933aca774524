"""Wings of the window: what is beside the mission, each as one whole that the window does not import and opens without.

One of our own is a folder of `workbench.wings` whose module `wing` has the constant WINDOW_WING. Another package names
its `WindowWing` under `trisect.window_wings` among its entry points. A wing has the same name here as in `core.wing`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import chain
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from PySide6.QtCore import QObject, SignalInstance
from PySide6.QtWidgets import QMainWindow, QWidget

from core.door import Brought, Origin, by_entry_points, by_folders, found_at
from core.files.results.export_list import unusable_exports
from core.findings.brought import OURS as PROGRAM
from core.findings.brought import failure, note_on_unusable
from core.findings.table import unusable_findings
from core.inspect.plan.kinds import unusable_kinds
from core.messages import Message
from core.report.facts.fact import Fact
from core.report.wording import ENGLISH
from core.wing import WINDOW_GROUP, Found, found_wings, note_on_no_wings
from workbench.bench import Bench
from workbench.language import text_of, tr
from workbench.notices import Notices
from workbench.project_model import EditGuard

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Thing = TypeVar("Thing")

OURS = "workbench.wings"

_NOT_OF: Mapping[type, Message] = {
    QWidget: Message("plugin.why_no_widget", "what it makes is no widget"),
    QObject: Message("plugin.why_no_layer", "what it makes is no layer of the surface"),
    EditGuard: Message("plugin.why_no_guard", "what it makes is no EditGuard"),
}


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


@dataclass(frozen=True, slots=True)
class InspectLayer:
    """A layer by which the surface of the page Inspect can be coloured, with a panel of its own at the side.

    Parameters
    ----------
    name
        Of the layer: no two have the same. Whether its panel is folded is kept by it.
    title, panel_title
        What the surface is then coloured by, and the panel's title: English words that the window translates.
    opens
        "module:name" of a function of the page's presenter that returns the `SurfaceLayer`, a QObject.
    panel
        "module:name" of a function of the page's presenter and the layer that returns a widget; its `refresh` is called
        when what the page shows has changed.
    """

    name: str
    title: str
    panel_title: str
    opens: str
    panel: str


@dataclass(frozen=True, eq=False, slots=True)
class Coloured:
    """Values that colour a surface. It is drawn anew for another object, so an equal one is not made again.

    Parameters
    ----------
    title
        Of the colour bar.
    end_mm
        The bar goes from −end_mm to end_mm.
    points
        (N,) values in mm at the points of cloud.ply in their order; NaN: grey.
    vertices
        (V,) values in mm at the vertices of mesh.ply; empty where there is no mesh.
    grey
        What is grey, in words; "": that needs none.
    """

    title: str
    end_mm: float
    points: NDArray[np.float32]
    vertices: NDArray[np.float32]
    grey: str = ""


class SurfaceLayer(Protocol):
    """What colours the surface, and stands beside it."""

    changed: SignalInstance
    """Something of it is another one."""
    made: SignalInstance
    """It is there, and the surface is to be coloured by it."""

    @property
    def coloured(self) -> Coloured | None:
        """Return what colours the surface; None where it is not there."""

    @property
    def why_not(self) -> str:
        """Return the reason why the surface cannot be coloured by it; "" if it can."""

    @property
    def beside(self) -> NDArray[np.float32] | None:
        """Points (M, 3) in mm in the camera frame that are shown beside the surface; None: nothing."""

    def forget(self) -> None:
        """Forget it, as another scan or another project is shown."""


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
    layers
        Of the surface on the page Inspect.
    below_repeats
        "module:name" of a function of the presenter of the page Inspect that returns a `RepeatsPart`, a widget that
        stands below the statistics of the repeats; "": nothing.
    guard
        "module:name" of a function of (`Bench`, `QMainWindow`) that returns the `workbench.project_model.EditGuard`:
        it decides on changes of the open project. The first one counts; "": none.
    """

    name: str
    entries: tuple[MenuEntry, ...] = ()
    tabs: tuple[InspectTab, ...] = ()
    layers: tuple[InspectLayer, ...] = ()
    below_repeats: str = ""
    guard: str = ""


@cache
def window_wings() -> Found[WindowWing]:
    """Load all wings of the window; further calls return the first result."""
    return found_wings(WindowWing, chain(by_folders(OURS, "WINDOW_WING"), by_entry_points(WINDOW_GROUP)))


def opened_by_entries(bench: Bench, window: QMainWindow) -> Mapping[MenuEntry, Callable[[], object]]:
    """What each entry of the wings does; a notice tells of those that cannot be made."""
    for one in (*window_wings().unusable, *unusable_findings(), *unusable_exports(), *unusable_kinds()):
        bench.notices.warning(text_of(note_on_unusable(one)))
    if note := note_on_no_wings():
        bench.notices.warning(text_of(note))
    entries = ((one, one.opens, one.name, origin) for wing, origin in window_wings().wings for one in wing.entries)
    return dict(_made(bench, entries, bench, window))


def guard_project(bench: Bench, window: QMainWindow) -> None:
    """Have a wing's guard decide on changes of the open project; a notice tells of those that cannot be made."""
    guards = ((wing, wing.guard, wing.name, origin) for wing, origin in window_wings().wings if wing.guard)
    for _, guard in _made(bench, guards, bench, window, kind=EditGuard):
        bench.model.guard = guard
        return


def inspect_tabs(bench: Bench, presenter: QObject) -> Sequence[tuple[InspectTab, Any]]:
    """Make the wings' tabs for the page Inspect, each with its widget; a notice tells of those that fail."""
    tabs = ((one, one.opens, one.title, origin) for wing, origin in window_wings().wings for one in wing.tabs)
    return list(_made(bench, tabs, presenter, kind=QWidget))


class Guard:
    """Calls of what a wing made; a notice tells what of it fails, once."""

    def __init__(self, name: str, origin: Origin | None, notices: Notices) -> None:
        self.origin = origin
        self._name, self._notices, self._told = name, notices, set[str]()

    def tried(self, call: Callable[[], Thing], otherwise: Thing) -> Thing:
        """Return what the call does, or `otherwise` where it fails."""
        try:
            return call()
        except Exception as error:  # noqa: BLE001  (whatever a stranger's object raises: the page goes on)
            text = text_of(failure(self.origin or PROGRAM, self._name, error))
            if text not in self._told:
                self._told.add(text)
                self._notices.warning(text)
            return otherwise


class PartOfWing:
    """Widget of a wing on a page; a notice tells what of it fails, once."""

    def __init__(self, widget: Any, guard: Guard) -> None:
        self.widget: QWidget = widget
        self._part: RepeatsPart = widget
        self._guard = guard

    def refresh(self) -> None:
        """Refresh the widget."""
        self._guard.tried(lambda: self._part.refresh(), None)

    def facts(self) -> Sequence[Fact]:
        """Return the facts of the widget; nothing where it fails, or where they cannot be put into words."""
        return self._guard.tried(self._facts, ())

    def _facts(self) -> Sequence[Fact]:
        facts = tuple(self._part.facts())
        for fact in facts:
            fact.title(ENGLISH)
            fact.text(ENGLISH)
        return facts


class LayerOfWing:
    """Layer of the surface that a wing brings; a notice tells what of it fails, once, and it is not there then."""

    def __init__(self, one: InspectLayer, layer: Any, guard: Guard) -> None:
        self.one = one
        self.layer: SurfaceLayer = layer
        self._guard = guard

    def connect(self, changed: SignalInstance) -> None:
        """Emit `changed` when something of the layer is another one."""
        self._guard.tried(lambda: self.layer.changed.connect(changed), None)

    def connect_made(self, made: Callable[[], object]) -> None:
        """Call `made` when the layer is there, and the surface is to be coloured by it."""
        self._guard.tried(lambda: self.layer.made.connect(made), None)

    @property
    def coloured(self) -> Coloured | None:
        """What colours the surface; None where it is not there."""
        made = self._guard.tried(lambda: self.layer.coloured, None)
        return made if isinstance(made, Coloured) else None

    @property
    def why_not(self) -> str:
        """Reason why the surface cannot be coloured by it; "" if it can."""
        return self._guard.tried(lambda: self.layer.why_not, tr("The wing that brings it has failed: see the notices."))

    @property
    def beside(self) -> NDArray[np.float32] | None:
        """Points (M, 3) in mm that are shown beside the surface; None: nothing."""
        return self._guard.tried(lambda: self.layer.beside, None)

    def at_points(self, order: NDArray[np.int32]) -> NDArray[np.float32] | None:
        """Return the values in mm at the points numbered `order`; None where there are none."""
        coloured = self.coloured
        return None if coloured is None else self._guard.tried(lambda: coloured.points[order], None)

    def at_vertices(self, count: int) -> NDArray[np.float32] | None:
        """Return the values (V,) in mm at the mesh's `count` vertices; None where there are not as many."""
        coloured = self.coloured
        return None if coloured is None or len(coloured.vertices) != count else coloured.vertices

    def forget(self) -> None:
        """Forget the layer, as another scan or another project is shown."""
        self._guard.tried(lambda: self.layer.forget(), None)

    def panel(self, bench: Bench, presenter: QObject) -> PartOfWing | None:
        """Make the layer's panel; a notice tells where that fails, and there is none."""
        wanted = ((self.one, self.one.panel, self.one.panel_title, self._guard.origin),)
        widgets = [widget for _, widget in _made(bench, wanted, presenter, self.layer, kind=QWidget)]
        return PartOfWing(widgets[0], self._guard) if widgets else None


def inspect_layers(bench: Bench, presenter: QObject) -> Mapping[str, LayerOfWing]:
    """Make the wings' layers of the surface of the page Inspect, by the names of their colours.

    A notice tells of those that fail.
    """
    every = ((one, origin) for wing, origin in window_wings().wings for one in wing.layers)
    wanted = (((one, origin), one.opens, one.title, origin) for one, origin in every)
    made = _made(bench, wanted, presenter, kind=QObject)
    layers = [LayerOfWing(one, layer, Guard(one.title, origin, bench.notices)) for (one, origin), layer in made]
    return {f"layer {layer.one.name}": layer for layer in layers}


def repeats_parts(bench: Bench, presenter: QObject) -> Sequence[PartOfWing]:
    """What the wings put below the statistics of the repeats; a notice tells of what cannot be made."""
    parts = (((w, origin), w.below_repeats, w.name, origin) for w, origin in window_wings().wings if w.below_repeats)
    return [
        PartOfWing(widget, Guard(wing.name, origin, bench.notices))
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
            why = "" if isinstance(made, kind) else _NOT_OF[kind]
        if why:
            bench.notices.warning(text_of(note_on_unusable(Brought(name, made, why, origin))))
        else:
            yield thing, made
