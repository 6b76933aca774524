"""How everything that can be handed over is written."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from datetime import datetime
from functools import cached_property
from pathlib import Path

from core.calibrate.results import CameraCalibration
from core.door import found_at
from core.errors import Cancelled, InputError
from core.extras import install
from core.files.atomic import write_bytes
from core.files.exchange.dcc import write_dcc
from core.files.exchange.dfq import write_dfq
from core.files.exchange.opencv_calibration import write_opencv
from core.files.exchange.qif import write_qif
from core.files.exchange.records import write_result_csv
from core.files.exchange.result_json import write_result_json
from core.files.exchange.ros_camera_info import write_camera_info
from core.files.exchange.xlsx import write_xlsx
from core.files.reading import read_bytes, resolved
from core.files.results.camera_file import read_camera
from core.files.results.cloud_csv import write_points_csv
from core.files.results.export_list import ExportKind, brought_exports, exports
from core.files.results.gauge_file import read_lower_face
from core.files.results.geometry_file import read_geometry, read_part_frame
from core.files.results.mesh_export import write_3mf, write_obj, write_stl
from core.files.results.ply import read_cloud, read_mesh, read_mesh_file, write_cloud, write_mesh
from core.files.results.run_file import read_run
from core.files.step_graph import FILES
from core.findings.brought import OURS, failure
from core.inspect.shown.view_frame import CAMERA_FRAME, FrameKind, ViewFrame, part_frame
from core.messages import Message
from core.progress import Progress, silent
from core.report.content import ReportContent
from core.wing import OUR_EXPORTS, why_away


def frame_of(results: Path, *, in_camera_frame: bool) -> ViewFrame:
    """Choose the frame for exported geometry: the part's own if known, else, or if `in_camera_frame`, the camera's.

    Raises
    ------
    InputError
        If what says how the part lies is damaged.
    """
    if in_camera_frame:
        return CAMERA_FRAME
    pose = read_part_frame(results / FILES["inspection"])
    return part_frame(pose, read_lower_face(results / FILES["gauge"])) or CAMERA_FRAME


class Results:
    """Folder of results to be exported, with the user's texts; files are read when they are needed.

    Parameters
    ----------
    folder
        Where they lie.
    content
        Gives all that is reported of them.
    in_camera_frame
        Whether geometry is handed over as the camera sees it, instead of in the part's own frame where that is known.
    """

    def __init__(self, folder: Path, content: Callable[[], ReportContent], *, in_camera_frame: bool = False) -> None:
        self.folder = folder
        self._content = content
        self._in_camera_frame = in_camera_frame

    @cached_property
    def frame(self) -> ViewFrame:
        """Coordinate frame in which geometry is written; InputError if the file with the part's pose is damaged."""
        return frame_of(self.folder, in_camera_frame=self._in_camera_frame)

    @cached_property
    def content(self) -> ReportContent:
        """Content of the report; InputError if there is no scan among the results."""
        return self._content()

    @property
    def camera(self) -> CameraCalibration:
        """Calibration of the camera; InputError if there is none among the results."""
        return read_camera(self.folder / FILES["camera"])

    @property
    def camera_time(self) -> datetime:
        """Time when the camera was calibrated or, if not known, when anything was last measured with it."""
        record = read_run(self.folder / FILES["run"])
        return record.made_at.get("camera", record.measured_at)


Write = Callable[[Results, Path, Progress], None]


def _copy(name: str) -> Write:
    def copy(results: Results, path: Path, progress: Progress = silent) -> None:
        source = _there(results.folder / FILES[name])
        if resolved(source) != resolved(path):
            write_bytes(path, read_bytes(source))

    return copy


def _there(source: Path) -> Path:
    if not source.exists():
        raise InputError(
            Message("export.result_missing", "is not there"),
            where=source,
            todo=Message("advice.do_step_first", "do the step that makes it first"),
        )
    return source


def in_frame(name: str, write: Callable[[Path, Path, ViewFrame], None]) -> Write:
    """Make what writes a result that is kept in the camera frame in that of the export.

    Parameters
    ----------
    name
        Of the result, a key of FILES.
    write
        Writes it in another frame, given the path, the result's own and the frame.
    """

    def written(results: Results, path: Path, progress: Progress = silent) -> None:
        if results.frame.kind is FrameKind.CAMERA:
            _copy(name)(results, path, progress)
            return
        source = _there(results.folder / FILES[name])
        if resolved(source) == resolved(path):
            raise InputError(
                Message("export.over_result", "would replace the result itself, which stays as the camera sees it"),
                where=path,
                todo=Message(
                    "advice.export_elsewhere", "write it into another folder (--to), or as it is (--frame camera)"
                ),
            )
        write(path, source, results.frame)

    return written


