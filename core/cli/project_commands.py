"""What is done with projects of the window as a whole: packed into one file, unpacked. Light to import."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from core.cli.bars import bars
from core.cli.options import Json

commands = typer.Typer()


@commands.command()
def pack(
    project: Annotated[Path, typer.Argument(metavar="PROJECT", help="The folder of a project.")],
    out: Annotated[Path, typer.Option("--out", "-o", metavar="FILE", help="The file to write: NAME.trisectz.")],
    json: Json = False,
) -> None:
    """Pack a project into one file, with all its pictures and the SHA-256 of every file."""
    from core.cli.measuring import Shown
    from core.files.project.packing import pack_project

    with bars() as progress:
        made = pack_project(project, out, progress)
    rows = [("files", str(made.files)), ("size", f"{made.bytes / 1e6:.1f} MB")]
    Shown(rows, {"files_packed": made.files, "bytes": made.bytes}, files={"packed": made.path}).show(as_json=json)


@commands.command()
def unpack(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A packed project: NAME.trisectz.")],
    out: Annotated[Path, typer.Option("--out", "-o", metavar="FOLDER", help="The folder to make.")],
    json: Json = False,
) -> None:
    """Make the folder of a packed project; every file is checked against its SHA-256."""
    from core.cli.measuring import Shown
    from core.files.project.packing import unpack_project

    with bars() as progress:
        folder = unpack_project(file, out, progress)
    Shown([("project", str(folder))], {"project": str(folder)}).show(as_json=json)
