"""What every step's result is made of, as keys that can be compared: so a step knows that it is out of date, and why.

Pure functions of what the user decided. A key is a short text; two keys are equal if nothing that matters is changed.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, is_dataclass, replace
from datetime import datetime
from typing import Any

from core.files.plan.translation import plan_tables
from core.files.project.data import Done, Project, ProjectFile, ReportChoices, Sources
from core.files.recording.rig import as_calibrated_with, part_table, rig_tables
from core.files.step_graph import CALIBRATED, IN_PROJECT, OF_FAN
from core.inspect.plan.feature_spec import FeatureSpec
from core.messages import label
from core.settings.options import settings_of
from core.settings.setting import rows_within

STEPS = tuple(step.name for step in IN_PROJECT)
"""The steps that have a result, in the order of work."""

Keys = Mapping[str, str]
"""Name of an input, fixed words of the catalogues → its key."""


def inputs_of(step: str, project: Project, results: Mapping[str, Done]) -> dict[str, str]:
    """Compute the key (hash or id) of every input, by its name, that the result of `step` would rest on if made now.

    Which results these are, the graph of steps says; the rest are the step's own pictures and settings. `results` are
    the finished ones: what is inspected and reported is the scan that was measured, however the project has changed
    since.

    Raises
    ------
    ValueError
        If there is no such step.
    """
    if step not in _OWN:
        raise ValueError(f"{step} is none of {', '.join(STEPS)}")
    known = {**asdict(project.accepted), **{name: done.key for name, done in results.items() if name not in CALIBRATED}}
    return {**{_MADE[name]: known.get(name, "") for name in _made_of(step, project)}, **_OWN[step](project)}


def is_needed(step: str, project: Project) -> bool:
    """Whether a project can need `step` at all: without a fan there is none to calibrate or to check."""
    return project.rig.has_fan or step not in OF_FAN


def _made_of(step: str, project: Project) -> tuple[str, ...]:
    """The steps of a project whose results the result of `step` is made of, or shows."""
    graph = next(each for each in IN_PROJECT if each.name == step)
    return tuple(name for name in (*graph.rests_on, *graph.shows) if name in _MADE and is_needed(name, project))


def changed(before: Keys, now: Keys) -> tuple[str, ...]:
    """List the names of inputs whose keys differ between `before` and `now`; a missing input counts as key ""."""
    names = dict.fromkeys((*now, *before))
    return tuple(name for name in names if before.get(name, "") != now.get(name, ""))


def up_to_date(step: str, project: Project, results: Mapping[str, Done]) -> bool:
    """Whether `step` has a result, and all inputs it rests on are still the same."""
    done = results.get(step)
    return done is not None and not changed(done.rests_on, inputs_of(step, project, results))


def left_to_do(project: Project, results: Mapping[str, Done]) -> tuple[str, ...]:
    """List the steps to do before the report is there and up to date, in the order of work.

    A calibration that was accepted without pictures of the project stands; a thickness that could not be measured on
    the scan is not tried again.
    """
    sources, accepted = project.sources, project.accepted
    pictures = {
        "camera": sources.camera or not accepted.camera,  # where both are missing, the step says what is wanted
        "planes": sources.planes or not accepted.planes,
        "check": sources.check,
        "scan": True,
    }
    requests = {"gauge": "gauge" in results, "inspection": project.inspection.features}
    there, asked = ([name for name, one in which.items() if one] for which in (pictures, requests))
    wanted = (step.name for step in IN_PROJECT if step.is_requested(there, asked) and is_needed(step.name, project))
    return tuple(step for step in wanted if not up_to_date(step, project, results))


def finished(step: str, project: Project, results: Mapping[str, Done], at: datetime | None = None) -> Done:
    """Make the record that `step` was just finished with `project` as it is, at the time `at` (None: now)."""
    keys = inputs_of(step, project, results)
    return Done(_digest(keys), keys, at or datetime.now().astimezone())


def with_outdated(step: str, results: Mapping[str, Done]) -> dict[str, Done]:
    """Mark as out of date all `results` that rest on the result of `step`, as it was made anew under the same name."""
    anew, results = {_MADE[step]}, dict(results)
    for name in STEPS:
        done = results.get(name)
        if done is not None and anew.intersection(done.rests_on):
            keys = {of: "" if of in anew else key for of, key in done.rests_on.items()}
            results[name] = replace(done, key=_digest(keys), rests_on=keys)
            anew |= {_MADE[name]} if name in _MADE else set()
    return results


_MADE: Mapping[str, str] = {
    "camera": label("camera calibration"), "planes": label("laser planes"), "scan": label("scan"),
    "gauge": label("thickness"), "inspection": label("features"),
}  # fmt: skip
"""What the steps that rest on a result call it, by the step that makes it."""

FOUND_BY: Mapping[str, tuple[str, ...]] = {
    "camera": (label("pictures of the camera target"), label("camera target"), label("colour channel")),
    "planes": (
        label("camera calibration"), label("pictures of the plane target"), label("plane target"),
        label("colour channel"), label("stripes on the plane target"),
    ),
}  # fmt: skip
"""Of what a calibration rests on, that which decides what is found in its pictures; the last only where it is given."""

ACCEPTED: Mapping[str, str] = {
    "camera": label("accepted camera calibration"), "planes": label("accepted laser planes"),
}  # fmt: skip
"""Of what a calibration rests on, that which decides only whether it is accepted."""


def relocated(file: ProjectFile, moved: Mapping[str, str]) -> ProjectFile:
    """Replace the paths in a project by those they were `moved` to: pictures, nominal surfaces, report template.

    Results stay as up to date as they are: the keys of those that rest on a name change with it, and so do those of
    what rests on these.
    """
    if not moved:
        return file
    before = file.project
    sources = {name: moved.get(stored, stored) for name, stored in asdict(before.sources).items()}
    after = replace(
        before,
        sources=Sources(**sources),
        inspection=replace(before.inspection, features=tuple(_moved(one, moved) for one in before.inspection.features)),
        report=replace(before.report, template=moved.get(before.report.template, before.report.template)),
    )
    renamed, results = dict(moved), dict(file.results)
    for step in STEPS:
        if (done := results.get(step)) is not None:
            old, new = inputs_of(step, before, file.results), inputs_of(step, after, results)
            keys = {
                name: new.get(name, key) if key and old.get(name) == key else renamed.get(key, key)
                for name, key in done.rests_on.items()
            }
            if keys != dict(done.rests_on):
                renamed[done.key] = _digest(keys)
                results[step] = replace(done, key=_digest(keys), rests_on=keys)
    return replace(file, project=after, results=results)


def _moved(spec: FeatureSpec, moved: Mapping[str, str]) -> FeatureSpec:
    if spec.deviation is None:
        return spec
    return replace(
        spec, deviation=replace(spec.deviation, nominal=moved.get(spec.deviation.nominal, spec.deviation.nominal))
    )


def _camera(project: Project) -> dict[str, str]:
    return {
        label("pictures of the camera target"): project.sources.camera,
        label("camera target"): _digest(as_calibrated_with(rig_tables(project.rig)["camera_target"])),
        label("colour channel"): project.rig.channel_of("camera") or "",
        label("left-out views"): _left_out(project, "camera"),
        label("camera settings"): _settings(project, "camera"),
        label("accepted camera calibration"): _whether(project.accepted.camera),
    }


def _planes(project: Project) -> dict[str, str]:
    tables = rig_tables(project.rig)
    adjusted = {label("adjustment of the camera"): str(True)} if project.options.adjust_camera else {}
    stripe = project.options.plane_stripe
    stated = {label("stripes on the plane target"): _digest([stripe.width_px, stripe.contrast])} if stripe else {}
    return {
        label("pictures of the plane target"): project.sources.planes,
        label("plane target"): _digest(as_calibrated_with(tables["plane_target"])),
        label("laser"): _digest(tables.get("laser_fan")),
        label("colour channel"): project.rig.channel_of("planes") or "",
        label("left-out poses"): _left_out(project, "planes"),
        label("constraint of the fan"): str(project.options.constrain_fan),
        **adjusted,
        **stated,
        label("accepted laser planes"): _whether(project.accepted.planes),
    }


def _check(project: Project) -> dict[str, str]:
    tables, stripe = rig_tables(project.rig), project.options.plane_stripe
    return {
        label("pictures of the interim check"): project.sources.check,
        label("plane target"): _digest(as_calibrated_with(tables["plane_target"])),
        label("colour channel"): project.rig.channel_of("planes") or "",
        label("stripes on the plane target"): _digest([stripe.width_px, stripe.contrast]) if stripe else "",
        label("stability of the rig"): _digest(tables.get("stability")),
        **_air(project),
    }


def _scan(project: Project) -> dict[str, str]:
    tables = rig_tables(project.rig)
    stability, camera, validity = (tables.get(name) for name in ("stability", "camera", "validity"))
    stated = {label("stability of the rig"): _digest(stability)} if stability else {}
    stated |= {label("validity of calibration and check"): _digest(validity)} if validity else {}
    stated |= {label("row time of the camera"): _digest(camera)} if camera else {}
    stated |= _air(project)
    if project.sources.check:
        stated[label("pictures of the interim check")] = project.sources.check
    if project.rig.known_planes:
        stated[label("known planes")] = _digest(tables["known_planes"])
    return {
        label("recording"): project.sources.scan,
        label("colour channel"): project.rig.channel_of("scan") or "",
        label("left-out frames"): _left_out(project, "scan"),
        label("scan settings"): _settings(project, "scan"),
        **stated,
    }


def _air(project: Project) -> dict[str, str]:
    """How warm it was, where that says how far the rig may have changed."""
    tables = rig_tables(project.rig)
    stability, air = tables.get("stability", {}), tables.get("air", {})
    matters = "per_kelvin" in stability or "per_hour" in stability or "calibrated_celsius" in air
    return {label("temperature of the air"): _digest([air, project.info.air_celsius])} if matters else {}


def _gauge(project: Project) -> dict[str, str]:
    gauge = rig_tables(project.rig).get("gauge", {})
    return {
        label("thickness regions"): _digest([gauge.get("upper_polygon_px"), gauge.get("lower_polygon_px")]),
        label("nominal thickness"): _digest([gauge.get("nominal_mm"), gauge.get("tolerance_mm")]),
        **_part(project),
    }


def _inspection(project: Project) -> dict[str, str]:
    return {
        label("features"): _digest(plan_tables(project.inspection)),
        **_part(project),
    }


def _part(project: Project) -> dict[str, str]:
    """What is stated of the part and of the target's temperature, if anything is."""
    stated = part_table(project.rig.part)
    return {label("material and temperature of the part"): _digest(stated)} if stated else {}


