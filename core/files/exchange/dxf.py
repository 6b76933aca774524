"""What was measured as DXF (AutoCAD 2010) for CAD: one layer a feature, coordinates in mm.

Planes are closed polylines round their points, spheres three great circles, cylinders the circles at both ends and the
axis, sections polylines. The library, ezdxf, is an extra.
"""

from __future__ import annotations

import io
import re
from pathlib import Path
from typing import Any

import numpy as np
from ezdxf import units
from ezdxf._options import options
from ezdxf.filemanagement import new
from ezdxf.math import OCS

from core.files.atomic import write_bytes
from core.files.results.frame_text import IN_WORDS
from core.inspect.geometry import Curve, CylinderShape, Geometry, Outline, Shape, SphereShape
from core.model.arrays import Array

VERSION = "R2010"
_FORBIDDEN = re.compile(r'[<>/\\":;?*|=`,]')
_COLOURS = {Outline: 5, SphereShape: 3, CylinderShape: 3, Curve: 1}
"""Of the layers, by what is drawn first in them: AutoCAD's blue, green and red."""


def write_dxf(path: Path, geometry: Geometry) -> None:
    """Write the measured geometry as DXF, the same one always to the same bytes; InputError if that fails."""
    kept = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True  # else the file names a clock and random numbers
    try:
        document = new(VERSION, units=units.MM)
        document.header["$MEASUREMENT"] = 1  # metric
        document.header["$PROJECTNAME"] = IN_WORDS[geometry.frame]
        for one in geometry.drawn:
            layer = layer_name(one.name)
            if layer not in document.layers:
                document.layers.add(layer, color=_COLOURS[type(one)])
            _draw(document.modelspace(), one, {"layer": layer})
        stream = io.StringIO()
        document.write(stream)
    finally:
        options.write_fixed_meta_data_for_testing = kept
    write_bytes(path, stream.getvalue().encode(document.output_encoding, "dxfreplace"))


def layer_name(name: str) -> str:
    """Make the name of a DXF layer from a feature's name, without the characters DXF does not permit."""
    return _FORBIDDEN.sub("_", name).strip() or "_"


def _draw(space: Any, one: Shape, looks: dict[str, str]) -> None:
    match one:
        case Outline():
            space.add_polyline3d(one.corners.tolist(), close=True, dxfattribs=looks)
        case SphereShape():
            space.add_point(one.centre.tolist(), dxfattribs=looks)
            for axis in np.eye(3):
                _circle(space, one.centre, axis, one.radius, looks)
        case CylinderShape():
            space.add_line(*one.ends.tolist(), dxfattribs=looks)
            axis = one.ends[1] - one.ends[0]
            length = float(np.linalg.norm(axis))
            for end in one.ends:
                _circle(space, end, axis / length if length else np.array([0.0, 0.0, 1.0]), one.radius, looks)
        case Curve():
            space.add_polyline3d(one.places.tolist(), dxfattribs=looks)


def _circle(space: Any, centre: Array, axis: Array, radius: float, looks: dict[str, str]) -> None:
    """A circle square to `axis`; DXF has its centre in the axes that belong to this one."""
    extrusion = axis.tolist()
    space.add_circle(OCS(extrusion).from_wcs(centre.tolist()), radius, dxfattribs={**looks, "extrusion": extrusion})
