"""What was done in a project as a Python script of `trisect` commands, which gives the same results without a window.

The script stands for the results as they lie on the disk: what each step was told is taken from run.json, which keeps
it, not from what is chosen now. It needs no shell, so it runs alike on every system.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from string import Template
from typing import Any, TypeAlias

from core.checks.artefact_check import ArtefactCheck
from core.errors import InputError
from core.files.atomic import write_text
from core.files.plan.translation import plan_tables
from core.files.project.calibration_store import IMPORTED
from core.files.project.data import Project, ProjectFile
from core.files.project.folder import read_project, results_folder, source_folder, study_path
from core.files.project.keys import changed, inputs_of, is_needed, relocated
from core.files.reading import resolved
from core.files.recording.rig import rig_to_toml
from core.files.results.artefact_register import REGISTER, register_text
from core.files.results.nominal_surface import nominal_names
from core.files.results.run_file import RunRecord, read_run
from core.files.step_graph import CALIBRATED, FILES
from core.files.toml_text import toml_text
from core.messages import Message, label
from core.pipeline.project.workspace import part_name, project_set, rig_in_its_air
from core.pipeline.steps.artefact_step import frames_id
from core.pipeline.steps.validity import history_of
from core.pipeline.steps.workspace import read_calibration
from core.report.wording import Words
from core.settings.options import settings_of
from core.settings.setting import rows_within

SET, OUT, RIG, PLAN = "set", "results", "rig.toml", "plan.toml"
"""What the script makes in the folder it is run in."""

LIVE = label("recorded live into this project; the pictures are used as they are: {folder}")
CHANGED = label("changed since {step} was done, and taken as it is now: {what}")
NOT_SAID = label("chosen in the window, and no option of the command: {what}")

_Compared: TypeAlias = tuple[ArtefactCheck, float | None]


@dataclass(frozen=True, slots=True)
class _Line:
    """A command by its words, with what is to be known before it."""

    words: tuple[str, ...]
    remarks: tuple[str, ...] = ()


def write_script(folder: Path, path: Path, language: str = "en") -> Path:
    """Write a script of commands that repeats the project's measurement to `path`; return `path`.

    Its remarks are in `language`.

    Raises
    ------
    InputError
        If nothing has been measured in the project, or nothing can be written there.
    """
    write_text(path, script_text(folder, Words.of(language)))
    return path


def script_text(folder: Path, words: Words) -> str:
    """Make the text of a script that repeats the project's measurement; InputError if nothing has been measured.

    InputError as well if a file of the project is damaged. `words` gives the remarks.
    """
    file, results = _with_whole_paths(folder, read_project(folder)), results_folder(folder)
    if not (results / FILES["run"]).exists():
        raise InputError(
            Message("project.nothing_measured", "nothing has been measured in this project"),
            where=folder,
            todo=Message("advice.measure_before_script", "measure first, then save what was done"),
        )
    project, record = file.project, read_run(results / FILES["run"])
    there = {name for name, made in FILES.items() if (results / made).exists()}
    title = words(label("What was done in the project {name}, as commands of trisect."), name=project.info.name)
    use = words(label("Run it with Python in an empty folder: python {script}"), script="session.py")
    files = {RIG: rig_to_toml(rig_in_its_air(project))}
    if _inspects(project, there):
        files[PLAN] = toml_text(plan_tables(project.inspection))
    compared = _compared(folder, project, record)
    known = {one.id: one for one in (*project.artefacts, *(check.artefact for check, _ in compared))}
    if known:
        files[f"{SET}/{REGISTER}"] = register_text(known.values())
    commands = []
    for line in _lines(folder, file, record, there, words, compared):
        commands += [f"    # {_plain(remark)}" for remark in line.remarks]
        commands += [f"    trisect({', '.join(map(repr, line.words))})"] if line.words else []
    template = (resources.files("resources") / "script" / "session.txt").read_text(encoding="utf-8")
    return Template(template).substitute(
        title=_plain(title),
        use=_plain(use),
        files="".join(f'    {name!r}: """\\\n{_quoted(text)}""",\n' for name, text in files.items()),
        commands="\n".join(commands),
    )


def _inspects(project: Project, there: set[str]) -> bool:
    return "inspection" in there and bool(project.inspection.features)


def _compared(folder: Path, project: Project, record: RunRecord) -> list[_Compared]:
    """The comparisons with artefacts of what was measured, as the rig's history has them, and the air's °C."""
    results = results_folder(folder)
    if not all((results / FILES[name]).exists() for name in CALIBRATED if is_needed(name, project)):
        return []
    calibration, found = read_calibration(results, has_fan=project.rig.has_fan), project_set(folder, project)
    checks, frames = history_of(project.rig, calibration.id).of_calibration(calibration.id), frames_id(found, record)
    return [
        (known, one.celsius) for one in checks if one.pictures_id == frames and (known := one.of_artefact) is not None
    ]


def _lines(
    folder: Path, file: ProjectFile, record: RunRecord, there: set[str], words: Words, compared: Sequence[_Compared]
) -> Iterator[_Line]:
    """The commands in the order of the steps, as far as their results are there."""
    project = file.project
    for step, done in file.results.items():
        if what := changed(done.rests_on, inputs_of(step, project, file.results)):
            yield _Line((), (words(CHANGED, step=step, what=", ".join(words(one) for one in what)),))
    yield _import(folder, project, words)
    settings, channel = record.settings, _option("--channel", project.options.channel or "")
    at = (SET, "--out", OUT)
    if "camera" in there and "camera" in settings:
        told = settings["camera"]
        if IMPORTED in told:
            yield _Line(("import-camera", told[IMPORTED], "--out", OUT))
    if "camera" in there and IMPORTED not in settings.get("camera", {IMPORTED: ""}):
        told = settings["camera"]
        yield _Line(("camera", *at, *_flags("camera", told), *_excluded(told)), _unsaid(words, _camera_unsaid(told)))
    if "planes" in there and "planes" in settings:
        told = settings["planes"]
        adjusted = ("--adjust-camera",) if told.get("camera") == "adjusted" else ()
        few = ("--accept-few-poses",) if told.get("accept_few_poses") or project.options.accept_few_poses else ()
        unsaid = [] if project.options.constrain_fan else [label("planes not held to one pencil")]
        if "calibrated" in there:
            unsaid.append(label("the planes re-adjusted by a check of the day"))
        chosen = (*adjusted, *few, *_flags("profile", told), *channel, *_excluded(told))
        yield _Line(("planes", *at, *chosen), _unsaid(words, unsaid))
    if "cloud" in there and "scan" in settings:
        told = settings["scan"]
        yield _Line(("scan", *at, *_flags("scan", told), *channel, *_excluded(told)))
    if "profile" in there and "profile" in settings:
        told = settings["profile"]
        tilt = (*_option("--stage", told.get("stage") or ""), *_option("--tilt-sd", told.get("tilt_sd_deg") or ""))
        yield _Line(("profile", *at, *tilt, *_flags("profile", told), *channel, *_excluded(told)))
    elif "gauge" in there:
        yield _Line(("gauge", *at))
    if _inspects(project, there):
        yield _Line(("inspect", *at, "--plan", PLAN))
    for one, celsius in compared:
        which = (*_option("--characteristic", one.characteristic), *_option("--celsius", celsius))
        yield _Line(("artefact", *at, "--id", one.artefact.id, *which))
    if "report" in there:
        yield _report(folder, project, words)
    yield _Line((), (words(label("Copies for other programs are not recorded; each is: trisect export DIR -f NAME")),))


def _import(folder: Path, project: Project, words: Words) -> _Line:
    """The pictures, each part from its folder, as a recording set."""
    told: list[str] = []
    remarks: list[str] = []
    for part in ("camera", "planes", "scan"):
        source = source_folder(folder, getattr(project.sources, part))
        if source is not None:
            place = resolved(source)
            told += [f"--{part}", str(place)]
            if place.is_relative_to(resolved(folder)):
                remarks.append(words(LIVE, folder=part))
    if project.sources.check:
        remarks += _unsaid(words, [label("the check of the day")])
    return _Line(("import", SET, *told, "--rig", RIG), tuple(remarks))


def _report(folder: Path, project: Project, words: Words) -> _Line:
    info, choices = project.info, project.report
    told = (
        *_option("--part", part_name(project)),
        *_option("--template", str(folder / choices.template) if choices.template else ""),
        *_option("--language", choices.language),
        *_option("--paper", choices.paper),
        *(word for name in sorted(choices.hidden) for word in ("--without", name)),
        *_option("--serial", info.serial),
        *_option("--customer", info.customer),
        *_option("--operator", info.operator),
        *(word for one in project.studies if one.included for word in ("--study", str(study_path(folder, one.id)))),
    )
    stated = {
        label("laboratory"): info.laboratory,
        label("temperature of the air"): info.air_celsius,
        label("temperature of the part"): info.part_celsius,
        label("remarks"): info.notes,
        label("repeats"): project.repeats,
    }
    unsaid = [name for name, value in stated.items() if value not in ("", None, ())]
    return _Line(("report", SET, "--out", OUT, *told), _unsaid(words, unsaid))


def _unsaid(words: Words, what: Sequence[str]) -> tuple[str, ...]:
    return (words(NOT_SAID, what="; ".join(words(one) for one in what)),) if what else ()


def _camera_unsaid(told: Mapping[str, Any]) -> list[str]:
    fixed = [label("distortion fixed to 0")] if told.get("fixed") else []
    outliers = [label("how outliers are left out")] if told.get("outliers", "gross") != "gross" else []
    return [*fixed, *outliers]


def _flags(step: str, told: Mapping[str, Any]) -> tuple[str, ...]:
    """The flags of a step's settings as run.json has them, those that were left as they are not among them."""
    typed: list[str] = []
    value: Any
    within = ((row, one) for row in settings_of(step) if row.setting.in_file for one in rows_within(row))
    for row, one in within:
        flag, value = one.setting.flag, told
        for name in one.path if row.is_one else one.path[1:]:
            value = value.get(name) if isinstance(value, Mapping) else None  # "automatic" says nothing of its width
        if flag is None or value in (None, ""):
            continue
        yes, _, no = flag.name.partition("/")
        typed += [yes if value else no] if isinstance(value, bool) else [yes, str(value)]
    return tuple(word for word in typed if word)


def _excluded(told: Mapping[str, Any]) -> tuple[str, ...]:
    return tuple(word for name in told.get("excluded", ()) for word in ("--exclude", name))


def _option(name: str, value: object) -> tuple[str, ...]:
    """An option with its value; nothing for an empty text, or where it is not known."""
    return (name, str(value)) if value not in ("", None) else ()


def _with_whole_paths(folder: Path, file: ProjectFile) -> ProjectFile:
    """Nominal surfaces by their whole paths: the plan is read elsewhere."""
    here = resolved(folder)
    return relocated(file, {name: (here / name).as_posix() for name in nominal_names(file.project.inspection)})


def _plain(text: str) -> str:
    """A text as one line of a comment, which ends no string."""
    return " ".join(text.replace("\\", "/").replace('"', "'").split())


def _quoted(text: str) -> str:
    """A text between three double quotes."""
    return text.replace("\\", "\\\\").replace('"""', '\\"\\"\\"')
