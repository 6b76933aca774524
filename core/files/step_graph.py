"""The graph of steps: what each reads, makes and rests on, once, for recording sets and projects, for window and disk.

From it come the order of work, which steps a set or a project wants, which results go when another is made anew, in
which order they are put in place, which page of the window a step is on, and what must be there before it. A set and a
project are two places of it, `core.pipeline.run` and `core.pipeline.project.whole`: what a step does there is the
place's method of its name.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Protocol, TypeVar

Stop = TypeVar("Stop", covariant=True)

FILES = {
    "camera": "camera.json",
    "planes": "planes.json",
    "poses": "planes.npz",
    "calibrated": "planes-calibrated.json",
    "check": "check.json",
    "cloud": "cloud.ply",
    "mesh": "mesh.ply",
    "scan": "scan.npz",
    "profiles": "profiles.ply",
    "profile": "profile.json",
    "profile_table": "profiles.csv",
    "gauge": "gauge.json",
    "faces": "gauge.npz",
    "inspection": "inspection.json",
    "inspected": "inspection.npz",
    "comparison": "comparison.json",
    "compared": "comparison.ply",
    "comparison_table": "comparison.csv",
    "joined": "joined.ply",
    "joint": "joint.json",
    "report": "report.pdf",
    "run": "run.json",
}
"""Fixed names of the results."""

READJUST = "readjust"
"""The step that moves the planes by a check, and leaves the record of how they were calibrated."""


@dataclass(frozen=True, slots=True)
class Step:
    """Step of the work: its name, what it reads and makes, and what it rests on.

    Parameters
    ----------
    name
        As run.json has it.
    page
        The page of the window it is on.
    makes
        Its results, keys of FILES, in the order in which they are put in place.
    decides
        That of its results which is another if what rests on the step no longer holds.
    rests_on
        The steps whose results it is made of: all of those that a project has, and one of `scan` and `profile`.
    reads
        The parts of a recording set whose pictures it is made from: where one is missing, the step is not wanted.
    on_request
        It is done only where it is asked for.
    shows
        Further steps whose results it shows if they are there.
    in_project
        Whether it is a step of a project, which keeps what its result rests on.
    """

    name: str
    page: str
    makes: tuple[str, ...]
    decides: str
    rests_on: tuple[str, ...] = ()
    reads: tuple[str, ...] = ()
    on_request: bool = False
    shows: tuple[str, ...] = ()
    in_project: bool = False

    def is_requested(self, there: Collection[str], asked: Collection[str]) -> bool:
        """Whether the step is wanted: the parts it reads are `there`, and it is `asked` for if need be."""
        return all(part in there for part in self.reads) and (not self.on_request or self.name in asked)


CALIBRATED = ("camera", "planes")
SURFACES = ("scan", "profile")
OF_FAN = ("planes", "check")
"""The steps of a project that are about the fan alone."""
GRAPH = (
    Step("camera", "camera", ("camera",), "camera", reads=("camera",), in_project=True),
    Step("planes", "planes", ("poses", "planes"), "planes", ("camera",), reads=("planes",), in_project=True),
    Step("check", "scan", ("check",), "check", CALIBRATED, reads=("check",), in_project=True),
    Step(READJUST, "scan", ("calibrated",), "calibrated", CALIBRATED, reads=("check",), on_request=True),
    Step("scan", "scan", ("scan", "cloud", "mesh"), "cloud", CALIBRATED, reads=("scan",), in_project=True),
    Step(
        "profile",
        "scan",
        ("profiles", "profile_table", "profile"),
        "profiles",
        CALIBRATED,
        reads=("scan",),
        on_request=True,
    ),
    Step("gauge", "inspect", ("faces", "gauge"), "gauge", SURFACES, on_request=True, in_project=True),
    Step(
        "inspection",
        "inspect",
        ("inspected", "inspection"),
        "inspection",
        SURFACES,
        on_request=True,
        in_project=True,
    ),
    Step(
        "comparison",
        "inspect",
        ("comparison_table", "compared", "comparison"),
        "comparison",
        SURFACES,
        on_request=True,
    ),
    Step("join", "inspect", ("joined", "joint"), "joint", ("scan",), on_request=True),
    Step("report", "report", ("report",), "report", ("scan",), shows=("gauge", "inspection"), in_project=True),
)
"""Every step, in the order of work."""


class Place(Protocol[Stop]):
    """Place where steps are done: a recording set or a project."""

    def is_due(self, step: Step, /) -> bool:
        """Whether a step is to be done here, after all steps before it have been done."""

    def do(self, step: Step, /) -> Stop | None:
        """Do a step; returns None to go on, or what stops the work."""


def do_steps(place: Place[Stop]) -> Stop | None:
    """Do all steps that are due at a place, in the order of work; returns what stopped them, None if nothing did."""
    for step in GRAPH:
        if place.is_due(step) and (stop := place.do(step)) is not None:
            return stop
    return None


IN_PROJECT = tuple(step for step in GRAPH if step.in_project)
"""The steps of a project, in the order of work."""
MAIN = {"camera": "camera", "planes": "planes", "scan": "scan", "inspect": "gauge", "report": "report"}
"""By page of the window, in the order of work: the step whose result tells how far the page is."""
PAGES = tuple(MAIN)
"""The pages on which steps are done, in the order of work."""


def needed_by(page: str, *, shown: bool = False) -> tuple[str, ...]:
    """List the pages whose results the main step of a page needs; with `shown`, also those whose results it shows."""
    step = next(step for step in GRAPH if step.name == MAIN[page])
    names = (*step.rests_on, *(step.shows if shown else ()))
    return tuple(dict.fromkeys(other.page for other in IN_PROJECT if other.name in names))


def resting_on(result: str) -> tuple[str, ...]:
    """List the results that are no longer valid once `result` changes; a report stays valid.

    It is whole, and says what it is of.
    """
    step = next((step for step in GRAPH if step.decides == result), None)
    return () if step is None else tuple(made for other in _behind(step) for made in other.makes)


def _behind(step: Step) -> Iterator[Step]:
    """The steps that rest on this one, and on those, but for the report."""
    gone = {step.name}
    for other in GRAPH:
        if other.name != "report" and gone.intersection(other.rests_on):
            gone.add(other.name)
            yield other
