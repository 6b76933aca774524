"""`trisect compare`. Light to import; the work is in `core.wings.geometry.comparing`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from core.cli.bar import bar
from core.cli.options import Json, Panel

commands = typer.Typer()


@commands.command(rich_help_panel=Panel.RESULTS)
def compare(
    before: Annotated[
        Path,
        typer.Argument(
            metavar="OTHER",
            help="What it is compared with, as it was before or should be: a folder of results, a project, or a PLY, "
            "STL, STEP or E57 file in mm.",
        ),
    ],
    results: Annotated[Path, typer.Argument(metavar="DIR", help="The scan: a folder of results or a project.")],
    align: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="auto: by part coordinates if both have them, else as measured. Or: as measured, frame, best fit.",
        ),
    ] = "auto",
    diameter: Annotated[
        float,
        typer.Option(metavar="MM", help="Of the cylinders both are compared in; 0: as small as the points allow."),
    ] = 0.0,
    reach: Annotated[float, typer.Option(metavar="MM", help="The largest deviation that is looked for.")] = 2.0,
    registration: Annotated[
        float | None,
        typer.Option(
            metavar="MM",
            help="Standard uncertainty of how both lie on each other; else by what most of the surface shows.",
        ),
    ] = None,
    to: Annotated[Path | None, typer.Option("--to", metavar="FOLDER", help="Write there instead of into DIR.")] = None,
    json: Json = False,
) -> None:
    """Compare a scan with another one or any surface: where it differs significantly; writes comparison.*."""
    from core.wings.geometry import comparing as work

    with bar() as progress:
        shown = work.run_compare(results, before, align, (diameter, reach, registration), to, progress)
    shown.show(as_json=json)
