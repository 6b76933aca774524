"""What `trisect inspect` does: measure a plan on a scan, and say it."""

from __future__ import annotations

import math
from pathlib import Path

from rich.table import Table

from core.cli import output
from core.files.inspection_file import inspection_values
from core.files.inspection_plan_file import read_plan
from core.inspect.characteristic import Characteristic
from core.inspect.evaluate import Inspection
from core.pipeline.inspect_step import inspect_step
from core.progress import Progress
from core.report.wording import decimals_of, fixed

PROVEN = ("", "conforming")
"""Verdicts that leave with exit code 0."""
COLUMNS = ("characteristic", "measured", "U", "nominal", "limits", "deviation", "verdict")


def run_inspect(source: Path, plan: Path, out: Path | None, progress: Progress) -> tuple[Inspection, Path | None]:
    """Inspect; nominal surfaces lie beside the plan."""
    return inspect_step(source, read_plan(plan), plan.parent, out, progress)


def exit_code(inspection: Inspection) -> int:
    """0, or 1 where something was asked for and is not proven to conform, or could not be measured."""
    return 0 if inspection.verdict in PROVEN and not inspection.problems else 1


def show(inspection: Inspection, written: Path | None, *, as_json: bool) -> None:
    """Print it, for people or for machines."""
    files = {} if written is None else {"inspection": written}
    if as_json:
        output.print_json({**inspection_values(inspection), "files": output.files_json(files)})
        return
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
    for name in COLUMNS:
        table.add_column(name, justify="left" if name in ("characteristic", "verdict") else "right", overflow="fold")
    for row in inspection.characteristics:
        table.add_row(*_cells(row))
    output.console().print(table)
    output.print_rows([], (*inspection.problems, *inspection.notes), files)


def _cells(row: Characteristic) -> tuple[str, ...]:
    """One line of the table; an angle in degrees."""
    scale, unit = (math.degrees(1.0), "°") if row.quantity == "angle" else (1.0, " mm")
    decimals = decimals_of(row.U * scale)

    def text(value: float, *, signed: bool = False) -> str:
        return fixed(value * scale, decimals, signed=signed) + unit

    if row.limits is None or row.deviation is None:
        return row.name, text(row.value), text(row.U), "", "", "", ""
    lower, upper = row.limits.lower, row.limits.upper
    sides = [f"{value * scale:+g}".replace("-", "−") if math.isfinite(value) else "–" for value in (lower, upper)]
    limits = f"± {upper * scale:g}{unit}" if lower == -upper else f"{' … '.join(sides)}{unit}"
    nominal = f"{row.limits.nominal * scale:g}{unit}"
    return row.name, text(row.value), text(row.U), nominal, limits, text(row.deviation, signed=True), row.verdict
