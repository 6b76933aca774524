"""The graph of steps: what each makes and rests on, once, for recording sets and projects, for the window and the disk.

From it come the order of work, which results go when another is made anew, in which order they are put in place, which
page of the window a step is on, and what must be there before it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

READJUST = "readjust"
"""The step that moves the planes by a check, and leaves the record of how they were calibrated."""


@dataclass(frozen=True, slots=True)
class Step:
    """One step of the work.

    Parameters
    ----------
    name
        As run.json has it.
    page
        The page of the window it is on.
    makes
        Its results, keys of `core.pipeline.steps.workspace.FILES`, in the order in which they are put in place.
    decides
        That of its results which is another if what rests on the step no longer holds.
    rests_on
        The steps whose results it is made of: all of those that a project has, and one of `scan` and `profile`.
    shows
        Further steps whose results it shows if they are there.
    in_project
        Its name among the results of a project; "" if a project does not keep what it rests on.
    """

    name: str
    page: str
    makes: tuple[str, ...]
    decides: str
    rests_on: tuple[str, ...] = ()
    shows: tuple[str, ...] = ()
    in_project: str = ""


CALIBRATED = ("camera", "planes")
SURFACES = ("scan", "profile")
GRAPH = (
    Step("camera", "camera", ("camera",), "camera", in_project="camera"),
    Step("planes", "planes", ("poses", "planes"), "planes", ("camera",), in_project="planes"),
    Step(READJUST, "scan", ("calibrated",), "calibrated", CALIBRATED),
    Step("check", "scan", ("check",), "check", CALIBRATED, in_project="check"),
    Step("scan", "scan", ("scan", "cloud", "mesh"), "cloud", CALIBRATED, in_project="scan"),
    Step("profile", "scan", ("profiles", "profile_table", "profile"), "profiles", CALIBRATED),
    Step("gauge", "inspect", ("faces", "gauge"), "gauge", SURFACES, in_project="inspect"),
    Step("inspection", "inspect", ("inspected", "inspection"), "inspection", SURFACES, in_project="features"),
    Step("comparison", "inspect", ("comparison_table", "compared", "comparison"), "comparison", SURFACES),
    Step("report", "report", ("report",), "report", ("scan",), ("gauge",), in_project="report"),
)
"""Every step, in the order of work."""

IN_PROJECT = {step.in_project: step for step in GRAPH if step.in_project}
"""The steps of a project, by their names among its results, in the order of work."""
PAGES = tuple(dict.fromkeys(step.page for step in GRAPH))
"""The pages on which steps are done, in the order of work."""


def needed_by(page: str, *, shown: bool = False) -> tuple[str, ...]:
    """Pages whose results must be there before the first step of a page; and those it shows, if asked for."""
    step = next(step for step in GRAPH if step.page == page and step.in_project)
    names = (*step.rests_on, *(step.shows if shown else ()))
    return tuple(dict.fromkeys(other.page for other in GRAPH if other.name in names and other.in_project))


def resting_on(result: str) -> tuple[str, ...]:
    """Results that no longer hold once `result` is another. The report stays: it is whole, and says what it is of."""
    step = next((step for step in GRAPH if step.decides == result), None)
    return () if step is None else tuple(made for other in _behind(step) for made in other.makes)


def _behind(step: Step) -> Iterator[Step]:
    """The steps that rest on this one, and on those, but for the report."""
    gone = {step.name}
    for other in GRAPH:
        if other.name != "report" and gone.intersection(other.rests_on):
            gone.add(other.name)
            yield other
