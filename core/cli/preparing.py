"""What is done before anything is measured: targets and the quick card are printed."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import cast, get_args

from core.cli import output
from core.cli.language import tr
from core.cli.options import one_of
from core.errors import InputError, WrongValue
from core.files.atomic import write_bytes
from core.files.recording.carrier_file import write_carrier
from core.files.recording.rig import default_rig, known_planes_to_toml, read_rig, require_tables
from core.image.targets import BlackSquare, Charuco, Checkerboard, CircleGrid, Target
from core.image.targets.kinds import USUAL, USUAL_MARKER
from core.messages import Message
from core.pipeline.project.corner import write_corner_sheets
from core.pipeline.steps.prints import write_quick_card
from core.report.carrier_sheet import carrier_on, carrier_sheets
from core.report.corner_sheet import CornerKind
from core.report.target_sheet import PAPER_MM, RULER_MM, SheetPaper, sheet_layout, target_sheet
from core.report.template import PAPERS, Paper
from core.report.wording import target_in_words

CORNER = "corner"
"""The kind of target that is two boards."""
CARRIER = "carrier"
"""The kind of target that is both sides of a carrier of reference marks."""
CORNER_KINDS = get_args(CornerKind)
_PRINT_TO_SIZE = Message(
    "target.print_to_size",
    "print at 100 %, without fitting to the page, then measure both rulers: each must be {ruler_mm:.1f} mm long",
    ruler_mm=RULER_MM,
)


def target_of_words(
    kind: str,
    columns: int | None,
    rows: int | None,
    size_mm: float | None,
    marker_mm: float | None,
    dictionary: str,
    *,
    asymmetric: bool,
) -> Target:
    """Make a calibration target from the options typed; None means the usual value of its kind."""
    if kind not in USUAL:
        raise InputError(
            Message("target.no_kind", "{kind!r} is no kind of target", kind=kind),
            where="KIND",
            todo=Message("advice.choose_kind", "choose one of {usual}", usual=tuple(USUAL)),
        )
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
    except WrongValue as error:
        raise InputError(error.what, where=kind) from error


def write_corner(board: str, paper: str, out: Path) -> str:
    """Write a PDF with the sheets of a corner's two boards to the file `out`; return what rig.toml states of them."""
    kind = cast(CornerKind, one_of(board, CORNER_KINDS, "--board"))
    name = _paper(paper)
    return known_planes_to_toml(write_corner_sheets(default_rig(), name, out, kind).known_planes)


def write_carrier_sheets(paper: str, out: Path) -> Path:
    """Write a PDF with both sides of a carrier to `out`, and beside it the carrier as printed; return that file."""
    name = _paper(paper)
    carrier, file = carrier_on(name), out.with_suffix(".toml")
    write_bytes(out, carrier_sheets(carrier, name))
    write_carrier(file, carrier)
    return file


def show_carrier(file: Path, paper: str, out: Path, *, as_json: bool) -> None:
    """Print where a carrier's PDF and its file were written; with `as_json`, as one JSON object."""
    if as_json:
        output.print_json({"paper": _paper(paper), "file": str(out), "carrier": str(file)})
        return
    rows = [(tr("paper"), _paper(paper)), (tr("written"), str(out)), (tr("carrier, as printed"), str(file))]
    output.print_rows(rows, [_PRINT_TO_SIZE])


def show_corner(tables: str, paper: str, out: Path, *, as_json: bool) -> None:
    """Print where a corner's PDF was written and what to state of it; with `as_json`, as one JSON object."""
    if as_json:
        output.print_json({"paper": _paper(paper), "file": str(out), "rig": tables})
        return
    output.print_rows([(tr("paper"), _paper(paper)), (tr("written"), str(out))], [_PRINT_TO_SIZE])
    sys.stdout.write(f"\n{tables}")


def target_of_rig(path: Path, which: str) -> Target:
    """Read a calibration target from a rig.toml or its recording set; `which` is "camera" or "planes"."""
    file = path / "rig.toml" if path.is_dir() else path
    rig = read_rig(file)
    require_tables(rig, file, "camera_target" if which == "camera" else "plane_target")
    return rig.camera_target if which == "camera" else rig.plane_target


def one_choice(kind: str, rig: Path | None) -> None:
    """Raise InputError unless either a kind of target or a rig.toml is given, and not both."""
    if bool(kind) == (rig is not None):
        what = (
            Message("target.kind_and_rig", "both a kind of target and a rig are given")
            if kind
            else Message("target.none_given", "nothing says which target to print")
        )
        raise InputError(
            what,
            where="KIND, --rig",
            todo=Message("advice.give_kind_or_rig", "give one of {usual}, or --rig FILE", usual=tuple(USUAL)),
        )


def write_sheet(target: Target, paper: str, title: str, out: Path) -> None:
    """Write a PDF with the calibration target to scale on `paper` to the file `out`."""
    write_bytes(out, target_sheet(target, _paper(paper), title=title))


def show_sheet(target: Target, paper: str, out: Path, *, as_json: bool) -> None:
    """Print where the target's PDF was written and how to print it; with `as_json`, as one JSON object."""
    name = _paper(paper)
    layout = sheet_layout(target, name)
    sheet = tr("{paper}, {width:g} × {height:g} mm", paper=name, width=layout.width_mm, height=layout.height_mm)
    if as_json:
        output.print_json({"target": target_in_words(target), "paper": name, "file": str(out)})
        return
    output.print_rows(
        [(tr("target"), target_in_words(target, output.words())), (tr("paper"), sheet), (tr("written"), str(out))],
        [_PRINT_TO_SIZE],
    )


def write_card(paper: str, out: Path) -> None:
    """Write the quick card as a PDF on `paper` to the file `out`."""
    chosen = cast(Paper, one_of(paper, PAPERS, "--paper") or "A4")
    write_quick_card(out, output.words().language.name, chosen)


def show_card(out: Path, *, as_json: bool) -> None:
    """Print where the quick card was written; with `as_json`, as one JSON object."""
    if as_json:
        output.print_json({"file": str(out)})
    else:
        output.print_rows([(tr("written"), str(out))])


def _paper(name: str) -> SheetPaper:
    for paper in PAPER_MM:
        if paper.lower() == name.lower():
            return paper
    raise InputError(
        Message("target.no_paper_known_here", "{name!r} is no paper known here", name=name),
        where="--paper",
        todo=Message("advice.choose_paper", "choose one of {paper_mm}", paper_mm=tuple(PAPER_MM)),
    )
