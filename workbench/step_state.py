"""How far each step is, computed from facts: what the project says now, and what each result was made from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

from core.files.project.data import Done, Project
from core.files.project.keys import changed, inputs_of, is_needed
from core.files.step_graph import MAIN, PAGES, needed_by
from core.messages import capital, label
from core.states import NO_FAN, changed_since, outdated_with
from workbench.language import joined, sentence, text_of, time_of, tr

ORDER = ("project", *PAGES)
"""The pages of the steps in the order of work."""
NEEDS: Mapping[str, tuple[str, ...]] = {"project": (), **{page: needed_by(page) for page in PAGES}}
"""What must be there before a step can be done."""
STALE_WITH: Mapping[str, tuple[str, ...]] = {"project": (), **{page: needed_by(page, shown=True) for page in PAGES}}
"""What makes a step out of date when it is: a report prints the thickness, though it can do without one."""


TITLES: Mapping[str, str] = {
    "project": label("Project"),
    "camera": label("Camera"),
    "planes": label("Laser planes"),
    "scan": label("Scan"),
    "inspect": label("Inspect"),
    "report": label("Report"),
}
"""What the pages are called."""


class State(StrEnum):
    """State of a step on the rail."""

    TODO = "todo"
    READY = "ready"
    DONE = "done"
    OUTDATED = "outdated"
    NOT_NEEDED = "not needed"


SETTLED = (State.DONE, State.NOT_NEEDED)
"""States of a step at which there is nothing to do."""


@dataclass(frozen=True, slots=True)
class StepState:
    """State of a step, and the sentence that explains it (shown as the rail's tooltip and on the page)."""

    state: State
    sentence: str


def step_states(project: Project, results: Mapping[str, Done]) -> dict[str, StepState]:
    """Derive the state of each step, by its name, from the project and from what each result was made of."""
    states: dict[str, StepState] = {}
    for step in ORDER:
        states[step] = _project_state(project) if step == "project" else _state(step, project, results, states)
    return states


def _project_state(project: Project) -> StepState:
    if project.info.name.strip():
        return StepState(State.DONE, tr("The project has a name; everything else here is for the report."))
    return StepState(State.READY, tr("Give the project a name."))


def _state(step: str, project: Project, results: Mapping[str, Done], before: Mapping[str, StepState]) -> StepState:
    if not is_needed(MAIN[step], project):
        return StepState(State.NOT_NEEDED, tr(NO_FAN))
    done = results.get(MAIN[step])
    if done is not None:
        why = list(changed(done.rests_on, inputs_of(MAIN[step], project, results)))
        stale = [other for other in STALE_WITH[step] if before[other].state is State.OUTDATED]
        if why:
            return StepState(State.OUTDATED, sentence(capital(text_of(changed_since(why)))))
        if stale:
            because = outdated_with([_NAMES[need] for need in stale])
            return StepState(State.OUTDATED, sentence(capital(text_of(because))))
        return StepState(State.DONE, tr("Done on {at}.", at=time_of(done.at)))
    missing = [need for need in NEEDS[step] if MAIN[need] not in results and is_needed(MAIN[need], project)]
    if missing:
        return StepState(State.TODO, tr("First: {steps}.", steps=joined(tr(_NAMES[need]) for need in missing)))
    return StepState(State.READY, tr("Ready to be done."))


_NAMES = {
    "project": label("the project"),
    "camera": label("calibrate the camera"),
    "planes": label("calibrate the laser planes"),
    "scan": label("scan"),
    "inspect": label("inspect"),
    "report": label("report"),
}
