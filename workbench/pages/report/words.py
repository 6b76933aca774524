"""What is handed over, in words."""

from __future__ import annotations

from core.files.results.export_list import brought_exports
from core.messages import label
from workbench.language import tr

USUAL_EXPORTS = ("pdf", "cloud", "csv", "stl", "xlsx", "json")
"""Exports with a button of their own; the others are in a menu."""

SHORT_TITLES = {"view": label("3D view"), "maps": label("Residuals of both faces"), "inputs": label("Inputs")}
"""What the page calls the sections of the report whose own titles are too long for a box that is ticked."""


def export_words(kind: str) -> tuple[str, str, str]:
    """Return the title, the help text and the icon's name of a kind of export."""
    if kind in brought_exports():
        brought, _ = brought_exports()[kind]
        return tr(brought.kind.title), tr(brought.tip) if brought.tip else "", brought.icon
    return {
        "pdf": (tr("Report (PDF)"), tr("The report, for people"), "mdi6.file-pdf-box"),
        "cloud": (
            tr("Points (PLY)"),
            tr("All points in mm with normal, σ and frame, for other programs"),
            "mdi6.dots-hexagon",
        ),
        "e57": (tr("Points (E57)"), tr("All points in m, σ as intensity"), "mdi6.dots-hexagon"),
        "csv": (tr("Points (CSV)"), tr("All points as a table, in mm, for a spreadsheet"), "mdi6.table"),
        "mesh": (tr("Surface (PLY)"), tr("The surface as triangles, in mm"), "mdi6.triangle-outline"),
        "stl": (
            tr("Surface (STL)"),
            tr("The surface as triangles, in mm, for CAD programs and printers"),
            "mdi6.cube-outline",
        ),
        "obj": (tr("Surface (OBJ)"), tr("The surface as triangles, in mm"), "mdi6.cube-outline"),
        "3mf": (tr("Surface (3MF)"), tr("The surface, its unit said in the file"), "mdi6.cube-outline"),
        "table": (tr("Results (CSV)"), tr("All results as a table, for a spreadsheet"), "mdi6.table"),
        "xlsx": (
            tr("Results (XLSX)"),
            tr("All results, their budgets and settings as a workbook"),
            "mdi6.file-excel-outline",
        ),
        "results": (
            tr("Results (JSON)"),
            tr("All results with their schema, for other programs"),
            "mdi6.code-json",
        ),
        "dfq": (tr("Results (Q-DAS DFQ)"), tr("All results, for statistics programs"), "mdi6.chart-bell-curve"),
        "dcc": (
            tr("Digital calibration certificate (DCC 3.3)"),
            tr("All results as XML, for laboratories"),
            "mdi6.certificate-outline",
        ),
        "qif": (tr("Results (QIF 3.0)"), tr("All results, for quality programs"), "mdi6.file-check-outline"),
        "dxf": (
            tr("Geometry (DXF)"),
            tr("Planes, spheres, cylinders and sections in part coordinates, for CAD"),
            "mdi6.vector-polyline",
        ),
        "compared": (
            tr("Comparison (PLY)"),
            tr("Deviation from the other surface, its σ and significance at every place"),
            "mdi6.compare",
        ),
        "compared-csv": (
            tr("Comparison (CSV)"),
            tr("Deviation from the other surface, its σ and significance at every place"),
            "mdi6.table",
        ),
        "json": (
            tr("Thickness (JSON)"),
            tr("The thickness with U, flatness, parallelism and verdict, for other programs"),
            "mdi6.code-json",
        ),
        "opencv": (tr("Camera (OpenCV YAML)"), tr("The calibration, for OpenCV"), "mdi6.camera-outline"),
        "opencv-json": (
            tr("Camera (OpenCV JSON)"),
            tr("The calibration, for OpenCV"),
            "mdi6.camera-outline",
        ),
        "ros": (tr("Camera (ROS camera_info)"), tr("The calibration, for ROS"), "mdi6.camera-outline"),
    }[kind]
