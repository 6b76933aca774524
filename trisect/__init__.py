"""Trisect for scripts: from a picture to a thickness with its uncertainty, in plain arrays and records.

What stands in `__all__` is promised: a name, an argument or a field of a record changes only after a version in which
the old form still works and warns, with a line in the changelog. Everything else (`core`, `workbench`) may change with
any version.

Arrays go in, records come out; only `read_picture`, `read_cloud`, `write_cloud` and what works on whole folders
(`open_set`, `run`, `simulate`, `report`, `open_project`) touch files. Lengths are in mm, angles in rad, places in a
picture in px with (0, 0) in the middle of its first pixel; points lie in the camera's frame, z away from it. What
cannot be done raises `InputError` with one sentence: what, where, why, what to do; a record of values that cannot be,
as a board of no corners, a ValueError. `progress` is a function of stage, done and total that may raise `Cancelled`.

The method is that of Sun et al., Sensors 2023, 23, 13, doi:10.3390/s23010013, with all frames of a scan tied together.
"""

from typing import TYPE_CHECKING

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

if TYPE_CHECKING:
    from trisect.promised import *
else:

    def __getattr__(name: str) -> object:
        """Import what is asked for: `trisect.start` looks whose `core` this is before anything imports it."""
        if name not in __all__:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        from trisect.start import complaint

        if (what := complaint()) is not None:
            raise ImportError(what)
        from inspect import isfunction

        from trisect import promised
        from trisect.records import checked

        found = getattr(promised, name)
        return checked(found) if isfunction(found) else found


def __dir__() -> list[str]:
    return sorted(__all__)
