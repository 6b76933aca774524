"""`trisect run` and its steps, each alone, and many sets. Light to import; the work is in `core.cli.measuring`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from core.cli.bar import bar
from core.cli.options import EPILOG, Exclude, Json, Out, Panel, Part, Profile, Set
from core.cli.setting_flags import NOTHING_TYPED, Typed, takes
from core.pipeline.taken_over import TAKEN_OVER
from core.second_process import second_process

commands = typer.Typer()

Celsius = Annotated[float | None, typer.Option(metavar="°C", help="Temperature of the air, for the rig's history.")]


@commands.command(epilog=EPILOG, rich_help_panel=Panel.MEASURE)
@takes("scan", "camera", "planes")
def run(
    folder: Set,
    out: Out,
    typed: Typed = NOTHING_TYPED,
    part: Part = "",
    exclude: Exclude = None,
    profile: Profile = False,
    json: Json = False,
) -> None:
    """Measure a recording set: calibrations, cloud, mesh, thickness, report."""
    from core.cli import arguments

    options = arguments.options(typed, part)
    options = arguments.leaving_out(options, folder, exclude)
    arguments.require_run(folder, out)
    with second_process(TAKEN_OVER) as beside:  # it starts while this one imports
        from core.cli import measuring

        with bar("run") as progress:
            watched = measuring.timed(progress, profile)
            result = measuring.run_all(folder, out, options, watched, beside)
    measuring.show_run(result, as_json=json)
    measuring.show_times(watched)
    raise typer.Exit(measuring.exit_code(result.results.verdict))


@commands.command(epilog=EPILOG, rich_help_panel=Panel.MEASURE)
@takes("scan")
def batch(
    sets: Annotated[list[Path], typer.Argument(metavar="SET", help="Recording sets, all names different.")],
    out: Out,
    executor: Annotated[
        str, typer.Option(metavar="WHO", help="processes, threads, or dask://HOST:PORT for a Dask cluster.")
    ] = "processes",
    workers: Annotated[int | None, typer.Option(metavar="N", help="Sets at a time; else one for each core.")] = None,
    typed: Typed = NOTHING_TYPED,
    json: Json = False,
) -> None:
    """Measure many recording sets side by side, each into a folder of its name in DIR."""
    from core.cli import arguments, measuring

    options = arguments.options(typed)
    with bar() as progress:
        results = measuring.run_sets(sets, out, executor, workers, options, progress)
    measuring.show_sets(results, as_json=json)
    raise typer.Exit(measuring.batch_exit_code(results))


@commands.command(rich_help_panel=Panel.CALIBRATE)
@takes("camera")
def camera(
    folder: Set,
    out: Out,
    typed: Typed = NOTHING_TYPED,
    exclude: Exclude = None,
    json: Json = False,
) -> None:
    """Calibrate the camera from SET/camera; writes camera.json."""
    from core.cli import arguments, measuring

    options = arguments.options(typed)
    options = arguments.leaving_out(options, folder, exclude)
    with bar("camera") as progress:
        shown = measuring.run_camera(folder, out, options, progress)
    shown.show(as_json=json)


@commands.command(rich_help_panel=Panel.CALIBRATE)
@takes("planes")
def planes(
    folder: Set,
    out: Out,
    typed: Typed = NOTHING_TYPED,
    exclude: Exclude = None,
    json: Json = False,
) -> None:
    """Calibrate the laser planes from SET/planes, with camera.json in DIR; writes planes.json."""
    from core.cli import arguments, measuring

    options = arguments.leaving_out(arguments.options(typed), folder, exclude)
    with bar("planes") as progress:
        shown = measuring.run_planes(folder, out, options, progress)
    shown.show(as_json=json)


@commands.command(epilog=EPILOG, rich_help_panel=Panel.CALIBRATE)
@takes("check")
def check(
    folder: Set,
    out: Out,
    typed: Typed = NOTHING_TYPED,
    celsius: Celsius = None,
    history: Annotated[
        bool, typer.Option("--history", help="Check nothing: show the checks of this rig so far, with their limits.")
    ] = False,
    adjust: Annotated[
        bool,
        typer.Option("--adjust", help="Re-adjust camera and laser in DIR by the check, if it shows that they changed."),
    ] = False,
    undo: Annotated[
        bool, typer.Option("--undo", help="Check nothing: put camera and laser in DIR back as they were calibrated.")
    ] = False,
    json: Json = False,
) -> None:
    """Check by pictures of the day in SET/check whether camera and laser are where they were calibrated, in DIR."""
    from core.cli import arguments, measuring

    if undo:
        measuring.undo_adjusting(folder, out).show(as_json=json)
        return
    if adjust:
        options = arguments.options(typed)
        with bar() as progress:
            shown = measuring.run_adjusting(folder, out, options, progress)
        shown.show(as_json=json)
        return
    if history:
        past, shown = measuring.rig_history(folder, out)
        shown.show(as_json=json)
        raise typer.Exit(measuring.exit_code(past.checks[-1].verdict if past.checks else "", good=("passed",)))
    options = arguments.options(typed)
    with bar() as progress:
        result, shown = measuring.run_check(folder, out, options, progress, celsius)
    shown.show(as_json=json)
    raise typer.Exit(measuring.exit_code("conforming" if result.passed else "changed"))


@commands.command(epilog=EPILOG, rich_help_panel=Panel.CALIBRATE)
def artefact(
    folder: Set,
    out: Out,
    id: Annotated[str, typer.Option("--id", metavar="ID", help="The artefact, as artefacts.toml calls it.")],
    characteristic: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="What of the inspection is compared, as 'ball diameter', where several could be; of a block it is the "
            "thickness if nothing is said.",
        ),
    ] = "",
    celsius: Celsius = None,
    json: Json = False,
) -> None:
    """Compare the block, sphere or step measured in DIR with its certificate; the rig's history has it."""
    from core.cli import measuring

    result, shown = measuring.run_artefact(folder, out, id, celsius, characteristic)
    shown.show(as_json=json)
    raise typer.Exit(measuring.exit_code(result.verdict, good=("passed",)))