def _report(project: Project) -> dict[str, str]:
    studies = [study.id for study in project.studies if study.included]
    return {
        **({label("studies"): _digest(studies)} if studies else {}),
        label("project fields"): _digest(asdict(project.info)),
        label("repeats"): _digest([[*repeat.values.values()] for repeat in project.repeats]),
        label("sections of the report"): _digest([sorted(project.report.hidden), *_printing(project.report)]),
    }


def _printing(report: ReportChoices) -> list[str]:
    """Paper, and what else is not as usual: reports made before there was a choice stay up to date."""
    return [report.paper, *(one for one in (report.language, report.template) if one not in ("en", ""))]


def _settings(project: Project, step: str) -> str:
    """What the project says of a step's settings: those of the first version always, others where they are stated."""
    options = project.options
    within = [one for row in settings_of(step) for one in (rows_within(row) if not row.is_one else (row,))]
    listed = [_plain(one.value(options)) for one in within if one.setting.keyed]
    stated = {
        one.key: _plain(one.value(options))
        for one in within
        if one.setting.in_file and not one.setting.keyed and one.value(options) != one.default
    }
    return _digest([*listed, stated] if stated else listed)


def _plain(value: Any) -> Any:
    if isinstance(value, frozenset):
        return sorted(value)
    return [*asdict(value).values()] if is_dataclass(value) and not isinstance(value, type) else value


def _left_out(project: Project, part: str) -> str:
    names = project.options.excluded_in(part)
    return _digest(names) if names else ""


def _whether(id_: str) -> str:
    """Any calibration will do: which one it is, the next step minds."""
    return "yes" if id_ else ""


def _digest(value: Any) -> str:
    """Twelve hex digits that name `value`."""
    text = json.dumps(value, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()[:12]


_OWN: Mapping[str, Callable[[Project], dict[str, str]]] = {
    "camera": _camera,
    "planes": _planes,
    "check": _check,
    "scan": _scan,
    "gauge": _gauge,
    "inspection": _inspection,
    "report": _report,
}
"""What each step of a project is made of besides the results of others."""
