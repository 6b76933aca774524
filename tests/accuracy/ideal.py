"""Sets with which nothing is wrong: does an assumption move their thickness, and does it beat a plain fit?

    python -m tests.accuracy assumptions

Each set has a calibration of its own. The plain fit is that of two parallel planes through the points of the faces that
the program found, all points alike: it knows of no noise, no covariance and nothing that is assumed.
"""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from core.files.results.ply import read_cloud
from core.inspect.results import GaugeResult
from core.model.arrays import Array
from core.pipeline.run import run
from core.scan.surface.cloud import Cloud
from core.simulate.effects.transport import Transport
from core.simulate.recording import simulate_set
from core.simulate.scenario import Scenario
from tests.accuracy.hostile_cases import base

Figures = dict[str, Any]

SEEDS = range(501, 521)
"""Of the sets, each with a calibration of its own."""
KINDS: Mapping[str, Mapping[str, Any]] = {
    "nothing stated": {},
    "stated": {"stated": True},
    "as path-traced, nothing stated": {"transport": Transport(window_deg=20.0, hand_mm=80.0, bounced=True)},
}


def scenario_of(kind: str, seed: int, scale: float = 0.5) -> Scenario:
    """The set of a kind."""
    return replace(base(scale), seed=seed, **KINDS[kind])


def plain_thickness(cloud: Cloud, gauge: GaugeResult) -> float:
    """Distance in mm of two parallel planes through the points of the gauge's two faces, all alike."""
    upper, lower = (cloud.points[face.indices] for face in (gauge.upper, gauge.lower))
    about = np.vstack([upper - upper.mean(axis=0), lower - lower.mean(axis=0)])
    normal = np.linalg.svd(about, full_matrices=False)[2][2]
    return float(abs((upper.mean(axis=0) - lower.mean(axis=0)) @ normal))


def figures_of(kind: str, seed: int, folder: Path, scale: float = 0.5) -> Figures:
    """Error of the thickness and of the plain fit, and U, in mm, of one set; its pictures go into `folder`."""
    scenario = scenario_of(kind, seed, scale)
    simulate_set(scenario, folder / "set")
    found = measured(folder / "set", folder / "out", scenario.height_mm)
    return {"kind": kind, "seed": seed, **found}


def measured(recording: Path, out: Path, height_mm: float) -> Figures:
    """The same of the set in a folder."""
    gauge = run(recording, out).gauge
    assert gauge is not None
    plain = plain_thickness(read_cloud(out / "cloud.ply").cloud, gauge)
    return {"error": gauge.thickness_mm - height_mm, "plain": plain - height_mm, "U": gauge.U_mm}


def run_all(kinds: Sequence[str], seeds: Sequence[int], kept: Path, scale: float = 0.5) -> list[Figures]:
    """Figures of all sets; those found in the file `kept` (JSON lines) are not measured again."""
    found = [json.loads(line) for line in kept.read_text(encoding="utf-8").splitlines()] if kept.exists() else []
    done = {(one["kind"], one["seed"]) for one in found}
    kept.parent.mkdir(parents=True, exist_ok=True)
    for kind in kinds:
        for seed in seeds:
            if (kind, seed) in done:
                continue
            folder = Path(tempfile.mkdtemp(prefix="ideal-"))
            try:
                found.append(figures_of(kind, seed, folder, scale))
            finally:
                shutil.rmtree(folder, ignore_errors=True)
            with kept.open("a", encoding="utf-8") as lines:
                lines.write(json.dumps(found[-1]) + "\n")
    return found


def summary(found: Sequence[Figures]) -> list[str]:
    """A line for each kind: mean and RMS error, that of the plain fit, U, and how many are within it."""
    lines = [
        "| sets | number | mean error ± its standard error, µm | RMS, µm | plain fit, µm | U, µm | within U |",
        "|---" * 7 + "|",
    ]
    for kind in dict.fromkeys(one["kind"] for one in found):
        mine = [one for one in found if one["kind"] == kind]
        error, plain, expanded = (1e3 * np.array([one[name] for one in mine]) for name in ("error", "plain", "U"))
        of_mean = error.std(ddof=1) / np.sqrt(len(mine)) if len(mine) > 1 else float("nan")
        within = int(np.sum(np.abs(error) <= expanded))
        lines.append(
            f"| {kind} | {len(mine)} | {error.mean():+.1f} ± {of_mean:.1f} | {_rms(error):.1f} | {_rms(plain):.1f} | "
            f"{np.median(expanded):.0f} | {within} |"
        )
    return lines


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