def _write_cloud(path: Path, source: Path, frame: ViewFrame) -> None:
    file = read_cloud(source)
    write_cloud(path, file.cloud, file.calibration_id, frame)


def _write_mesh(path: Path, source: Path, frame: ViewFrame) -> None:
    file = read_mesh_file(source)
    write_mesh(path, file.mesh, file.calibration_id, frame)


def _of_content(write: Callable[[Path, ReportContent], None]) -> Write:
    return lambda results, path, _: write(path, results.content)


def _stl(results: Results, path: Path, _: Progress) -> None:
    write_stl(path, read_mesh(results.folder / FILES["mesh"]), results.frame)


def _obj(results: Results, path: Path, _: Progress) -> None:
    write_obj(path, read_mesh(results.folder / FILES["mesh"]), results.frame)


def _3mf(results: Results, path: Path, _: Progress) -> None:
    write_3mf(path, read_mesh(results.folder / FILES["mesh"]), results.frame)


def _points(results: Results, path: Path, progress: Progress) -> None:
    write_points_csv(path, read_cloud(results.folder / FILES["cloud"]).cloud, results.frame, progress)


def _e57(results: Results, path: Path, _: Progress) -> None:
    try:
        from core.files.exchange.e57 import write_e57  # its library is an extra
    except ImportError as missing:
        raise InputError(
            Message("export.install_pye57", "E57 needs pye57: install it with {command}", command=install("e57")),
            where=path,
        ) from missing
    content = results.content
    calibration = "-".join(mark.id for mark in content.calibrations)
    write_e57(
        path, content.cloud, content.timestamp, name=content.part, calibration_id=calibration, frame=results.frame
    )


def _dxf(results: Results, path: Path, _: Progress) -> None:
    try:
        from core.files.exchange.dxf import write_dxf  # its library is an extra
    except ImportError as missing:
        raise InputError(
            Message("export.install_ezdxf", "DXF needs ezdxf: install it with {command}", command=install("dxf")),
            where=path,
        ) from missing
    points = read_cloud(results.folder / FILES["cloud"]).cloud.points
    write_dxf(path, read_geometry(results.folder / FILES["inspection"], points, results.frame))


def _opencv(results: Results, path: Path, _: Progress) -> None:
    write_opencv(path, results.camera, results.camera_time)


def _ros(results: Results, path: Path, _: Progress) -> None:
    write_camera_info(path, results.camera)


WRITERS: Mapping[str, Write] = {
    "pdf": _copy("report"),
    "cloud": in_frame("cloud", _write_cloud),
    "e57": _e57,
    "csv": _points,
    "mesh": in_frame("mesh", _write_mesh),
    "stl": _stl,
    "obj": _obj,
    "3mf": _3mf,
    "table": _of_content(write_result_csv),
    "xlsx": _of_content(write_xlsx),
    "results": _of_content(write_result_json),
    "dfq": _of_content(write_dfq),
    "qif": _of_content(write_qif),
    "dcc": _of_content(write_dcc),
    "dxf": _dxf,
    "json": _copy("gauge"),
    "opencv": _opencv,
    "opencv-json": _opencv,
    "ros": _ros,
}
"""What writes each kind of `core.files.results.export_list.EXPORTS`, by its name; of a wing's own its row says it."""


def export_kind(name: str) -> ExportKind:
    """Find the kind of export that is called `name`; InputError that names all kinds if there is none."""
    if name not in exports() and name in OUR_EXPORTS:
        wing = OUR_EXPORTS[name]
        why, todo = why_away(wing)
        what = Message(
            "export.format_of_missing_wing",
            'the format "{name}" is of the wing {wing}, {why}',
            name=name,
            wing=wing,
            why=why,
        )
        raise InputError(what, where="--format", todo=todo)
    if name not in exports():
        raise InputError(
            Message("export.no_such_format", 'there is no format "{name}"', name=name),
            where="--format",
            todo=Message("advice.choose_among", "choose among {choices}", choices=tuple(exports())),
        )
    return exports()[name]


def write_export(kind: str, results: Results, path: Path, progress: Progress = silent) -> None:
    """Write the results as the export called `kind` to `path`; InputError if there is none, or a result is missing.

    InputError as well where the wing that brings the kind fails.
    """
    name = export_kind(kind).name
    if name in WRITERS:
        WRITERS[name](results, path, progress)
        return
    brought, origin = brought_exports()[name]
    try:
        found_at(brought.writes)(results, path, progress)
    except (InputError, Cancelled):
        raise
    except Exception as error:
        raise InputError(
            failure(origin or OURS, name, error),
            where=path,
            todo=Message("advice.who_made_it", "install a newer version of it, or ask who made it"),
        ) from error
