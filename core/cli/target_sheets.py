"""What `trisect target` does: a target to print, from the command line's words or from rig.toml."""

from __future__ import annotations

from pathlib import Path

from core.cli import output
from core.errors import InputError
from core.files.atomic import write_bytes
from core.files.rig import read_rig
from core.image.targets import BlackSquare, Charuco, Checkerboard, CircleGrid, Target
from core.image.targets.usual import USUAL, USUAL_MARKER
from core.report.target_sheet import PAPER_MM, SheetPaper, sheet_layout, target_sheet
from core.report.wording import target_in_words

KINDS = tuple(USUAL)


def described(
    kind: str,
    columns: int | None,
    rows: int | None,
    size_mm: float | None,
    marker_mm: float | None,
    dictionary: str,
    *,
    asymmetric: bool,
) -> Target:
    """The target of these words; what is None is USUAL."""
    if kind not in KINDS:
        raise InputError(f"{kind!r} is no kind of target", where="KIND", todo=f"choose one of {', '.join(KINDS)}")
    usual = (4, 11, 12.0) if kind == "circle_grid" and asymmetric else USUAL[kind]
    across, down, size = (
        given if given is not None else default for given, default in zip((columns, rows, size_mm), usual, strict=True)
    )
    across, down = int(across), int(down)
    try:
        if kind == "checkerboard":
            return Checkerboard(across, down, size)
        if kind == "charuco":
            return Charuco(across, down, size, USUAL_MARKER * size if marker_mm is None else marker_mm, dictionary)
        if kind == "circle_grid":
            return CircleGrid(across, down, size, asymmetric)
        return BlackSquare(size)
    except ValueError as error:
        raise InputError(str(error), where=kind) from error


def from_rig(path: Path, which: str) -> Target:
    """The camera's or the planes' target of rig.toml, or of the recording set that holds it."""
    rig = read_rig(path / "rig.toml" if path.is_dir() else path)
    return rig.camera_target if which == "camera" else rig.plane_target


def chosen(kind: str, rig: Path | None) -> None:
    """InputError unless exactly one of both says what to print."""
    if bool(kind) == (rig is not None):
        what = "both a kind of target and a rig are given" if kind else "nothing says which target to print"
        raise InputError(what, where="KIND, --rig", todo=f"give one of {', '.join(KINDS)}, or --rig FILE")


def write_sheet(target: Target, paper: str, title: str, out: Path) -> None:
    """Write the sheet as a PDF."""
    write_bytes(out, target_sheet(target, _paper(paper), title=title))


def show(target: Target, paper: str, out: Path, *, as_json: bool) -> None:
    """Say what was written, and what to do at the printer."""
    name = _paper(paper)
    layout = sheet_layout(target, name)
    sheet = f"{name}, {layout.width_mm:g} × {layout.height_mm:g} mm"
    if as_json:
        output.print_json({"target": target_in_words(target), "paper": name, "file": str(out)})
        return
    output.print_rows(
        [("target", target_in_words(target)), ("paper", sheet), ("written", str(out))],
        ["print at 100 %, without fitting to the page, then measure both rulers: each must be 100.0 mm long"],
    )


def _paper(name: str) -> SheetPaper:
    for paper in PAPER_MM:
        if paper.lower() == name.lower():
            return paper
    raise InputError(f"{name!r} is no paper known here", where="--paper", todo=f"choose one of {', '.join(PAPER_MM)}")
