"""The inspection of a project: its plan, measured on the scan among its results, written there and shown."""

from __future__ import annotations

from collections.abc import MutableMapping
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

import numpy as np

from core.files.plan.translation import plan_tables
from core.files.project.data import Project
from core.files.project.folder import results_folder
from core.files.project.witness import Written, witnessed
from core.files.results.inspection_file import write_inspection
from core.files.results.shown_file import read_shown, write_shown
from core.files.step_graph import FILES
from core.inspect.evaluate import Inspection
from core.inspect.features.measured import FeatureResult
from core.inspect.profile import Profile
from core.inspect.shown.deviation_map import QUARTERS, DeviationMap, bounds, mark
from core.inspect.shown.shown_features import ShownClass, ShownDeviations, ShownFeature, ShownInspection, ShownProfile
from core.pipeline.steps.inspect_step import InspectedScan, inspect, open_scan
from core.progress import Progress, silent
from core.scan.surface.cloud import Cloud

MOST_DRAWN = 20_000
"""So many of the points that a feature used are drawn."""

MOST_TRIANGLES = 20_000
"""So many of a nominal surface's triangles: it is seen through anyway, and more would be slow to turn."""

Memory: TypeAlias = MutableMapping[str, Inspection]
LAST = "last inspection"
"""Its name in the memory: only of the last one, which knows by its keys what is still true."""


def measure_features(
    folder: Path, project: Project, progress: Progress = silent, memory: Memory | None = None
) -> ShownInspection:
    """Measure the features of the project's plan on its scan, and write inspection.json among its results.

    The same numbers as `trisect inspect RESULTS --plan plan.toml` with the same plan; names of nominal surfaces are of
    the project's folder. A feature that cannot be measured has its problem; the others are measured.

    Parameters
    ----------
    memory
        Holds the last inspection from one call to the next: features it has of the same inputs are not measured again.

    Raises
    ------
    InputError
        If there is no scan among the results, the plan is wrong, or a nominal surface cannot be read.
    """
    inspection, scan = _inspected(folder, project, progress, memory)
    path, shown = results_folder(folder) / FILES["inspection"], _shown(inspection, scan)
    with witnessed(folder, Written("measured")):
        write_inspection(path, inspection, scan.calibration_id, plan_tables(project.inspection))
        write_shown(path, shown)
    return shown


def look_at_features(
    folder: Path, project: Project, progress: Progress = silent, memory: Memory | None = None
) -> ShownInspection:
    """Read the measured features of the project's plan for display; measure them, writing nothing, if out of date."""
    progress("features", 0, 1)
    kept = read_shown(results_folder(folder) / FILES["inspection"], plan_tables(project.inspection))
    return kept or _shown(*_inspected(folder, project, progress, memory))


def _inspected(
    folder: Path, project: Project, progress: Progress, memory: Memory | None
) -> tuple[Inspection, InspectedScan]:
    scan, last = open_scan(results_folder(folder)), None if memory is None else memory.get(LAST)
    if scan.errors is not None:
        scan = replace(scan, errors=replace(scan.errors, part=project.rig.part))
    inspection = inspect(scan, project.inspection, folder, progress, last)
    if memory is not None:
        memory[LAST] = inspection
    return inspection, scan


def _shown(inspection: Inspection, scan: InspectedScan) -> ShownInspection:
    features = tuple(_feature(result, scan.cloud) for result in inspection.results)
    return ShownInspection(
        features, inspection.unmeasured, inspection.notes, scan.calibration_id, inspection.pose_camera_part
    )


def _feature(result: FeatureResult, cloud: Cloud) -> ShownFeature:
    section = result.spec.section
    sample = result.indices[:: max(1, -(-len(result.indices) // MOST_DRAWN))]
    return ShownFeature(
        name=result.spec.name,
        kind=result.spec.kind,
        rows=result.characteristics,
        used=len(result.indices),
        places=cloud.points[sample].astype(np.float32),
        uv=cloud.uv[sample].astype(np.float32),
        problem=result.problem,
        profile=None if result.profile is None or section is None else _profile(result.profile, section.step_mm),
        deviations=None if result.deviations is None else _deviations(result.deviations),
    )


def _profile(profile: Profile, step_mm: float) -> ShownProfile:
    means = profile.mean_position, profile.mean_height
    return ShownProfile.of(profile.position, profile.height, means, step_mm, MOST_DRAWN)


def _deviations(found: DeviationMap) -> ShownDeviations:
    numbers, most = found.classes, -(-len(found.points) // MOST_DRAWN)
    classes = []
    for number in range(-len(QUARTERS), len(QUARTERS) + 1):
        mine = np.flatnonzero(numbers == number)
        low, high = bounds(number, found.tolerance_mm)
        places = found.points[mine[:: max(1, most)]].astype(np.float32)
        classes.append(ShownClass(mark(number), number, low, high, len(mine) / max(1, len(numbers)), places))
    nominal = found.nominal[:: max(1, -(-len(found.nominal) // MOST_TRIANGLES))].astype(np.float32)
    return ShownDeviations(tuple(classes), *found.histogram(), found.tolerance_mm, nominal)
