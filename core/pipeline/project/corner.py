"""A printed corner of two boards: what rig.toml states of them, and their sheets."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from core.files.atomic import write_bytes
from core.files.recording.rig import KnownPlaneTarget, Rig, known_planes_to_toml
from core.report.corner_sheet import CornerKind, corner_sheets, corner_targets
from core.report.target_sheet import SheetPaper


def corner_of_boards(kind: CornerKind, paper: SheetPaper) -> dict[str, KnownPlaneTarget]:
    """State the boards of a corner printed on sheets of `paper`: one print, so one error of size."""
    targets = corner_targets(kind, paper)
    first = next(iter(targets))
    return {
        name: KnownPlaneTarget(target, print_of=None if name == first else first) for name, target in targets.items()
    }


def write_corner_sheets(rig: Rig, paper: SheetPaper, out: Path, kind: CornerKind = "charuco") -> Rig:
    """Write the sheets of a corner to the PDF `out`, and return the `rig` with its boards stated.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    stated = corner_of_boards(kind, paper)
    targets = {name: board.target for name, board in stated.items()}
    write_bytes(out, corner_sheets(targets, paper, known_planes_to_toml(stated)))
    return replace(rig, known_planes=stated)
