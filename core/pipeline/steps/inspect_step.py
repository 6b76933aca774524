"""Inspection step: a scan and a plan → inspection.json."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from core.errors import InputError
from core.files.atomic import ANOTHER_OUT, make_folder
from core.files.plan.translation import plan_tables
from core.files.reading import file_hash
from core.files.recording.recording_set import RIG
from core.files.recording.rig import part_of, read_rig
from core.files.results.inspection_file import write_inspection
from core.files.results.nominal_surface import read_nominals
from core.files.results.ply import read_cloud, read_mesh
from core.files.results.run_file import read_run
from core.files.results.scan_file import read_scan
from core.files.step_graph import FILES
from core.inspect.evaluate import Inspection, evaluate
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.uncertainty.part import Part
from core.inspect.uncertainty.point_errors import PointErrors
from core.messages import Command, Message
from core.pipeline.steps.gauge_step import PART, point_errors
from core.progress import Progress, silent
from core.scan.surface.cloud import Cloud
from core.scan.surface.fused_surface import Mesh


@dataclass(frozen=True, eq=False, slots=True)
class InspectedScan:
    """Scan to be inspected: its cloud and mesh, how its errors hang together, and what is known of its part.

    Parameters
    ----------
    cloud, mesh
        The points, and the surface over them if there is one.
    errors
        How the points' errors hang together; None: not known, of a cloud without its scan.
    calibration_id
        Of the cloud.
    folder
        Of the results it is among; None for a cloud that was given by itself.
    """

    cloud: Cloud
    mesh: Mesh | None
    errors: PointErrors | None
    calibration_id: str
    folder: Path | None = None


def open_scan(source: Path, results: Path | None = None) -> InspectedScan:
    """Read the scan to be inspected from a folder of results, a recording set or a cloud.ply.

    Parameters
    ----------
    source
        A folder of results, a recording set whose `results` lie elsewhere, or a cloud.ply: alone, or among its results.
        What a recording set's rig.toml states of the part counts, else what it stated when the thickness was measured.
    results
        Of a recording set.

    Raises
    ------
    InputError
        If there is no scan, it is damaged, or its files are not of each other.
    """
    if source.is_dir():
        scan = _of_results(_results_of(source, results))
        if scan.errors is None or not (source / RIG).is_file():
            return scan
        return replace(scan, errors=replace(scan.errors, part=read_rig(source / RIG).part))
    file = read_cloud(source)
    beside = source.parent
    if source.name == FILES["cloud"] and (beside / FILES["scan"]).is_file():
        return _of_results(beside)
    return InspectedScan(file.cloud, None, None, file.calibration_id)


def inspect(
    scan: InspectedScan,
    plan: InspectionPlan,
    nominals: Path,
    progress: Progress = silent,
    previous: Inspection | None = None,
) -> Inspection:
    """Measure the features of a plan on a scan; `nominals` is the folder of the nominal surfaces it names.

    Raises
    ------
    InputError
        If the plan is wrong, or a nominal surface cannot be read.
    """
    plan.ordered()
    surfaces = read_nominals(plan, nominals, progress)
    return evaluate(plan, scan.cloud, scan.mesh, scan.errors, progress, previous, nominals=surfaces)


def inspect_step(
    source: Path,
    plan: InspectionPlan,
    nominals: Path,
    out: Path | None = None,
    progress: Progress = silent,
) -> tuple[Inspection, Path | None]:
    """Measure the features of a plan on a scan and write inspection.json, into `out` or among its results.

    Parameters
    ----------
    source
        As for `open_scan`.
    plan, nominals
        As for `inspect`.
    out
        The folder of a recording set's results, or where the inspection goes; None: nowhere for a cloud.
    progress
        Called with how far it is; may raise Cancelled.

    Returns
    -------
    Inspection, Path or None
        The path of inspection.json, if it was written.

    Raises
    ------
    InputError
        If there is no scan, `out` holds the results of another one, the plan is wrong, no feature could be measured, or
        nothing can be written.
    """
    if out is not None:
        _check_results_of(out, source)
    scan = open_scan(source, out)
    inspection = inspect(scan, plan, nominals, progress)
    if plan.features and not inspection.characteristics and inspection.problems:
        first = inspection.problems[0].values
        raise InputError(
            Message(
                "inspection.nothing_measured",
                "nothing could be measured: {where}: {what}",
                where=first["where"],
                what=first["what"],
            ),
            where=source,
            todo=first.get("todo", ""),
        )
    folder = out or scan.folder
    if folder is None:
        return inspection, None
    path = make_folder(folder) / FILES["inspection"]
    write_inspection(path, inspection, scan.calibration_id, plan_tables(plan))
    return inspection, path


def _check_results_of(out: Path, source: Path) -> None:
    """InputError if `out` holds results of another scan than `source`: one verdict would be given on two parts.

    A recording set without results has those in `out`. A copy of the same cloud is the same scan.
    """
    cloud = source / FILES["cloud"] if source.is_dir() else source
    results = [out / FILES[name] for name in ("cloud", "profiles", "gauge") if (out / FILES[name]).is_file()]
    if results and cloud.is_file() and file_hash(cloud) not in map(file_hash, results):
        raise InputError(
            Message("inspection.out_of_other_scan", "holds the results of another scan than {source}", source=source),
            where=out,
            todo=ANOTHER_OUT,
        )


def _part_in(folder: Path) -> Part:
    """What was stated of the part when its thickness was measured, or looked for; nothing if that is not known."""
    path = folder / FILES["run"]
    settings = read_run(path).settings if path.is_file() else {}
    table = settings.get("gauge", {}).get(PART, {})
    return part_of(table, path) if isinstance(table, Mapping) else Part()


def _results_of(source: Path, results: Path | None) -> Path:
    """The folder of results that is meant."""
    if (source / FILES["cloud"]).is_file():
        return source
    if results is None:
        what = (
            Message("inspection.recording_set_without_results", "a recording set has no results in it")
            if (source / RIG).is_file()
            else Message("inspection.no_results_folder", "there is no {files}", files=FILES["cloud"])
        )
        raise InputError(
            what, where=source, todo=Message("advice.name_results_folder", "name the folder of its results with --out")
        )
    return results


def _of_results(folder: Path) -> InspectedScan:
    cloud, scan = read_cloud(folder / FILES["cloud"]), read_scan(folder / FILES["scan"])
    if cloud.calibration_id and scan.calibration_id and cloud.calibration_id != scan.calibration_id:
        raise InputError(
            Message(
                "inspection.other_calibration",
                "was measured with calibration {calibration_id}, but {files} with {calibration_id2}",
                calibration_id=cloud.calibration_id,
                files=FILES["scan"],
                calibration_id2=scan.calibration_id,
            ),
            where=folder / FILES["cloud"],
            todo=Message(
                "advice.scan_again",
                "measure the scan again{command}",
                command=Command("trisect scan SET --out DIR"),
            ),
        )
    mesh = folder / FILES["mesh"]
    return InspectedScan(
        cloud.cloud,
        read_mesh(mesh) if mesh.is_file() else None,
        replace(point_errors(scan), part=_part_in(folder)),
        cloud.calibration_id,
        folder,
    )
