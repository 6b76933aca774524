"""`trisect plan`: what a rig would measure. Light to import."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from core.cli.bar import bar
from core.cli.options import Json, Panel
from core.cli.setting_flags import NOTHING_TYPED, Typed, takes

commands = typer.Typer()


@commands.command(rich_help_panel=Panel.PREPARE)
@takes("plan")
def plan(
    rig: Annotated[Path, typer.Argument(metavar="RIG", help="A rig.toml, or the recording set that holds it.")],
    out: Annotated[
        Path | None, typer.Option("--out", "-o", metavar="DIR", help="Write plan.json and sigma.png there.")
    ] = None,
    scans: Annotated[int, typer.Option(metavar="N", help="Scans drawn for the prediction.")] = 2,
    no_changes: Annotated[
        bool, typer.Option("--no-changes", help="Do not try which change of the rig helps most: sooner done.")
    ] = False,
    typed: Typed = NOTHING_TYPED,
    bounds: Annotated[
        bool, typer.Option("--bounds", help="Also say what no program could do better (Cramér–Rao), as a table.")
    ] = False,
    json: Json = False,
) -> None:
    """Predict what a rig will measure, before anything is bolted down: U of a thickness, σ, what helps most."""
    from core.cli import arguments
    from core.wings.rig_planning.planning import run_plan

    options = arguments.options(typed)
    with bar() as progress:
        shown = run_plan(
            rig, out, scans=scans, changes=not no_changes, options=options, bounds=bounds, progress=progress
        )
    shown.show(as_json=json)
