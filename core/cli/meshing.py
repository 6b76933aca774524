"""What `trisect mesh` does: make the surface ready for other programs, and say what that did to it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from core.cli.measuring import Shown
from core.pipeline.mesh_step import MeshOptions, mesh_step
from core.progress import Progress
from core.report.wording import grouped


def run_mesh(results: Path, formats: Sequence[str], options: MeshOptions, to: Path | None, progress: Progress) -> Shown:
    """Prepare, write, and return what to say; formats may be joined by commas."""
    names = [name.strip() for one in formats for name in one.split(",") if name.strip()]
    made, written = mesh_step(results, names, options, to or results, progress)
    filled = int(made.mesh.filled.sum())
    rows = [("triangles", grouped(len(made.mesh.triangles)))]
    if options.fill_mm:
        rows.append(("of them filled", f"{grouped(filled)}, marked where the format can"))
    if options.triangles or options.error_mm:
        rows.append(("error", f"{made.largest_mm:.3f} mm at most, {made.most_mm:.3f} mm for 95 % of the vertices"))
        rows.append(("outer edge", f"moved by up to {made.edge_mm:.3f} mm"))
    values = {
        "triangles": len(made.mesh.triangles),
        "filled": filled,
        "largest_error_mm": made.largest_mm,
        "error_95_mm": made.most_mm,
        "edge_error_mm": made.edge_mm,
    }
    return Shown(rows, values, files=written)
