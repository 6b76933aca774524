"""The results of a project as they lie on the disk, as far as they are there and belong together."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from core.calibrate.results import NO_FAN, CameraCalibration
from core.errors import InputError
from core.files.project.folder import results_in
from core.files.project.results import ProjectResults
from core.files.results.camera_file import read_camera
from core.files.results.gauge_file import read_gauge
from core.files.results.planes_file import read_planes
from core.files.results.ply import CloudFile, read_cloud, read_mesh
from core.files.results.run_file import RunRecord, read_run
from core.files.results.scan_file import ScanFile, read_scan
from core.files.step_graph import FILES
from core.messages import Message
from core.pipeline.steps.workspace import Calibration, check_calibration, states_fan
from core.progress import Progress, silent
from core.scan.preview.shown import SettledScan

T = TypeVar("T")

_PARTS = 6
"""Of how many results progress is told; the last of all is read within a moment."""


def load_results(folder: Path, progress: Progress = silent) -> ProjectResults:
    """Read the results in `folder`, of a project or of results alone; what is missing or wrong is None.

    What is damaged or was measured with another calibration is None, too, and a sentence says so; nothing is raised for
    it.
    """
    reader = _Reader(results_in(folder), progress)
    record = reader.read("run", read_run)
    camera = reader.read("camera", read_camera)
    if record is not None and not states_fan(record):
        calibration = None if camera is None else Calibration(camera, NO_FAN)
    else:
        calibration = reader.read("planes", lambda path: _calibration(path, camera))
    cloud = reader.read("cloud", lambda path: _cloud(path, calibration))
    scan = reader.read("scan", lambda path: _scan(path, calibration))
    measured = cloud is not None and scan is not None
    mesh = reader.read("mesh", read_mesh) if measured else None
    gauge = reader.read("gauge", lambda path: read_gauge(path, cloud.cloud)) if cloud and measured else None
    return ProjectResults(
        camera=camera,
        fan=calibration.fan if calibration and calibration.fan.fan.lines else None,
        cloud=cloud.cloud if cloud and measured else None,
        mesh=mesh,
        gauge=gauge,
        frames=record.frames if record and measured else (),
        settled=_settled(scan) if scan and measured else None,
        notes=_notes(record),
        calibration_id=calibration.id if calibration else "",
        files=reader.there,
        problems=tuple(reader.problems),
    )


class _Reader:
    """Reads one file after another and remembers what was wrong."""

    def __init__(self, results: Path, progress: Progress) -> None:
        paths = {name: results / file for name, file in FILES.items()}
        self.there = {name: path for name, path in paths.items() if path.exists()}
        self.problems: list[Message] = []
        self._progress, self._done = progress, 0

    def read(self, name: str, read: Callable[[Path], T]) -> T | None:
        """What `read` makes of the result `name`; None if it is not there or cannot be used."""
        self._progress("results", min(self._done, _PARTS), _PARTS)
        self._done += 1
        if name not in self.there:
            return None
        try:
            return read(self.there[name])
        except InputError as error:
            self.problems.append(error.message)
            return None


def _calibration(path: Path, camera: CameraCalibration | None) -> Calibration:
    if camera is None:
        raise InputError(
            Message("project.camera_missing", "the camera it rests on is not there"),
            where=path,
            todo=Message("advice.measure_scan_again", "measure the scan again"),
        )
    fan = read_planes(path, camera.camera)
    return Calibration(fan.camera_used(camera), fan)


def _cloud(path: Path, calibration: Calibration | None) -> CloudFile:
    file = read_cloud(path)
    _check(path, file.calibration_id, calibration)
    return file


def _scan(path: Path, calibration: Calibration | None) -> ScanFile:
    scan = read_scan(path)
    _check(path, scan.calibration_id, calibration)
    return scan


def _check(path: Path, calibration_id: str, calibration: Calibration | None) -> None:
    if calibration is None:
        raise InputError(
            Message("project.calibrations_missing", "the calibrations it rests on are not there"),
            where=path,
            todo=Message("advice.measure_scan_again", "measure the scan again"),
        )
    check_calibration(path, calibration_id, calibration)


def _settled(scan: ScanFile) -> SettledScan:
    return SettledScan(scan.features.sweep_stripe, scan.features.fan_stripe, scan.fan_line, scan.second_bounces)


def _notes(record: RunRecord | None) -> tuple[Message, ...]:
    return record.all_notes if record else ()
