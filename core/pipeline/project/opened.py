"""A project, or a folder of results, opened to be read: for Python programs and for the window's console."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from core.calibrate.results import CameraCalibration, FanCalibration
from core.errors import InputError
from core.files.project.data import Project, ProjectFile
from core.files.project.folder import PROJECT, is_project, read_project, results_in
from core.files.project.results import ProjectResults
from core.files.reading import resolved
from core.files.results.inspection_file import InspectionFile, read_inspection
from core.files.step_graph import FILES
from core.inspect.characteristic import Characteristic
from core.inspect.conformity import Verdict
from core.inspect.result_list import ResultList
from core.inspect.results import GaugeResult
from core.messages import Message
from core.pipeline.project.results import load_results
from core.pipeline.project.verdict import listed_results
from core.scan.surface.cloud import Cloud
from core.scan.surface.fused_surface import Mesh

Stamps = dict[str, tuple[int, int]]
"""When each file was written, in ns, and its size in bytes."""


@dataclass(frozen=True, eq=False)
class OpenedProject:
    """Project opened for reading: files are read when they are needed; nothing is ever written.

    What is not there is None, or nothing. Once a file has changed since the project was opened, what was not read
    before raises InputError: so all that is read belongs together.

    Parameters
    ----------
    folder
        Of the project, or of results (`trisect run SET --out FOLDER`).
    """

    folder: Path
    _stamps: Stamps = field(repr=False)

    @property
    def changed(self) -> bool:
        """Whether a file has been written, or removed, since the project was opened."""
        return _stamps(self.folder) != self._stamps

    def opened_again(self) -> OpenedProject:
        """Open the same project anew, with its files as they are on the disk now."""
        return open_project(self.folder)

    @cached_property
    def results(self) -> ProjectResults:
        """Results of one calibration and scan, and in `problems` why others are left out."""
        self._require_unchanged()
        return load_results(self.folder)

    @cached_property
    def settings(self) -> Project | None:
        """Settings of the project: rig, options, plan; None for a folder of results."""
        file = self._file
        return file.project if file is not None else None

    @property
    def camera(self) -> CameraCalibration | None:
        """Calibration of the camera with its covariance; None if there is none."""
        return self.results.camera

    @property
    def planes(self) -> FanCalibration | None:
        """Calibration of the fan's light planes with their covariance; None if there is none."""
        return self.results.fan

    @property
    def cloud(self) -> Cloud | None:
        """Points of the scan in mm in the camera frame, each with its σ; None without a scan."""
        return self.results.cloud

    @property
    def mesh(self) -> Mesh | None:
        """Triangle mesh of the scan's surface, in mm in the camera frame; None without a scan."""
        return self.results.mesh

    @property
    def gauge(self) -> GaugeResult | None:
        """Measured thickness with its uncertainty budget; None if none was measured."""
        return self.results.gauge

    @cached_property
    def inspection(self) -> InspectionFile | None:
        """Results of the features of the inspection plan; None if they were not measured."""
        self._require_unchanged()
        path = results_in(self.folder) / FILES["inspection"]
        return read_inspection(path) if path.exists() else None

    @property
    def characteristics(self) -> tuple[Characteristic, ...]:
        """Measured values of the part with U and verdict, the worst first; () without a scan."""
        return self._listed.worst_first

    @property
    def verdict(self) -> Verdict:
        """Verdict on the whole part, from all its measured values."""
        return self._listed.verdict

    @cached_property
    def _listed(self) -> ResultList:
        self._require_unchanged()
        return listed_results(self.folder) if (results_in(self.folder) / FILES["cloud"]).exists() else ResultList()

    @cached_property
    def _file(self) -> ProjectFile | None:
        self._require_unchanged()
        return read_project(self.folder) if is_project(self.folder) else None

    def _require_unchanged(self) -> None:
        if self.changed:
            raise InputError(
                Message("project.changed_since_opened", "has been changed since it was opened here"),
                where=self.folder,
                todo=Message("advice.open_again", "open it again: project = project.opened_again()"),
            )


def open_project(path: str | Path) -> OpenedProject:
    """Open a project, or a folder of results, for reading.

    Parameters
    ----------
    path
        The folder, or the project's `project.json` in it.

    Returns
    -------
    OpenedProject
        Reads each result when it is asked for: lengths in mm, the cloud (n × 3) in the camera frame.

    Raises
    ------
    InputError
        If there is neither.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from core.files.project.data import ProjectFile, new_project
    >>> from core.files.project.folder import create_project
    >>> with TemporaryDirectory() as made:
    ...     create_project(Path(made, "block"), ProjectFile(new_project("Block")))
    ...     project = open_project(Path(made, "block"))
    ...     print(project.settings.info.name, project.gauge)
    Block None
    """
    given = resolved(Path(path))
    folder = given.parent if given.name == PROJECT else given
    stamps = _stamps(folder)
    if not stamps:
        raise InputError(
            Message("project.nothing_to_open", "there is neither a project nor a result here"),
            where=given,
            todo=Message("advice.choose_project_or_results", "choose the folder of a project, or one of results"),
        )
    return OpenedProject(folder, stamps)


def _stamps(folder: Path) -> Stamps:
    """Of project.json and of each result that is there."""
    results = results_in(folder)
    found = {}
    for path in (folder / PROJECT, *(results / name for name in FILES.values())):
        try:
            about = path.stat()
        except OSError:
            continue
        found[path.name] = (about.st_mtime_ns, about.st_size)
    return found
