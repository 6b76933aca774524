"""What of a comparison can be handed over. Light to import."""

from __future__ import annotations

from core.files.results.export_list import BroughtExport, ExportKind
from core.messages import label

_PLACE = "core.wings.geometry.comparison.turned"
_TIP = label("Deviation from the other surface, its σ and significance at every place")

POINTS = ExportKind(
    "compared", label("Comparison, point by point (PLY)"), "comparison.ply", "scan", label("comparison")
)
TABLE = ExportKind("compared-csv", label("Comparison as a table (CSV)"), "comparison.csv", "scan", label("comparison"))
ROWS = (
    BroughtExport(POINTS, f"{_PLACE}:write_points", "dxf", _TIP, "mdi6.compare"),
    BroughtExport(TABLE, f"{_PLACE}:write_table", "compared", _TIP, "mdi6.table"),
)
