"""What works on files: clouds, recording sets, whole runs, reports."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from core.files.recording import recording_set
from core.files.recording.recording_set import RecordingSet
from core.files.results import ply
from core.pipeline import run as whole_run
from core.pipeline.run import RunResult
from core.pipeline.steps.join_step import JoinResult as JoinedViews
from core.pipeline.steps.join_step import join_step
from core.pipeline.steps.report_step import report_step
from core.pipeline.steps.workspace import Workspace
from core.progress import Progress, silent
from core.scan.surface.cloud import Cloud
from core.settings.options import Options
from core.simulate.recording import simulate_set
from core.simulate.scenario import Scenario


def read_cloud(path: str | Path) -> Cloud:
    """Read the points of a cloud.ply with their normals, σ, intensity and frame; in mm.

    Returns
    -------
    Cloud
        n points (n, 3) in mm in the camera's frame, with σ.

    Raises
    ------
    InputError
        If the file is missing, damaged, or no cloud of this program.

    Examples
    --------
    >>> path = write_cloud(place / "cloud.ply", flat)
    >>> len(read_cloud(path)) == len(flat)
    True
    """
    return ply.read_cloud(Path(path)).cloud


def write_cloud(path: str | Path, cloud: Cloud, *, calibration_id: str = "") -> Path:
    """Write a cloud as a binary PLY: x y z nx ny nz sigma intensity frame, in mm.

    Parameters
    ----------
    path
        Where to; an older file is replaced in one step.
    cloud
        n points.
    calibration_id
        What the file says of the calibration that the points were measured with.

    Returns
    -------
    Path
        Of the file.

    Raises
    ------
    InputError
        If it cannot be written; nothing half written stays.

    Examples
    --------
    >>> write_cloud(place / "cloud.ply", flat).name
    'cloud.ply'
    """
    ply.write_cloud(Path(path), cloud, calibration_id)
    return Path(path)


def open_set(folder: str | Path) -> RecordingSet:
    """Open a recording set: list and check it without decoding its pictures.

    Returns
    -------
    RecordingSet
        `camera` and `frames` are paths, `planes` pairs of them (`on`, `off`), `reference` a path or None, `rig` what
        rig.toml says.

    Raises
    ------
    InputError
        If the folder is missing or empty, rig.toml is wrong, or the pictures differ in size.

    Examples
    --------
    >>> opened = open_set(place / "set")
    >>> len(opened.camera), len(opened.planes), len(opened.frames)
    (6, 4, 8)
    """
    return recording_set.open_set(Path(folder))


def run(
    folder: str | Path, out: str | Path, *, options: Options | None = None, progress: Progress = silent
) -> RunResult:
    """Measure a recording set and write all results to `out`: calibrations, cloud, mesh, thickness, report.

    Parameters
    ----------
    folder
        The recording set.
    out
        Where the results go; made if it is not there.
    options
        Method and cuts; None: the usual ones.
    progress
        Called with how far it is.

    Returns
    -------
    RunResult
        What all steps gave; the files are in `out`.

    Raises
    ------
    InputError
        If anything keeps the set from being measured; what was finished before stays, whole.

    Examples
    --------
    >>> result = run(place / "set", place / "out", options=Options(sigma_cut_mm=0.3))
    >>> round(result.gauge.thickness_mm)
    50
    """
    return whole_run.run(Path(folder), Path(out), options, progress)


def simulate(folder: str | Path, *, progress: Progress = silent, **scenario: Any) -> RecordingSet:
    """Render a recording set of the simulated rig into `folder`, and its true values into FOLDER.truth.

    Parameters
    ----------
    folder
        Must not hold anything yet.
    progress
        Called after each picture.
    scenario
        What to simulate: `frames`, `camera_views`, `plane_poses`, `scale` (picture size over 3840 × 2748), `height_mm`,
        `seed` and the other fields that `trisect simulate` has as options.

    Returns
    -------
    RecordingSet
        The set, opened. The same scenario gives the same bytes.

    Raises
    ------
    InputError
        If the folder is not empty or cannot be written to, or a value is absurd.

    References
    ----------
    The rig of the paper, section 3.1.

    Examples
    --------
    >>> made = simulate(place / "twin", scale=0.1, frames=1, camera_views=1, plane_poses=1)
    >>> len(made.frames)
    1
    """
    simulate_set(Scenario(**scenario), Path(folder), progress)
    return open_set(folder)


def report(folder: str | Path, out: str | Path, *, progress: Progress = silent) -> Path:
    """Write report.pdf from the results of a recording set in `out`, and return its path.

    Parameters
    ----------
    folder
        The recording set.
    out
        The folder with its results.
    progress
        Called with how far it is.

    Returns
    -------
    Path
        Of the report.

    Raises
    ------
    InputError
        If a result is missing, damaged, or of another calibration.

    Examples
    --------
    >>> report(place / "set", place / "measured").name
    'report.pdf'
    """
    return report_step(Workspace.open(open_set(folder), Path(out)), progress)


def join_views(
    folder: str | Path, out: str | Path, *, options: Options | None = None, progress: Progress = silent
) -> JoinedViews:
    """Join the views of a measured set by the marks of its carrier, and measure the thickness across them.

    Views that have not been measured are measured first, with the calibration in `out`; joined.ply and joint.json are
    written there.

    Parameters
    ----------
    folder
        The recording set, with carrier.toml and further views in views/NAME.
    out
        The folder with its results.
    options
        How views are measured; None: as usual.
    progress
        Called with how far it is.

    Returns
    -------
    JoinedViews
        `joined.cloud`: n points (n, 3) in mm in the first view's camera frame, each with its `view`; `joined.joint`;
        `check`; and `thickness`, a Gauge.

    Raises
    ------
    InputError
        If there is no carrier.toml or no further view, or the marks do not hold a view.

    Examples
    --------
    >>> try:
    ...     join_views(place / "set", place / "measured")
    ... except InputError as problem:
    ...     print(problem.what)
    there is no further view of the part to join
    """
    return join_step(Workspace.open(open_set(folder), Path(out)), options, progress)
