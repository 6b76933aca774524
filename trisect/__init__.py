"""Trisect for scripts: from a picture to a thickness with its uncertainty, in plain arrays and records.

What stands in `__all__` is promised: a name, an argument or a field of a record changes only after a version in which
the old form still works and warns, with a line in the changelog. Everything else (`core`, `workbench`) may change with
any version.

Arrays go in, records come out; only `read_picture`, `read_cloud`, `write_cloud` and what works on whole folders
(`open_set`, `run`, `simulate`, `report`, `open_project`) touch files. Lengths are in mm, angles in rad, places in a
picture in px with (0, 0) in the middle of its first pixel; points lie in the camera's frame, z away from it. What
cannot be done raises `InputError` with one sentence: what, where, why, what to do. `progress` is a function of stage,
done and total that may raise `Cancelled`.

The method is that of Sun et al., Sensors 2023, 23, 13, doi:10.3390/s23010013, with all frames of a scan tied together.
"""

from core.calibrate.board_shape import BoardTolerance
from core.calibrate.change import Stability
from core.calibrate.results import CameraCalibration, FanCalibration
from core.errors import Cancelled, InputError
from core.files.recording.options import Options
from core.image.crossings.crossing import Crossing
from core.image.stripes.centreline import Centreline
from core.image.targets import BlackSquare, Charuco, Checkerboard, CircleGrid
from core.image.targets.target_view import TargetView
from core.inspect.characteristic import Characteristic as Length
from core.inspect.plan.feature_spec import FeatureSpec as Feature
from core.inspect.results import GaugeResult as Gauge
from core.inspect.uncertainty.part import Part
from core.model import Camera, Fan, LightPlane
from core.pipeline.project.opened import open_project
from core.scan.surface.cloud import Cloud
from core.scan.surface.fused_surface import Mesh
from trisect.calibration import calibrate_camera, calibrate_fan
from trisect.folders import open_set, read_cloud, report, run, simulate, write_cloud
from trisect.inspection import measure_features, measure_thickness
from trisect.pictures import extract_stripes, find_crossings, find_target, read_picture
from trisect.scan import SolvedScan, build_mesh, fuse, solve_scan, triangulate

__all__ = [
    "BlackSquare",
    "BoardTolerance",
    "Camera",
    "CameraCalibration",
    "Cancelled",
    "Centreline",
    "Charuco",
    "Checkerboard",
    "CircleGrid",
    "Cloud",
    "Crossing",
    "Fan",
    "FanCalibration",
    "Feature",
    "Gauge",
    "InputError",
    "Length",
    "LightPlane",
    "Mesh",
    "Options",
    "Part",
    "SolvedScan",
    "Stability",
    "TargetView",
    "build_mesh",
    "calibrate_camera",
    "calibrate_fan",
    "extract_stripes",
    "find_crossings",
    "find_target",
    "fuse",
    "measure_features",
    "measure_thickness",
    "open_project",
    "open_set",
    "read_cloud",
    "read_picture",
    "report",
    "run",
    "simulate",
    "solve_scan",
    "triangulate",
    "write_cloud",
]
