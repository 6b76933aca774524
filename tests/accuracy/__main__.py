"""`make accuracy`: measure the accuracy table anew, the hostile one, false alarms on ideal rigs, causes told, the
simulated tour, joined views, what assumptions do to sets in order, or whether remedies help.

Long: hours; `--short` takes a few minutes.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import tempfile
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from core.files.atomic import write_text
from tests.accuracy import bounds, coverage, hostile, joints, points
from tests.accuracy import ideal as assumptions
from tests.accuracy.campaign import PROCESSES, Figures, run
from tests.accuracy.cases import FULL, HALF, Case, cases
from tests.accuracy.causes import benign_cases, benign_table, first_cases, first_table
from tests.accuracy.hostile_cases import CHECK_POSES, NOTHING_STATED, SEEDS, hostile_cases
from tests.accuracy.remedies import REMEDIES, after, before, remedies_table
from tests.accuracy.table import between, table, within_2_sigma
from tests.accuracy.tour import tour, tour_table

ROOT = Path(__file__).parents[2]
IDEAL_SEEDS = range(101, 201)
"""Of rigs to which nothing happens, each with a calibration of its own."""
TOURS = range(1, 21)
"""Seeds of the rigs on which the simulated tour is done."""
BEGIN, END = "<!-- accuracy table: make accuracy -->", "<!-- end of the accuracy table -->"


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.accuracy", description=__doc__)
    parser.add_argument(
        "what",
        nargs="?",
        choices=("accuracy", "hostile", "ideal", "benign", "causes", "tour", "joints", "assumptions", "remedies"),
        default="accuracy",
        help="which table",
    )
    parser.add_argument("--short", action="store_true", help="one scan of each kind, at half resolution")
    parser.add_argument("--only", default="", metavar="WORDS", help="of the hostile table, effects called so")
    parser.add_argument("--manual", action="store_true", help="put the table into the manual")
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "accuracy", help="where the figures go")
    parser.add_argument("--processes", type=int, default=PROCESSES)
    parser.add_argument("--scale", type=float, default=0.5, metavar="SHARE", help="picture size of the joints")
    parser.add_argument("--seeds", type=int, default=3, metavar="N", help="how many joints")
    chosen = parser.parse_args()
    commit = _commit()
    if chosen.what == "hostile":
        _hostile(chosen.out, commit, short=chosen.short, only=chosen.only)
        return
    if chosen.what == "ideal":
        known = hostile_cases(0.25, IDEAL_SEEDS, (CHECK_POSES,))
        ideal = [case for case in known if case.effect == "nothing" and case.strength != NOTHING_STATED]
        print("\n".join(hostile.false_alarms(ideal, hostile.run(ideal, chosen.out / f"ideal-{commit}.jsonl"))))
        return
    if chosen.what == "joints":
        with tempfile.TemporaryDirectory(prefix="joints-") as folder:
            print(joints.summary(joints.joints(chosen.scale, chosen.seeds, Path(folder))))
        return
    if chosen.what == "tour":
        _tours(chosen.out / f"tour-{commit}.jsonl")
        return
    if chosen.what == "assumptions":
        found = assumptions.run_all(
            list(assumptions.KINDS), assumptions.SEEDS, chosen.out / f"ideal-own-{commit}.jsonl"
        )
        print("\n".join(assumptions.summary(found)))
        return
    if chosen.what == "remedies":
        both = [case for remedy in REMEDIES for case in (before(remedy), after(remedy))]
        print("\n".join(remedies_table(hostile.run(both, chosen.out / f"remedies-{commit}.jsonl"))))
        return
    if chosen.what in ("benign", "causes"):
        made, table_of = (benign_cases, benign_table) if chosen.what == "benign" else (first_cases, first_table)
        chosen_cases = [case for case in made() if chosen.only in f"{case.effect} {case.strength}"]
        results = hostile.run(chosen_cases, chosen.out / f"{chosen.what}-{commit}.jsonl")
        print("\n".join(table_of(chosen_cases, results)))
        return
    kept = chosen.out / f"{commit}{'-short' if chosen.short else ''}.jsonl"
    scans = cases(short=chosen.short)
    results = run(scans, kept, chosen.processes)
    simulated = coverage.run(60 if chosen.short else 200, seed=1, workers=chosen.processes)
    calibrated = points.run(4 if chosen.short else 24)
    rows = [*table(scans, results), *_points_rows(scans, results, calibrated), *_coverage_rows(simulated)]
    lines = [*rows, "", _origin(scans, commit)]
    lines += ["", "What the pictures allow at best (Cramér–Rao):", "", *bounds.table(bounds.all_bounds())]
    print("\n".join(lines))
    write_text(chosen.out / "table.md", "\n".join(lines) + "\n")
    if chosen.manual:
        _into_manual(lines)


def _tours(kept: Path) -> None:
    """Print the table of the simulated tour; those found in the file `kept` (JSON lines) are not done again."""
    found = [json.loads(line) for line in kept.read_text(encoding="utf-8").splitlines()] if kept.exists() else []
    kept.parent.mkdir(parents=True, exist_ok=True)
    for seed in sorted(set(TOURS) - {one["seed"] for one in found}):
        with tempfile.TemporaryDirectory(prefix="tour-") as folder:
            found.append(tour(seed, Path(folder)))
        with kept.open("a", encoding="utf-8") as lines:
            lines.write(json.dumps(found[-1]) + "\n")
    print("\n".join(tour_table(found)))


def _hostile(out: Path, commit: str, *, short: bool, only: str) -> None:
    """Print the hostile table, and keep it beside the figures; `short`: one seed, with a check."""
    cases = hostile_cases(0.25, SEEDS[:1], (CHECK_POSES,)) if short else hostile_cases(0.25)
    cases = [case for case in cases if only in case.effect]
    results = hostile.run(cases, out / f"hostile-{commit}.jsonl")
    lines = [*hostile.table(cases, results), "", *hostile.summary(cases, results)]
    print("\n".join(lines))
    write_text(out / "hostile.md", "\n".join(lines) + "\n")


def _points_rows(scans: list[Case], results: dict[str, Figures], found: points.Points) -> list[str]:
    """What all rendered scans have shown, each calibration counting once; at half resolution with those of `found`."""
    rows = []
    for size, scale in (("full", FULL), ("half", HALF)):
        shares = within_2_sigma(scans, results, scale)
        if scale == HALF:
            shares = np.concatenate([shares, found.within])
        if len(shares):
            title = f"points within 2σ, each calibration counting once, {size} resolution"
            scatter = f" ± {points.sd_of_mean(shares):.1%}"
            rows.append(_share_row(title, f"{len(shares)} calibrations", shares.mean(), scatter))
    title = f"points, RMS of error / σ, {len(found.within)} of these calibrations, half resolution"
    return [*rows, f"| {title} | {len(found.within)} | – | – | about 1 | {found.normalised:.2f} | |"]


def _coverage_rows(found: coverage.Coverage) -> list[str]:
    """What the simulated centrelines have shown; their calibrations are drawn anew for every scan."""
    scans = len(found.errors_mm)
    return [
        _share_row("simulated lines, &#124;error&#124; ≤ U", f"{scans}", found.within_U),
        _share_row("simulated lines, points within 2σ", f"{scans}", found.points_within),
        f"| simulated lines, RMS of error / u | {scans} | – | – | about 1 | {found.normalised:.2f} | |",
    ]


def _share_row(title: str, of: str, share: float, scatter: str = "") -> str:
    """The row of a share that should be 95 %."""
    kept = "met" if between(0.93, 0.97)(share) else "**missed**"
    return f"| {title} | {of} | – | – | 93–97 % | {share:.1%}{scatter} | {kept} |"


def _origin(scans: list[Case], commit: str) -> str:
    seeds = sorted({case.scenario.seed for case in scans})
    return f"Measured {datetime.now(UTC).date().isoformat()} at commit {commit}, seeds {', '.join(map(str, seeds))}."


def _commit() -> str:
    found = subprocess.run(
        ["git", "rev-parse", "--short", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    return found.stdout.strip() or "unknown"


def _into_manual(lines: list[str]) -> None:
    path = ROOT / "resources" / "manual" / "accuracy.md"
    before, _, rest = path.read_text(encoding="utf-8").partition(BEGIN)
    _, _, after = rest.partition(END)
    write_text(path, "\n".join([before + BEGIN, "", *lines, "", END + after]))


if __name__ == "__main__":
    main()