@commands.command(rich_help_panel=Panel.MEASURE)
@takes("scan")
def scan(
    folder: Set,
    out: Out,
    typed: Typed = NOTHING_TYPED,
    exclude: Exclude = None,
    profile: Profile = False,
    json: Json = False,
) -> None:
    """Measure the surface from SET/scan, with the calibrations in DIR; writes cloud.ply and mesh.ply."""
    from core.cli import arguments, measuring

    options = arguments.options(typed)
    options = arguments.leaving_out(options, folder, exclude)
    with bar("scan") as progress:
        watched = measuring.timed(progress, profile)
        shown = measuring.run_scan(folder, out, options, watched)
    shown.show(as_json=json)
    measuring.show_times(watched)


@commands.command(epilog=EPILOG, rich_help_panel=Panel.MEASURE)
@takes("profile")
def profile(
    folder: Set,
    out: Out,
    stage: Annotated[
        str,
        typer.Option(
            metavar="NAME", help="One line only: the pose whose plane target lay on the stage, as planes/pose03."
        ),
    ] = "",
    tilt_sd: Annotated[
        float,
        typer.Option(
            "--tilt-sd",
            metavar="DEG",
            help="One line only: standard uncertainty of how the faces are tilted; without --stage the light plane "
            "is taken to stand at right angles on them.",
        ),
    ] = 0.0,
    typed: Typed = NOTHING_TYPED,
    part: Part = "",
    exclude: Exclude = None,
    json: Json = False,
) -> None:
    """Measure a thickness with the fixed lines alone, no hand-held laser: by the step in each picture of SET/scan."""
    from core.cli import arguments, measuring

    options = arguments.options(typed, part)
    options = arguments.leaving_out(options, folder, exclude)
    with bar() as progress:
        verdict, shown = measuring.run_profile(folder, out, options, stage, tilt_sd, progress)
    shown.show(as_json=json)
    raise typer.Exit(measuring.exit_code(verdict))


@commands.command(epilog=EPILOG, rich_help_panel=Panel.MEASURE)
@takes("scan")
def join(folder: Set, out: Out, typed: Typed = NOTHING_TYPED, json: Json = False) -> None:
    """Join the scan with the views in SET/views by the marks of SET/carrier.toml; writes joined.ply and joint.json."""
    from core.cli import arguments, measuring

    options = arguments.options(typed)
    with bar("scan") as progress:
        verdict, shown = measuring.run_join(folder, out, options, progress)
    shown.show(as_json=json)
    raise typer.Exit(measuring.exit_code(verdict))


@commands.command(epilog=EPILOG, rich_help_panel=Panel.MEASURE)
def gauge(folder: Set, out: Out, json: Json = False) -> None:
    """Measure the thickness of the cloud in DIR as SET/rig.toml asks; writes gauge.json."""
    from core.cli import measuring

    with bar() as progress:
        verdict, shown = measuring.run_gauge(folder, out, progress)
    shown.show(as_json=json)
    raise typer.Exit(measuring.exit_code(verdict))
