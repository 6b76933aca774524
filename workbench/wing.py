"""Wings of the window: what is beside the mission, each as one whole that the window does not import and opens without.

One of our own is a folder of `workbench.wings` whose module `wing` has the constant WINDOW_WING. Another package names
its `WindowWing` under `trisect.window_wings` among its entry points. A wing has the same name here as in `core.wing`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from itertools import chain

from PySide6.QtWidgets import QMainWindow

from core.door import Brought, by_entry_points, by_folders, found_at
from core.findings.brought import note_on_unusable
from core.wing import Found, found_wings
from workbench.bench import Bench
from workbench.language import text_of

OURS, GROUP = "workbench.wings", "trisect.window_wings"


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
class WindowWing:
    """Pages, menu entries and words that a wing adds to the window. What it names is imported when the window is
    made.
    """

    name: str
    entries: tuple[MenuEntry, ...] = ()


@cache
def window_wings() -> Found[WindowWing]:
    """Load all wings of the window, once."""
    return found_wings(WindowWing, chain(by_folders(OURS, "WINDOW_WING"), by_entry_points(GROUP)))


def opened_by_entries(bench: Bench, window: QMainWindow) -> Mapping[MenuEntry, Callable[[], object]]:
    """Return the action of each entry of the wings; a notice is shown for those that fail."""
    made: dict[MenuEntry, Callable[[], object]] = {}
    unusable = list(window_wings().unusable)
    for wing, origin in window_wings().wings:
        for entry in wing.entries:
            try:
                made[entry] = found_at(entry.opens)(bench, window)
            except Exception as error:  # noqa: BLE001  (whatever a stranger's page raises: the window opens)
                unusable.append(Brought(entry.name, None, f"{type(error).__name__}: {error}", origin))
    for one in unusable:
        bench.notices.warning(text_of(note_on_unusable(one)))
    return made
