"""Everything that `trisect` exports, imported: it looks here when a name is asked for first."""

from core.calibrate.board_shape import BoardTolerance
from core.calibrate.change import Stability
from core.calibrate.results import CameraCalibration, FanCalibration
from core.errors import Cancelled, InputError
from core.image.crossings.crossing import Crossing
from core.image.stripes.centreline import Centreline
from core.image.targets import BlackSquare, Charuco, Checkerboard, CircleGrid
from core.image.targets.target_view import TargetView
from core.inspect.characteristic import Characteristic as Length
from core.inspect.plan.feature_kind import FeatureKind, ResultKind
from core.inspect.plan.feature_spec import FeatureSpec as Feature
from core.inspect.results import GaugeResult as Gauge
from core.inspect.uncertainty.part import Part
from core.model import Camera, Fan, LightPlane
from core.pipeline.project.opened import open_project
from core.pipeline.steps.join_step import JoinResult as JoinedViews
from core.scan.method import ReconstructOptions
from core.scan.surface.cloud import Cloud
from core.scan.surface.fused_surface import Mesh
from core.settings.options import Options
from trisect.calibration import calibrate_camera, calibrate_fan
from trisect.folders import join_views, open_set, read_cloud, report, run, simulate, write_cloud
from trisect.inspection import measure_features, measure_thickness
from trisect.pictures import compression_of, extract_stripes, find_crossings, find_target, read_picture
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
    "FeatureKind",
    "Gauge",
    "InputError",
    "JoinedViews",
    "Length",
    "LightPlane",
    "Mesh",
    "Options",
    "Part",
    "ReconstructOptions",
    "ResultKind",
    "SolvedScan",
    "Stability",
    "TargetView",
    "build_mesh",
    "calibrate_camera",
    "calibrate_fan",
    "compression_of",
    "extract_stripes",
    "find_crossings",
    "find_target",
    "fuse",
    "join_views",
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
