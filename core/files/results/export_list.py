"""Everything that can be handed over, by name: what it is called, how its file is called and what it is made from.

Apart from what writes it (`core.pipeline.steps.export_kinds`), because a window lists it without needing those
libraries.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import PurePath
from types import MappingProxyType
from typing import Literal

from core.messages import label

Needs = Literal["camera", "scan", "gauge"]
"""The step whose result something is written from."""


@dataclass(frozen=True, slots=True)
class ExportKind:
    """Kind of file that can be exported.

    Parameters
    ----------
    name, title
        What programs and people call it.
    file
        Its name in a folder of results; `ending` is how it ends.
    needs
        The step it is made from.
    called
        What its name says beside the part's where several files of one ending lie side by side.
    """

    name: str
    title: str
    file: str
    needs: Needs
    called: str = ""

    @property
    def ending(self) -> str:
        """Ending of the exported file's name, with its point."""
        return PurePath(self.file).suffix


_ALL = (
    ExportKind("pdf", label("Report (PDF)"), "report.pdf", "scan"),
    ExportKind("cloud", label("Point cloud (PLY)"), "cloud.ply", "scan"),
    ExportKind("e57", label("Point cloud, σ as intensity (E57)"), "cloud.e57", "scan"),
    ExportKind("csv", label("Points as a table (CSV)"), "points.csv", "scan"),
    ExportKind("mesh", label("Surface (PLY)"), "mesh.ply", "scan", label("surface")),
    ExportKind("stl", label("Surface (STL)"), "mesh.stl", "scan"),
    ExportKind("obj", label("Surface (OBJ)"), "mesh.obj", "scan"),
    ExportKind("3mf", label("Surface (3MF)"), "mesh.3mf", "scan"),
    ExportKind("table", label("Results as a table (CSV)"), "result.csv", "gauge", label("results")),
    ExportKind("xlsx", label("Results as a workbook (XLSX)"), "result.xlsx", "gauge", label("results")),
    ExportKind("results", label("Results with their schema (JSON)"), "result.json", "gauge", label("results")),
    ExportKind("dfq", label("Results for statistics (Q-DAS DFQ)"), "result.dfq", "gauge", label("results")),
    ExportKind("qif", label("Results (QIF 3.0)"), "result.qif", "gauge", label("results")),
    ExportKind("dcc", label("Digital calibration certificate (DCC 3.3)"), "result.xml", "gauge", label("certificate")),
    ExportKind("dxf", label("Planes, circles and sections for CAD (DXF)"), "result.dxf", "gauge", label("geometry")),
    ExportKind("compared", label("Comparison, point by point (PLY)"), "comparison.ply", "scan", label("comparison")),
    ExportKind("compared-csv", label("Comparison as a table (CSV)"), "comparison.csv", "scan", label("comparison")),
    ExportKind("json", label("Thickness (JSON)"), "gauge.json", "gauge", label("thickness")),
    ExportKind("opencv", label("Camera (OpenCV YAML)"), "camera_opencv.yml", "camera", label("camera")),
    ExportKind("opencv-json", label("Camera (OpenCV JSON)"), "camera_opencv.json", "camera", label("camera")),
    ExportKind("ros", label("Camera (ROS camera_info)"), "camera_info.yaml", "camera", label("camera")),
)

EXPORTS: Mapping[str, ExportKind] = MappingProxyType({kind.name: kind for kind in _ALL})
"""All kinds by name, in the order in which they are offered."""
