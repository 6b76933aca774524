"""What is printed before anything is measured: a target to scale, and the quick card."""

from __future__ import annotations

from pathlib import Path

from core.files.atomic import write_bytes
from core.image.targets import Target
from core.progress import Progress, silent
from core.report.quick_card import quick_card
from core.report.target_sheet import SheetPaper, target_sheet
from core.report.template import Paper


def write_target_sheet(
    path: Path, target: Target, paper: SheetPaper = "A4", title: str = "", progress: Progress = silent
) -> Path:
    """Write a sheet with `target` to scale on one page, and return its path.

    Raises
    ------
    InputError
        If the target does not fit the paper, or nothing can be written there.
    """
    progress("drawing the target", 0, 1)
    write_bytes(path, target_sheet(target, paper, title=title))
    return path


def write_quick_card(path: Path, language: str = "en", paper: Paper = "A4") -> Path:
    """Write a quick-reference page, a PDF to hang beside the rig, and return its path.

    Raises
    ------
    InputError
        If nothing can be written there.
    """
    write_bytes(path, quick_card(language, paper))
    return path
