"""Everything that can be handed over, by name: what it is called, how its file is called and what it is made from.

Apart from what writes it (`core.pipeline.steps.export_kinds`), because a window lists it without needing those
libraries. Wings add kinds of their own, which `exports` puts among them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import PurePath
from types import MappingProxyType
from typing import Literal, TypeGuard

from core.door import Brought, Origin
from core.messages import Message, label
from core.wing import rows_of_wings

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


@dataclass(frozen=True, slots=True)
class BroughtExport:
    """Kind of file that a wing can export.

    Parameters
    ----------
    kind
        What it is.
    writes
        "module:name" of a function of the `core.pipeline.steps.export_kinds.Results`, the path and the progress.
    after
        The kind behind which it is offered; "": at the end.
    tip, icon
        What the window says of it, in English, and the name of its icon.
    """

    kind: ExportKind
    writes: str
    after: str = ""
    tip: str = ""
    icon: str = "mdi6.file-export-outline"


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
    ExportKind("json", label("Thickness (JSON)"), "gauge.json", "gauge", label("thickness")),
    ExportKind("opencv", label("Camera (OpenCV YAML)"), "camera_opencv.yml", "camera", label("camera")),
    ExportKind("opencv-json", label("Camera (OpenCV JSON)"), "camera_opencv.json", "camera", label("camera")),
    ExportKind("ros", label("Camera (ROS camera_info)"), "camera_info.yaml", "camera", label("camera")),
)

EXPORTS: Mapping[str, ExportKind] = MappingProxyType({kind.name: kind for kind in _ALL})
"""The kinds of the house by name, in the order in which they are offered."""


def exports() -> Mapping[str, ExportKind]:
    """All kinds by name, those of the wings among them, in the order in which they are offered."""
    kinds = list(EXPORTS.values())
    for brought, _ in brought_exports().values():
        names = [kind.name for kind in kinds]
        kinds.insert(names.index(brought.after) + 1 if brought.after in names else len(names), brought.kind)
    return {kind.name: kind for kind in kinds}


def brought_exports() -> Mapping[str, tuple[BroughtExport, Origin | None]]:
    """The kinds of the wings, by name, each with the package it comes from; None: the program itself."""
    return _of_wings()[0]


def unusable_exports() -> tuple[Brought, ...]:
    """What wings name as kinds of export and cannot be used."""
    return _of_wings()[1]


@cache
def _of_wings() -> tuple[Mapping[str, tuple[BroughtExport, Origin | None]], tuple[Brought, ...]]:
    return rows_of_wings(lambda wing: wing.exports, _is_export, lambda row: row.kind.name, EXPORTS, _why_unusable)


def _is_export(row: object) -> TypeGuard[BroughtExport]:
    return isinstance(row, BroughtExport)


def _why_unusable(name: str) -> Message:
    if not name:
        return Message("plugin.why_no_export", "one of its kinds of export is no BroughtExport")
    return Message("plugin.why_export_taken", "the name of its kind of export {name} is taken", name=name)
