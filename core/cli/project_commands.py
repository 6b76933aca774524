"""What is done with projects of the window as a whole: packed, unpacked, made for the next part. Light to import."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from core.cli.bar import bar
from core.cli.language import current_language, tr
from core.cli.options import Json, Panel

commands = typer.Typer()


@commands.command(rich_help_panel=Panel.PROJECTS)
def pack(
    project: Annotated[Path, typer.Argument(metavar="PROJECT", help="The folder of a project.")],
    out: Annotated[Path, typer.Option("--out", "-o", metavar="FILE", help="The file to write: NAME.trisectz.")],
    json: Json = False,
) -> None:
    """Pack a project into one file, with all its pictures and the SHA-256 of every file."""
    from core.cli.measuring import Shown
    from core.files.project.packing import pack_project

    with bar() as progress:
        made = pack_project(project, out, progress)
    rows = [(tr("files"), str(made.files)), (tr("size"), tr("{size:.1f} MB", size=made.bytes / 1e6))]
    Shown(rows, {"files_packed": made.files, "bytes": made.bytes}, files={"packed": made.path}).show(as_json=json)


@commands.command("next-part", rich_help_panel=Panel.PROJECTS)
def next_part(
    project: Annotated[Path, typer.Argument(metavar="PROJECT", help="The folder of the last part's project.")],
    serial: Annotated[str, typer.Option(metavar="NUMBER", help="Serial number of the next part.")],
    operator: Annotated[str, typer.Option(metavar="NAME", help="Who measures it.")],
    out: Annotated[Path, typer.Option("--out", "-o", metavar="FOLDER", help="The folder to make.")],
    json: Json = False,
) -> None:
    """Make the project of the next part of a series: the same calibrations, plan and report, nothing measured."""
    from core.cli.measuring import Shown
    from core.files.project import next_part as series

    with bar() as progress:
        folder = series.next_part(project, out, serial, operator, progress=progress)
    Shown([(tr("project"), str(folder))], {"project": str(folder)}).show(as_json=json)


@commands.command(rich_help_panel=Panel.PROJECTS)
def script(
    project: Annotated[Path, typer.Argument(metavar="PROJECT", help="The folder of a project.")],
    out: Annotated[Path, typer.Option("--out", "-o", metavar="FILE", help="The Python script to write: NAME.py.")],
    json: Json = False,
) -> None:
    """Write what was done in a project as a script of these commands, which gives the same results."""
    from core.cli.measuring import Shown
    from core.pipeline.project.script import write_script

    path = write_script(project, out, current_language().name)
    Shown([], {}, files={"script": path}).show(as_json=json)


@commands.command(rich_help_panel=Panel.PROJECTS)
def unpack(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A packed project: NAME.trisectz.")],
    out: Annotated[Path, typer.Option("--out", "-o", metavar="FOLDER", help="The folder to make.")],
    json: Json = False,
) -> None:
    """Make the folder of a packed project; every file is checked against its SHA-256."""
    from core.cli.measuring import Shown
    from core.files.project.packing import unpack_project

    with bar() as progress:
        folder = unpack_project(file, out, progress)
    Shown([(tr("project"), str(folder))], {"project": str(folder)}).show(as_json=json)
