"""What is handed over, in words."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication

AT_HAND = ("pdf", "cloud", "csv", "stl", "xlsx", "json")
"""Exports with a button of their own; the others are in a menu."""


def export_words(kind: str) -> tuple[str, str, str]:
    """Title, help and icon of what is handed over."""
    return {
        "pdf": (_tr("Report (PDF)"), _tr("The report, for people"), "mdi6.file-pdf-box"),
        "cloud": (
            _tr("Points (PLY)"),
            _tr("All points in mm with normal, σ and frame, for other programs"),
            "mdi6.dots-hexagon",
        ),
        "e57": (_tr("Points (E57)"), _tr("All points in m, σ as intensity"), "mdi6.dots-hexagon"),
        "csv": (_tr("Points (CSV)"), _tr("All points as a table, in mm, for a spreadsheet"), "mdi6.table"),
        "mesh": (_tr("Surface (PLY)"), _tr("The surface as triangles, in mm"), "mdi6.triangle-outline"),
        "stl": (
            _tr("Surface (STL)"),
            _tr("The surface as triangles, in mm, for CAD programs and printers"),
            "mdi6.cube-outline",
        ),
        "obj": (_tr("Surface (OBJ)"), _tr("The surface as triangles, in mm"), "mdi6.cube-outline"),
        "3mf": (_tr("Surface (3MF)"), _tr("The surface, its unit said in the file"), "mdi6.cube-outline"),
        "table": (_tr("Results (CSV)"), _tr("All results as a table, for a spreadsheet"), "mdi6.table"),
        "xlsx": (
            _tr("Results (XLSX)"),
            _tr("All results, their budgets and settings as a workbook"),
            "mdi6.file-excel-outline",
        ),
        "results": (
            _tr("Results (JSON)"),
            _tr("All results with their schema, for other programs"),
            "mdi6.code-json",
        ),
        "dfq": (_tr("Results (Q-DAS DFQ)"), _tr("All results, for statistics programs"), "mdi6.chart-bell-curve"),
        "qif": (_tr("Results (QIF 3.0)"), _tr("All results, for quality programs"), "mdi6.file-check-outline"),
        "json": (
            _tr("Thickness (JSON)"),
            _tr("The thickness with U, flatness, parallelism and verdict, for other programs"),
            "mdi6.code-json",
        ),
        "opencv": (_tr("Camera (OpenCV YAML)"), _tr("The calibration, for OpenCV"), "mdi6.camera-outline"),
        "opencv-json": (
            _tr("Camera (OpenCV JSON)"),
            _tr("The calibration, for OpenCV"),
            "mdi6.camera-outline",
        ),
        "ros": (_tr("Camera (ROS camera_info)"), _tr("The calibration, for ROS"), "mdi6.camera-outline"),
    }[kind]


def _tr(text: str) -> str:
    return QCoreApplication.translate("Report", text)
