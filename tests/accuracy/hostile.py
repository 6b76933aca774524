"""The hostile table: what each effect of a real rig does to a thickness, what U says of it, and what is told.

A thickness is *held* if its error is within U, *told* if it is not, but a note names why and nothing is called
conforming, and **silent** else: then a part just outside its limits would be accepted, or one within them thrown away,
without a word.
"""

from __future__ import annotations

import json
import shutil
import tempfile
import time
from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

from core.errors import InputError
from core.files.recording.recording_set import open_set
from core.files.results.gauge_file import read_gauge
from core.files.results.ply import read_cloud
from core.files.results.run_file import read_run
from core.inspect.conformity import Verdict
from core.pipeline.steps.camera_step import camera_step
from core.pipeline.steps.gauge_step import gauge_step
from core.pipeline.steps.planes_step import planes_step
from core.pipeline.steps.scan_step import scan_step
from core.pipeline.steps.workspace import Workspace
from core.simulate.recording import simulate_set
from core.simulate.scenario import Scenario
from tests.accuracy.hostile_cases import HostileCase, calibration_of

Figures = dict[str, Any]

UNWARNED_MM = 0.03
"""Largest error of which nothing need be said."""
ALWAYS = frozenset(
    {
        "camera.skew_fixed",
        "target.size_assumed",
        "target.flatness_assumed",
        "scan.stability_assumed",
        "scan.datum",
        "scan.frames_without_points",
        "scan.many_frames_without_points",
        "scan.scale_fixed",
        "scan.scale_weak",
    }
)
"""Codes of notes that say nothing of an effect."""


def run(cases: Sequence[HostileCase], kept: Path) -> dict[str, Figures]:
    """Figures of every case by its name; those found in the file `kept` (JSON lines) are not measured again."""
    done = _read(kept)
    kept.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="hostile-") as folder, kept.open("a", encoding="utf-8") as lines:
        for case in cases:
            if case.name in done:
                continue
            done[case.name] = figures_of(case.scenario, Path(folder))
            lines.write(json.dumps({"name": case.name, **done[case.name]}) + "\n")
            lines.flush()
            print(row_of([case], done), flush=True)
    return {case.name: done[case.name] for case in cases if case.name in done}


def _read(kept: Path) -> dict[str, Figures]:
    if not kept.exists():
        return {}
    rows = [json.loads(line) for line in kept.read_text(encoding="utf-8").splitlines() if line]
    return {row.pop("name"): row for row in rows}


def figures_of(scenario: Scenario, folder: Path) -> Figures:
    """Error and U in mm, verdict and codes of what was told of one scan; its calibration is kept in `folder`."""
    begun = time.perf_counter()
    place = folder / scenario.key
    try:
        return {**_measured(scenario, place, folder), "seconds": round(time.perf_counter() - begun, 1)}
    finally:
        shutil.rmtree(place, ignore_errors=True)
        shutil.rmtree(place.with_suffix(".out"), ignore_errors=True)
        shutil.rmtree(place.with_name(f"{place.name}.truth"), ignore_errors=True)


def _measured(scenario: Scenario, place: Path, folder: Path) -> Figures:
    try:
        calibrated = calibration_in(folder, calibration_of(scenario))
    except InputError as refused:
        return {"refused": refused.code, "told": []}
    simulate_set(scenario, place, calibration_from=calibrated, rig=None)
    out = place.with_suffix(".out")
    shutil.copytree(calibrated.with_suffix(".out"), out)
    work = Workspace.open(open_set(place), out)
    try:
        scan_step(work)
        gauge_step(work)
    except InputError as refused:
        return {"refused": refused.code, "told": _told(out)}
    gauge = read_gauge(work.path("gauge"), read_cloud(work.path("cloud")).cloud)
    return {
        "error": gauge.thickness_mm - scenario.height_mm,
        "U": gauge.U_mm,
        "verdict": str(gauge.verdict),
        "complete": gauge.complete,
        "told": _told(out),
        "budget": {row.source.code: row.u_mm for row in gauge.budget},
    }


def _told(out: Path) -> list[str]:
    """Codes of the notes of all steps whose results are in the folder `out`."""
    return sorted({note.code for notes in read_run(out / "run.json").notes.values() for note in notes})


def calibration_in(folder: Path, scenario: Scenario) -> Path:
    """The set of `scenario`, calibrated, in `folder`; its results stand beside it, in SET.out."""
    place = folder / f"calibrated-{scenario.key}"
    out = place.with_suffix(".out")
    if not place.exists():
        for earlier in folder.glob("calibrated-*"):  # calibrations come one after another, and are not needed twice
            if calibration_count(folder) > KEPT_CALIBRATIONS:
                shutil.rmtree(earlier)
        simulate_set(scenario, place)
        work = Workspace.open(open_set(place), out)
        camera_step(work)
        planes_step(work)
    return place


KEPT_CALIBRATIONS = 60
"""Files of calibrations kept at a time: three folders each."""


def calibration_count(folder: Path) -> int:
    """How many folders of calibrations there are."""
    return len(list(folder.glob("calibrated-*")))


def silent(figures: Mapping[str, Any]) -> bool:
    """Whether the result is wrong beyond U and nothing is said of it."""
    if "refused" in figures or abs(figures["error"]) <= figures["U"]:
        return False
    return figures["verdict"] == Verdict.CONFORMING or figures["complete"] or not named(figures)


def named(figures: Mapping[str, Any]) -> list[str]:
    """Codes of the notes that are not told of every scan."""
    return [code for code in figures["told"] if code not in ALWAYS]


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
    codes = {code for one in found for code in named(one)} | {one["refused"] for one in found if "refused" in one}
    wrong = sum(map(silent, found))
    beyond = sum("error" in one and abs(one["error"]) > one["U"] for one in found)
    result = f"**silent** {wrong} of {len(found)}" if wrong else "told" if beyond or not measured else "held"
    check = "3 pictures" if mine[0].scenario.check_poses else "none"
    return (
        f"| {mine[0].effect} | {mine[0].strength} | {check} | {errors} | {spread} | {verdicts} "
        f"| {', '.join(f'`{code}`' for code in sorted(codes)) or '–'} | {result} |"
    )


def summary(results: Iterable[Mapping[str, Any]]) -> list[str]:
    """What the whole table comes to."""
    every = list(results)
    measured = [one for one in every if "error" in one]
    held = sum(abs(one["error"]) <= one["U"] for one in measured)
    unwarned = max((abs(one["error"]) for one in measured if one["complete"] and not named(one)), default=0.0)
    return [
        f"{len(every)} scans: {held} of {len(measured)} measured ones within U ({held / max(len(measured), 1):.1%}), "
        f"{len(every) - len(measured)} refused, {sum(map(silent, every))} silently wrong; largest error of which "
        f"nothing is said {1e3 * unwarned:.0f} µm (at most {1e3 * UNWARNED_MM:.0f} are wanted).",
    ]
