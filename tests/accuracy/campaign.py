"""Renders and measures many scans side by side, keeping what each has shown: a campaign cut off goes on."""

from __future__ import annotations

import json
import shutil
import tempfile
import time
from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from itertools import groupby
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

from core.errors import InputError
from core.files.recording.recording_set import open_set
from core.files.results.ply import read_cloud
from core.files.results.scan_file import read_scan
from core.inspect.gauge import fit_gauge
from core.pipeline.steps.gauge_step import point_errors
from core.pipeline.steps.scan_step import scan_step
from core.pipeline.steps.workspace import Workspace
from core.scan.method import Method
from core.settings.options import Options
from tests.accuracy.cases import Case, calibration_key
from tests.accuracy.twin import Measured, measure
from tests.inspect.sphere_fit import fit_sphere

Figures = dict[str, Any]

PROCESSES = 2


def run(cases: Sequence[Case], kept: Path, processes: int = PROCESSES) -> dict[str, Figures]:
    """Figures of every case by its name; those found in the file `kept` (JSON lines) are not measured again."""
    done = _read(kept)
    waiting = [case for case in cases if case.name not in done]
    batches = [list(batch) for _, batch in groupby(waiting, key=lambda case: calibration_key(case.scenario))]
    kept.parent.mkdir(parents=True, exist_ok=True)
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool, kept.open("a") as lines:
        for finished in as_completed([pool.submit(_batch, batch) for batch in batches]):
            for name, figures in finished.result():
                done[name] = figures
                lines.write(json.dumps({"name": name, **figures}) + "\n")
                lines.flush()
                print(name, json.dumps(figures), flush=True)
    return {case.name: done[case.name] for case in cases}


def _read(kept: Path) -> dict[str, Figures]:
    if not kept.exists():
        return {}
    rows = [json.loads(line) for line in kept.read_text(encoding="utf-8").splitlines() if line]
    return {row.pop("name"): row for row in rows}


def _batch(cases: Iterable[Case]) -> list[tuple[str, Figures]]:
    """Scans that share one calibration, in a folder that is gone afterwards."""
    results: list[tuple[str, Figures]] = []
    with tempfile.TemporaryDirectory(prefix="accuracy-") as folder:
        first: Path | None = None
        for number, case in enumerate(cases):
            begun = time.perf_counter()
            place = Path(folder) / str(number)
            measured = measure(case.scenario, place, first)
            figures = figures_of(measured)
            if case.paper:
                figures["paper"] = _paper(place, measured)
            results.append((case.name, {**figures, "seconds": round(time.perf_counter() - begun, 1)}))
            if first is None:
                first = place
                shutil.rmtree(place / "set" / "scan")
            else:
                shutil.rmtree(place)
    return results


def figures_of(measured: Measured) -> Figures:
    """What one scan has shown, in mm, beside its truth."""
    cloud, thing = measured.cloud, measured.truth.thing
    errors = measured.depth_errors()
    known = np.isfinite(errors)
    on_thing = known & ~measured.truth.table[tuple(np.rint(cloud.uv[:, ::-1]).astype(int).T)]
    stated = np.hypot(cloud.sigma, cloud.sigma_common)
    figures: Figures = {
        "points": len(cloud),
        "median_depth": float(np.median(np.abs(errors[on_thing]))),
        "within_2_sigma": float(np.mean(np.abs(errors[known]) <= 2 * stated[known])),
        "within_2_own_sigma": float(np.mean(np.abs(errors[known]) <= 2 * cloud.sigma[known])),
    }
    if measured.gauge is not None:
        figures["error"] = measured.gauge.thickness_mm - thing["thickness_mm"]
        figures["u"] = measured.gauge.u_mm
        figures["budget"] = {str(row.source): row.u_mm for row in measured.gauge.budget}
    if thing["kind"] == "sphere":
        fit = fit_sphere(cloud, errors=measured.errors)
        figures["error"] = 2 * (fit.radius_mm - thing["radius_mm"])
        figures["u"] = 2 * fit.u_mm
        figures["form"] = fit.form_mm
    return figures


def _paper(place: Path, measured: Measured) -> Figures:
    """The paper's procedure on the same pictures and calibration.

    The paper fits its two planes to what the hand-held laser has scanned; its three-line laser only says where that
    was. So `error_of_sweeps` is of the sweeps' points alone. `error` is with the fan's own points, which this program
    measures too: by them a thickness is good even where hardly any sweep is. Both are better than the paper's procedure
    as it is printed, which knows no σ: here its points are cut at 0.05 mm and weighed by their covariance. Of a block
    of 50 mm at full resolution (seed 1) that leaves 7 % of those on the table; all of them, taken alike, give 49.0 mm,
    for a sheet of light that crosses the fan three times in one line is free to turn about it.
    """
    shutil.copytree(place / "out", place / "paper")
    work = Workspace.open(open_set(place / "set"), place / "paper")
    try:
        scan = scan_step(work, Options(method=Method.THREE_CROSSINGS)).scan
    except InputError as problem:
        return {"why": str(problem)}
    of_sweeps = scan.cloud.sweep >= 0
    beside = Measured(measured.truth, measured.camera, scan.cloud, None, measured.errors)
    errors = beside.depth_errors()
    known = np.isfinite(errors) & of_sweeps
    figures: Figures = {"points": len(scan.cloud), "median_depth": float(np.median(np.abs(errors[known])))}
    if measured.gauge is not None:
        cloud, hang_together = read_cloud(work.path("cloud")).cloud, point_errors(read_scan(work.path("scan")))
        for name, points in (("error_of_sweeps", cloud.select(cloud.sweep >= 0)), ("error", cloud)):
            try:
                thickness = fit_gauge(points, errors=hang_together).thickness_mm
            except InputError as problem:
                figures["why"] = str(problem)
            else:
                figures[name] = thickness - measured.truth.thing["thickness_mm"]
    return figures
