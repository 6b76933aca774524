"""The hostile table: what each effect of a real rig does to a thickness, what U says of it, and what is told.

What becomes of a scan is one of STATES. A note or a refusal counts only if its code, or that of a note its text
contains, is among those that name the cause of the effect (`tests.accuracy.hostile_cases.CAUSES`): a rig that warms and
is refused because "something moved" has not been told.
"""

from __future__ import annotations

import json
import shutil
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Any

from core.errors import InputError
from core.files.recording.recording_set import RecordingSet, open_set
from core.files.results.gauge_file import read_gauge
from core.files.results.ply import read_cloud
from core.files.results.run_file import read_run
from core.findings.table import gravest_first
from core.inspect.conformity import Verdict
from core.messages import Message
from core.pipeline.steps.camera_step import camera_step
from core.pipeline.steps.gauge_step import gauge_step
from core.pipeline.steps.planes_step import planes_step
from core.pipeline.steps.scan_step import scan_step
from core.pipeline.steps.workspace import Workspace
from core.simulate.recording import simulate_set
from tests.accuracy.hostile_cases import HostileCase

Figures = dict[str, Any]

UNWARNED_MM = 0.03
"""Largest error of which nothing need be said."""
NOT_CHECKED = "inspection.rig_not_checked"
"""Code of the note that nothing excludes a change of the rig, and how much of U that is. It names no effect."""
STATES = ("held", "unchecked", "unwarned", "told", "not named", "silent")
"""From best to worst. *held*: the error is within U, and told or at most UNWARNED_MM. *unchecked*: within U, but larger
than that, and all that is told is that nobody checked the rig. *unwarned*: not even that is told. *told*: beyond U, or
nothing was measured, but a note or the refusal names why, and nothing is called conforming. *not named*: nothing was
measured, for another reason than the one given. *silent*: beyond U, and proven or not told; then a part just outside
its limits would be accepted, or one within them thrown away."""


OF_EVERY_RIG = frozenset(
    {
        "scan.stability_assumed", "target.flatness_assumed", "target.size_assumed", "scan.scale_weak",
        "scan.scale_fixed", "scan.frames_without_points", "scan.many_frames_without_points",
        "camera.corners_err_together",
    }
)  # fmt: skip
"""Codes told of rigs to which nothing happens: what is assumed, what is counted, and that the corners of a view err
together, as in pictures so small they do."""


def run(cases: Sequence[HostileCase], kept: Path) -> dict[str, Figures]:
    """Figures of every case by its name; those found in the file `kept` (JSON lines) are not measured again."""
    done = _read(kept)
    kept.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="hostile-") as folder, kept.open("a", encoding="utf-8") as lines:
        for case in cases:
            if case.name in done:
                continue
            done[case.name] = figures_of(case, Path(folder))
            lines.write(json.dumps({"name": case.name, **done[case.name]}) + "\n")
            lines.flush()
            print(row_of([case], done), flush=True)
    return {case.name: done[case.name] for case in cases if case.name in done}


def _read(kept: Path) -> dict[str, Figures]:
    if not kept.exists():
        return {}
    rows = [json.loads(line) for line in kept.read_text(encoding="utf-8").splitlines() if line]
    return {row.pop("name"): row for row in rows}


def figures_of(case: HostileCase, folder: Path) -> Figures:
    """Error and U in mm, verdict and codes of what was told of one scan; its calibration is kept in `folder`."""
    begun = time.perf_counter()
    place = folder / case.scenario.key
    try:
        return {**_measured(case, place, folder), "seconds": round(time.perf_counter() - begun, 1)}
    finally:
        shutil.rmtree(place, ignore_errors=True)
        shutil.rmtree(place.with_suffix(".out"), ignore_errors=True)
        shutil.rmtree(place.with_name(f"{place.name}.truth"), ignore_errors=True)


