"""What `trisect batch` does and says."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from core.cli.measuring import PROVEN
from core.cli.output import PIPE_WIDTH, print_json
from core.pipeline.batch import SetResult, run_batch
from core.pipeline.executors import executor_of
from core.pipeline.options import Options
from core.progress import Progress
from core.report.wording import grouped, with_uncertainty

BAD_INPUT = 2
_COLUMNS = ("set", "thickness", "U", "verdict", "points", "frames", "time")


def run_sets(
    sets: Sequence[Path], out: Path, executor: str, workers: int | None, chosen: Options, progress: Progress
) -> tuple[SetResult, ...]:
    """Measure all sets."""
    with executor_of(executor, workers) as pool:
        return run_batch(sets, out, pool, chosen, progress)


def exit_code(results: Sequence[SetResult]) -> int:
    """The worst of the sets' own: 2 where one could not be measured, 1 where one is not proven to conform, else 0."""
    if any(result.error for result in results):
        return BAD_INPUT
    return 0 if all(result.verdict in PROVEN for result in results) else 1


def show(results: Sequence[SetResult], *, as_json: bool) -> None:
    """Say what became of each set."""
    if as_json:
        print_json({"sets": [_values(result) for result in results]})
        return
    console = Console(highlight=False)
    if not console.is_terminal:
        console.width = PIPE_WIDTH
    table = Table(box=None, padding=(0, 2, 0, 0))
    for name in _COLUMNS:
        table.add_column(name, justify="left" if name in ("set", "verdict") else "right")
    for result in results:
        table.add_row(*_row(result))
    console.print(table)
    for result in results:
        if result.error:
            console.print(f"{result.folder.name}: {result.error}", markup=False, soft_wrap=True)


def _values(result: SetResult) -> dict[str, Any]:
    return {**asdict(result), "folder": str(result.folder), "out": str(result.out)}


def _row(result: SetResult) -> tuple[str, ...]:
    seconds = f"{result.seconds:.1f} s"
    if result.error:
        return result.folder.name, "", "", "not measured", "", "", seconds
    thickness = U = ""
    if result.thickness_mm is not None and result.U_mm is not None:
        thickness, U = (f"{text} mm" for text in with_uncertainty(result.thickness_mm, result.U_mm))
    frames = f"{result.frames_used} of {result.frames}"
    return result.folder.name, thickness, U, result.verdict or "none", grouped(result.points), frames, seconds
