"""Everything that can be handed over: its name, its title, how its file ends, and how it is written."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import datetime
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Literal

from core.calibrate.results import CameraCalibration
from core.errors import InputError
from core.files.atomic import write_bytes
from core.files.camera_file import read_camera
from core.files.csv_file import write_points_csv
from core.files.exchange.dfq import write_dfq
from core.files.exchange.e57 import write_e57
from core.files.exchange.opencv_calibration import write_opencv
from core.files.exchange.qif import write_qif
from core.files.exchange.result_csv import write_result_csv
from core.files.exchange.result_json import write_result_json
from core.files.exchange.ros_camera_info import write_camera_info
from core.files.exchange.xlsx import write_xlsx
from core.files.mesh_export import write_3mf, write_obj
from core.files.pictures import read_bytes
from core.files.ply import read_cloud, read_mesh
from core.files.run_file import read_run
from core.files.stl import write_stl
from core.pipeline.workspace import FILES
from core.progress import Progress, silent
from core.report.content import ReportContent

Needs = Literal["camera", "scan", "inspect"]
"""The step whose result something is written from."""


class Results:
    """A folder of results, and what is said of them; read when it is asked for.

    Parameters
    ----------
    folder
        Where they lie.
    content
        Gives all that is reported of them.
    """

    def __init__(self, folder: Path, content: Callable[[], ReportContent]) -> None:
        self.folder = folder
        self._content = content

    @cached_property
    def content(self) -> ReportContent:
        """All that is reported; InputError if there is no scan among the results."""
        return self._content()

    @property
    def camera(self) -> CameraCalibration:
        """The camera's calibration; InputError if there is none."""
        return read_camera(self.folder / FILES["camera"])

    @property
    def camera_time(self) -> datetime:
        """When the camera was calibrated, or else when anything was last measured with it."""
        record = read_run(self.folder / FILES["run"])
        return record.made_at.get("camera", record.measured_at)


@dataclass(frozen=True, eq=False, slots=True)
class ExportKind:
    """One thing that can be handed over.

    Parameters
    ----------
    name, title
        What programs and people call it.
    file
        Its name in a folder of results; `ending` is how it ends.
    needs
        The step it is made from.
    write
        Writes it to a path.
    """

    name: str
    title: str
    file: str
    needs: Needs
    write: Callable[[Results, Path, Progress], None]

    @property
    def ending(self) -> str:
        """How the file's name ends, with its point."""
        return Path(self.file).suffix


def _copy(name: str) -> Callable[[Results, Path, Progress], None]:
    def copy(results: Results, path: Path, progress: Progress = silent) -> None:
        source = results.folder / FILES[name]
        if not source.exists():
            raise InputError("is not there", where=source, todo="do the step that makes it first")
        if source.resolve() != path.resolve():
            write_bytes(path, read_bytes(source))

    return copy


def _of_content(write: Callable[[Path, ReportContent], None]) -> Callable[[Results, Path, Progress], None]:
    return lambda results, path, _: write(path, results.content)


def _stl(results: Results, path: Path, _: Progress) -> None:
    write_stl(path, read_mesh(results.folder / FILES["mesh"]))


def _obj(results: Results, path: Path, _: Progress) -> None:
    write_obj(path, read_mesh(results.folder / FILES["mesh"]))


def _3mf(results: Results, path: Path, _: Progress) -> None:
    write_3mf(path, read_mesh(results.folder / FILES["mesh"]))


def _points(results: Results, path: Path, progress: Progress) -> None:
    write_points_csv(path, read_cloud(results.folder / FILES["cloud"]).cloud, progress)


def _e57(results: Results, path: Path, _: Progress) -> None:
    content = results.content
    calibration = "-".join(mark.id for mark in content.calibrations)
    write_e57(path, content.cloud, content.timestamp, name=content.part, calibration_id=calibration)


def _opencv(results: Results, path: Path, _: Progress) -> None:
    write_opencv(path, results.camera, results.camera_time)


def _ros(results: Results, path: Path, _: Progress) -> None:
    write_camera_info(path, results.camera)


_ALL = (
    ExportKind("pdf", "Report (PDF)", "report.pdf", "scan", _copy("report")),
    ExportKind("cloud", "Point cloud (PLY)", "cloud.ply", "scan", _copy("cloud")),
    ExportKind("e57", "Point cloud, σ as intensity (E57)", "cloud.e57", "scan", _e57),
    ExportKind("csv", "Points as a table (CSV)", "points.csv", "scan", _points),
    ExportKind("mesh", "Surface (PLY)", "mesh.ply", "scan", _copy("mesh")),
    ExportKind("stl", "Surface (STL)", "mesh.stl", "scan", _stl),
    ExportKind("obj", "Surface (OBJ)", "mesh.obj", "scan", _obj),
    ExportKind("3mf", "Surface (3MF)", "mesh.3mf", "scan", _3mf),
    ExportKind("table", "Results as a table (CSV)", "result.csv", "inspect", _of_content(write_result_csv)),
    ExportKind("xlsx", "Results as a workbook (XLSX)", "result.xlsx", "inspect", _of_content(write_xlsx)),
    ExportKind("results", "Results with their schema (JSON)", "result.json", "inspect", _of_content(write_result_json)),
    ExportKind("dfq", "Results for statistics (Q-DAS DFQ)", "result.dfq", "inspect", _of_content(write_dfq)),
    ExportKind("qif", "Results (QIF 3.0)", "result.qif", "inspect", _of_content(write_qif)),
    ExportKind("json", "Thickness (JSON)", "gauge.json", "inspect", _copy("gauge")),
    ExportKind("opencv", "Camera (OpenCV YAML)", "camera_opencv.yml", "camera", _opencv),
    ExportKind("opencv-json", "Camera (OpenCV JSON)", "camera_opencv.json", "camera", _opencv),
    ExportKind("ros", "Camera (ROS camera_info)", "camera_info.yaml", "camera", _ros),
)

EXPORTS: Mapping[str, ExportKind] = MappingProxyType({kind.name: kind for kind in _ALL})
"""All kinds by name, in the order in which they are offered."""


def export_kind(name: str) -> ExportKind:
    """The kind of that name; InputError that names all kinds if there is none."""
    if name not in EXPORTS:
        raise InputError(f'there is no format "{name}"', where="--format", todo=f"choose among {', '.join(EXPORTS)}")
    return EXPORTS[name]