def _measured(case: HostileCase, place: Path, folder: Path) -> Figures:
    scenario = case.scenario
    try:
        calibrated = calibration_in(folder, case)
    except InputError as refused:
        return {"refused": refused.code, "told": sorted({*codes_in(refused.what)}), "first": codes_in(refused.what)}
    simulate_set(scenario, place, calibration_from=calibrated, rig=None)
    out = place.with_suffix(".out")
    shutil.copytree(calibrated.with_suffix(".out"), out)
    work = Workspace.open(_opened(case, place), out)
    try:
        scan_step(work)
        gauge_step(work)
    except InputError as refused:
        first = list(dict.fromkeys([*codes_in(refused.what), *told_codes(out)]))
        return {"refused": refused.code, "told": sorted(first), "first": first}
    gauge = read_gauge(work.path("gauge"), read_cloud(work.path("cloud")).cloud)
    first = told_codes(out)
    return {
        "error": gauge.thickness_mm - scenario.height_mm,
        "U": gauge.U_mm,
        "verdict": str(gauge.verdict),
        "complete": not gauge.doubts,
        "told": sorted(first),
        "first": first,
        "budget": {row.words.code: row.u_mm for row in gauge.budget},
    }


def codes_in(what: Message) -> list[str]:
    """Codes of a message and of all those that its text contains, in the order of its places."""
    found = [what.code]
    for value in what.values.values():
        for one in value if isinstance(value, (list, tuple)) else (value,):
            found += codes_in(one) if isinstance(one, Message) else []
    return found


def told_codes(out: Path) -> list[str]:
    """Codes of the notes of all steps whose results are in the folder `out`, the gravest first, as they are read."""
    notes = gravest_first(note for notes in read_run(out / "run.json").notes.values() for note in notes)
    return list(dict.fromkeys(code for note in notes for code in (*_compared(note), note.code)))


def _compared(note: Message) -> list[str]:
    """Codes of the causes that a note tells with their shares, the likeliest first."""
    return [code for code in codes_in(note) if code.startswith("cause.") and code not in ("cause.first", "cause.next")]


def _opened(case: HostileCase, place: Path) -> RecordingSet:
    """The set, with what the case has stated."""
    recording_set = open_set(place)
    return replace(recording_set, rig=case.stated(recording_set.rig))


def calibration_in(folder: Path, case: HostileCase) -> Path:
    """The set of a case's calibration, calibrated, in `folder`; its results stand beside it, in SET.out."""
    scenario = case.calibration
    place = folder / f"calibrated-{scenario.key}{'' if case.states_size else '-unstated'}"
    out = place.with_suffix(".out")
    if not place.exists():
        for earlier in folder.glob("calibrated-*.out"):  # calibrations come one after another, and are not needed twice
            if calibration_count(folder) >= KEPT_CALIBRATIONS:
                for part in (earlier, earlier.with_suffix(""), earlier.with_suffix(".truth")):
                    shutil.rmtree(part, ignore_errors=True)
        simulate_set(scenario, place)
        work = Workspace.open(_opened(case, place), out)
        try:
            camera_step(work)
            planes_step(work)
        except InputError:
            shutil.rmtree(place)  # or the next case would take what is there for a calibration
            raise
    return place


KEPT_CALIBRATIONS = 20
"""Calibrations kept at a time: three folders each, which go together."""


def calibration_count(folder: Path) -> int:
    """How many calibrations there are."""
    return len(list(folder.glob("calibrated-*.out")))


def state_of(case: HostileCase, figures: Mapping[str, Any]) -> str:
    """What became of a scan: one of STATES."""
    why = named(case, figures)
    if "refused" in figures:
        return "told" if why else "not named"
    if abs(figures["error"]) > figures["U"]:
        proves = figures["verdict"] == Verdict.CONFORMING or figures["complete"]
        return "silent" if proves or not why else "told"
    if why or abs(figures["error"]) <= UNWARNED_MM:
        return "held"
    return "unchecked" if NOT_CHECKED in figures["told"] else "unwarned"


def named(case: HostileCase, figures: Mapping[str, Any]) -> list[str]:
    """Codes that were told and name the cause of the effect."""
    return sorted(case.causes & {*figures["told"], figures.get("refused", "")})


