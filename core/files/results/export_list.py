"""Everything that can be handed over, by name: what it is called, how its file is called and what it is made from.

Apart from what writes it (`core.pipeline.export_kinds`), because a window lists it without needing those libraries.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import PurePath
from types import MappingProxyType
from typing import Literal

Needs = Literal["camera", "scan", "inspect"]
"""The step whose result something is written from."""


@dataclass(frozen=True, slots=True)
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
        """How the file's name ends, with its point."""
        return PurePath(self.file).suffix


_ALL = (
    ExportKind("pdf", "Report (PDF)", "report.pdf", "scan"),
    ExportKind("cloud", "Point cloud (PLY)", "cloud.ply", "scan"),
    ExportKind("e57", "Point cloud, σ as intensity (E57)", "cloud.e57", "scan"),
    ExportKind("csv", "Points as a table (CSV)", "points.csv", "scan"),
    ExportKind("mesh", "Surface (PLY)", "mesh.ply", "scan", "surface"),
    ExportKind("stl", "Surface (STL)", "mesh.stl", "scan"),
    ExportKind("obj", "Surface (OBJ)", "mesh.obj", "scan"),
    ExportKind("3mf", "Surface (3MF)", "mesh.3mf", "scan"),
    ExportKind("table", "Results as a table (CSV)", "result.csv", "inspect", "results"),
    ExportKind("xlsx", "Results as a workbook (XLSX)", "result.xlsx", "inspect", "results"),
    ExportKind("results", "Results with their schema (JSON)", "result.json", "inspect", "results"),
    ExportKind("dfq", "Results for statistics (Q-DAS DFQ)", "result.dfq", "inspect", "results"),
    ExportKind("qif", "Results (QIF 3.0)", "result.qif", "inspect", "results"),
    ExportKind("json", "Thickness (JSON)", "gauge.json", "inspect", "thickness"),
    ExportKind("opencv", "Camera (OpenCV YAML)", "camera_opencv.yml", "camera", "camera"),
    ExportKind("opencv-json", "Camera (OpenCV JSON)", "camera_opencv.json", "camera", "camera"),
    ExportKind("ros", "Camera (ROS camera_info)", "camera_info.yaml", "camera", "camera"),
)

EXPORTS: Mapping[str, ExportKind] = MappingProxyType({kind.name: kind for kind in _ALL})
"""All kinds by name, in the order in which they are offered."""
