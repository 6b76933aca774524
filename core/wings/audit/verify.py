"""Whether a project, or a folder of results, is still what it was: the audit trail, the results, and their inputs."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from core.errors import InputError
from core.files.project.folder import PROJECT, RESULTS, is_project, read_project
from core.files.project.keys import changed, inputs_of
from core.files.project.witness import PEOPLE
from core.files.reading import file_hash
from core.files.recording.recording_set import RIG, RecordingSet, open_set
from core.files.results.run_file import read_run
from core.files.step_graph import FILES
from core.messages import Message, plural_message
from core.pipeline.project.workspace import project_set
from core.progress import Progress, silent, steps
from core.states import changed_since
from core.wings.audit.trail import Entry, Trail, read_trail
from core.wings.audit.witness import CHANGING, names_of_results, told_of


@dataclass(frozen=True, slots=True)
class Verified:
    """Result of comparing a project's files with their recorded hashes: the audit trail, counts, problems and notes."""

    trail: Trail
    results: int
    inputs: int
    problems: tuple[Message, ...]
    notes: tuple[Message, ...]


def verify(folder: Path, set_folder: Path | None = None, head: str = "", progress: Progress = silent) -> Verified:
    """Compare the pictures and results of a project with the hashes recorded when they were made; list what differs.

    Parameters
    ----------
    folder
        A project, or a folder of results.
    set_folder
        The recording set that the results are of; a project knows its own pictures.
    head
        What a report prints of the audit trail, or its beginning: an entry must have it.

    Raises
    ------
    InputError
        If there is neither a project nor a run.json, or the set is not named.
    """
    if is_project(folder):
        return _project(folder, head, progress)
    run = folder / FILES["run"]
    inputs = read_run(run).inputs
    if set_folder is None:
        raise InputError(
            Message("verify.no_set", "these are results without their project"),
            where=folder,
            todo=Message("advice.name_the_set", "name the recording set they are of with --set"),
        )
    problems = _inputs(inputs.items(), open_set(set_folder), progress)
    return Verified(Trail(), 0, len(inputs), tuple(problems), ())


def _project(folder: Path, head: str, progress: Progress) -> Verified:
    file, trail = read_project(folder), read_trail(folder)
    problems, notes = list(trail.problems), []
    if trail.torn:
        notes.append(Message("verify.torn", "the last line of the audit trail was cut off; it never was an entry"))
    if head and not any(entry.hash.startswith(head.lower()) for entry in trail.entries):
        problems.append(Message("verify.head_unknown", "no entry of the audit trail has the hash {head}", head=head))
    states = [entry for entry in trail.entries if entry.state]
    if not states:
        notes.append(Message("verify.no_trail", "nothing was saved since there are audit trails"))
    elif (state := file_hash(folder / PROJECT)) != states[-1].state:
        if len(states) > 1 and state == states[-2].state:
            notes.append(
                Message("verify.save_cut_off", "the last save was cut off: {file} is the one before", file=PROJECT)
            )
        else:
            problems.append(Message("verify.state", "{file} is not what the program last saved", file=PROJECT))
    told = told_of(trail.entries)
    differing = _results(folder, told) if told else []
    if differing and (folder / CHANGING).exists():
        notes.append(
            plural_message(
                "verify.change_cut_off",
                "the last change of the results was cut off before its entry in the trail; {n} file was not compared",
                "the last change of the results was cut off before its entry in the trail; {n} files were not compared",
                n=len(differing),
            )
        )
    else:
        problems += differing
    inputs: dict[str, str] = {}
    if message := _people(folder, trail):
        problems.append(message)
    run = folder / RESULTS / FILES["run"]
    if run.exists():
        inputs = dict(read_run(run).inputs)
        problems += _inputs(inputs.items(), project_set(folder, file.project), progress)
    for step, done in file.results.items():
        if names := changed(done.rests_on, inputs_of(step, file.project, file.results)):
            notes.append(Message("verify.outdated", "{step}: {why}", step=step, why=changed_since(names)))
    return Verified(trail, len(told.files) if told else 0, len(inputs), tuple(problems), tuple(notes))


def _people(folder: Path, trail: Trail) -> Message | None:
    """Whether people.json is another one than that which the audit trail tells of."""
    told = [entry for entry in trail.entries if entry.what in ("people", "people reset")]
    wanted = told[-1].files.get(PEOPLE, "") if told else ""
    path = folder / PEOPLE
    if wanted == (file_hash(path) if path.exists() else ""):
        return None
    return Message("verify.people", "{file} is not what the audit trail tells of", file=PEOPLE)


def _results(folder: Path, entry: Entry) -> list[Message]:
    problems = []
    for one, digest in entry.files.items():
        path = folder / one
        if not path.is_file():
            problems.append(Message("verify.missing", "{name} is missing", name=one))
        elif file_hash(path) != digest:
            problems.append(Message("verify.result", "{name} is not what it was (entry {n})", name=one, n=entry.n))
    strange = (one for one in names_of_results(folder) if Path(one).name in FILES.values() and one not in entry.files)
    problems += [
        Message("verify.not_made", "{name} was not made with the results beside it", name=one) for one in strange
    ]
    return problems


def _inputs(inputs: Iterable[tuple[str, str]], recording_set: RecordingSet, progress: Progress) -> list[Message]:
    problems = []
    listed = list(inputs)
    for name, digest in steps(listed, progress, "comparing", len(listed)):
        try:
            now = recording_set.rig_hash if name == RIG else file_hash(recording_set.path_of(name))
        except InputError:
            problems.append(Message("verify.missing", "{name} is missing", name=name))
            continue
        if now != digest:
            problems.append(Message("verify.input", "{name} is not what the results were made of", name=name))
    return problems