def table(cases: Sequence[HostileCase], results: Mapping[str, Figures]) -> list[str]:
    """The table in Markdown: a line for each effect, strength, and kind of check."""
    lines = [
        "| effect | strength | check | errors, µm | U, µm | verdicts | told | |",
        "|---|---|---|---|---|---|---|---|",
    ]

    def key(case: HostileCase) -> tuple[str, str, bool]:
        return case.effect, case.strength, bool(case.scenario.check_poses)

    order = list(dict.fromkeys((case.effect, case.strength) for case in cases))
    known = [case for case in cases if case.name in results]
    known.sort(key=lambda case: (order.index((case.effect, case.strength)), case.scenario.check_poses))
    return lines + [row_of(list(mine), results) for _, mine in groupby(known, key=key)]


def row_of(mine: Sequence[HostileCase], results: Mapping[str, Figures]) -> str:
    """The line of cases that differ in their seed alone."""
    found = [results[case.name] for case in mine]
    measured = [one for one in found if "error" in one]
    errors = ", ".join(f"{1e3 * one['error']:+.0f}" for one in measured) or "–"
    stated = [1e3 * one["U"] for one in measured]
    spread = "–" if not stated else f"{min(stated):.0f}" if len(stated) == 1 else f"{min(stated):.0f}–{max(stated):.0f}"
    verdicts = ", ".join(
        sorted({one["verdict"] for one in measured} | {"refused" for one in found if "refused" in one})
    )
    codes = {code for case, one in zip(mine, found, strict=True) for code in named(case, one)}
    codes |= {one["refused"] for one in found if "refused" in one}
    states = [state_of(case, one) for case, one in zip(mine, found, strict=True)]
    worst = max(states, key=STATES.index)
    alike = states.count(worst)
    result = worst if alike == len(states) or worst == "held" else f"{worst} {alike} of {len(states)}"
    result = f"**{result}**" if worst in ("silent", "not named") else result
    check = "3 pictures" if mine[0].scenario.check_poses else "none"
    return (
        f"| {mine[0].effect} | {mine[0].strength} | {check} | {errors} | {spread} | {verdicts} "
        f"| {', '.join(f'`{code}`' for code in sorted(codes)) or '–'} | {result} |"
    )


def summary(cases: Sequence[HostileCase], results: Mapping[str, Figures]) -> list[str]:
    """What the whole table comes to."""
    known = [(case, results[case.name]) for case in cases if case.name in results]
    measured = [one for _, one in known if "error" in one]
    held = sum(abs(one["error"]) <= one["U"] for one in measured)
    states = [state_of(case, one) for case, one in known]
    counts = ", ".join(f"{states.count(state)} {state}" for state in STATES)
    silent = [one for case, one in known if "error" in one and not named(case, one) and NOT_CHECKED not in one["told"]]
    unwarned = max((abs(one["error"]) for one in silent), default=0.0)
    return [
        f"{len(known)} scans: {held} of {len(measured)} measured ones within U ({held / max(len(measured), 1):.1%}); "
        f"{counts}; largest error of which nothing is said {1e3 * unwarned:.0f} µm (at most {1e3 * UNWARNED_MM:.0f} "
        "are wanted).",
    ]


def false_alarms(cases: Sequence[HostileCase], results: Mapping[str, Figures]) -> list[str]:
    """How often a fault was told of rigs to which nothing happens."""
    known = [(case, results[case.name]) for case in cases if case.name in results]
    seeds: dict[str, list[int]] = {}
    for case, one in known:
        for code in sorted({*one["told"], *([one["refused"]] if "refused" in one else [])} - OF_EVERY_RIG):
            seeds.setdefault(code, []).append(case.scenario.seed)
    alarmed = {seed for mine in seeds.values() for seed in mine}
    measured = [one for _, one in known if "error" in one]
    in_u = [2 * one["error"] / one["U"] for one in measured]
    held = sum(abs(error) <= 2 for error in in_u)
    return [
        f"{len(known)} rigs to which nothing happens: {held} of {len(measured)} within "
        f"U (RMS of error / u {(sum(e * e for e in in_u) / max(len(in_u), 1)) ** 0.5:.2f}), {len(alarmed)} told of a "
        "fault that they do not have (2 of 100 are wanted).",
        *(f"{code}: seeds {', '.join(map(str, mine))}" for code, mine in sorted(seeds.items())),
    ]
