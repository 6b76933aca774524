"""What is done with projects of the window as a whole: packed into one file, unpacked, verified. Light to import."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from core.cli.bars import bars
from core.cli.options import EPILOG, ExitCode, Json

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


@commands.command(epilog=EPILOG)
def verify(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A project, or a folder of results.")],
    set_: Annotated[
        Path | None, typer.Option("--set", metavar="SET", help="The recording set that a folder of results is of.")
    ] = None,
    head: Annotated[
        str, typer.Option(metavar="HASH", help="What a report prints of the audit trail: is it one of this project's?")
    ] = "",
    json: Json = False,
) -> None:
    """Is everything still what it was? The audit trail link by link, the results, and all they were made of."""
    from core.cli.measuring import Shown
    from core.pipeline.project.verify import verify as compare

    with bars() as progress:
        found = compare(folder, set_, head, progress)
    rows = [
        ("audit trail", f"{len(found.trail.entries)} entries, head {found.trail.head or 'none'}"),
        ("results", f"{found.results} compared"),
        ("inputs", f"{found.inputs} compared"),
        ("differs", str(len(found.problems))),
        *(("", str(problem)) for problem in found.problems),
    ]
    values = {
        "entries": len(found.trail.entries),
        "head": found.trail.head,
        "results": found.results,
        "inputs": found.inputs,
        "problems": [str(problem) for problem in found.problems],
    }
    Shown(rows, values, found.notes).show(as_json=json)
    raise typer.Exit(ExitCode.NOT_PROVEN if found.problems else ExitCode.DONE)


@commands.command()
def audit(
    project: Annotated[Path, typer.Argument(metavar="PROJECT", help="The folder of a project.")],
    csv: Annotated[Path | None, typer.Option("--csv", metavar="FILE", help="Write it as a table, too.")] = None,
    remark: Annotated[str, typer.Option(metavar="TEXT", help="Add an entry with this text first.")] = "",
    json: Json = False,
) -> None:
    """Show a project's audit trail: who did what and when, old and new."""
    from core.cli.measuring import Shown
    from core.files.atomic import write_text
    from core.files.project.audit import append, read_trail, trail_table
    from core.files.project.folder import read_project

    read_project(project)
    if remark:
        append(project, "remark", why=remark)
    trail = read_trail(project)
    rows = []
    for entry in trail.entries:
        rows.append((f"{entry.n}  {entry.at:%Y-%m-%d %H:%M:%S}", f"{entry.what} by {entry.who} on {entry.host}"))
        rows += [("", f"{one.field}: {one.old or '–'} → {one.new or '–'}") for one in entry.changes]
        rows += [("", f"{name}: {digest}") for name, digest in entry.files.items()]
        rows += [("", entry.why)] if entry.why else []
    if csv is not None:
        write_text(csv, trail_table(trail))
    entries = [
        {**asdict(entry), "at": entry.at.isoformat(), "changes": [asdict(one) for one in entry.changes]}
        for entry in trail.entries
    ]
    files = {"table": csv} if csv is not None else {}
    Shown(rows, {"entries": entries, "head": trail.head}, trail.problems, files).show(as_json=json)
