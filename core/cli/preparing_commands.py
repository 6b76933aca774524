"""What comes before a measurement: targets to print, pictures to import. Light to import."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from core.cli.interrupts import interruptible
from core.cli.options import Json, OrderBy, Panel, RecordedPart, WhichTarget

commands = typer.Typer()


@commands.command(rich_help_panel=Panel.PREPARE)
def target(
    out: Annotated[Path, typer.Option("--out", "-o", metavar="FILE", help="The PDF to write.")],
    kind: Annotated[
        str, typer.Argument(metavar="KIND", help="checkerboard, charuco, circle_grid, black_square, corner or carrier.")
    ] = "",
    columns: Annotated[
        int | None,
        typer.Option(metavar="N", help="Inner corners (checkerboard), squares (charuco) or circles in a row."),
    ] = None,
    rows: Annotated[int | None, typer.Option(metavar="N", help="The same in a column.")] = None,
    size_mm: Annotated[
        float | None, typer.Option("--size-mm", metavar="MM", help="Side of a square, or pitch of the circles.")
    ] = None,
    marker_mm: Annotated[
        float | None, typer.Option("--marker-mm", metavar="MM", help="Side of a ChArUco marker; else 3/4 of a square.")
    ] = None,
    dictionary: Annotated[str, typer.Option(metavar="NAME", help="OpenCV's name of the markers.")] = "DICT_4X4_100",
    asymmetric: Annotated[bool, typer.Option("--asymmetric", help="Every second row of circles moved.")] = False,
    paper: Annotated[str, typer.Option(metavar="NAME", help="A4, A3, A2, Letter or Tabloid.")] = "A4",
    title: Annotated[str, typer.Option(metavar="NAME", help="A name of yours to print with it.")] = "",
    rig: Annotated[
        Path | None, typer.Option("--rig", metavar="FILE", help="Take the target from this rig.toml instead.")
    ] = None,
    which: Annotated[WhichTarget, typer.Option(help="Which of rig.toml's two targets.")] = WhichTarget.camera,
    board: Annotated[
        str, typer.Option(metavar="NAME", help="What both boards of a corner show: charuco or rectangle.")
    ] = "charuco",
    json: Json = False,
) -> None:
    """Write a calibration target as a PDF to scale, to be printed at 100 %; of a corner or carrier, two."""
    from core.cli import preparing

    if kind == preparing.CORNER and rig is None:
        tables = preparing.write_corner(board, paper, out)
        preparing.show_corner(tables, paper, out, as_json=json)
        return
    if kind == preparing.CARRIER and rig is None:
        preparing.show_carrier(preparing.write_carrier_sheets(paper, out), paper, out, as_json=json)
        return
    preparing.one_choice(kind, rig)
    printed = (
        preparing.target_of_rig(rig, which.value)
        if rig
        else preparing.target_of_words(kind, columns, rows, size_mm, marker_mm, dictionary, asymmetric=asymmetric)
    )
    preparing.write_sheet(printed, paper, title, out)
    preparing.show_sheet(printed, paper, out, as_json=json)


@commands.command(rich_help_panel=Panel.PREPARE)
def card(
    out: Annotated[Path, typer.Option("--out", "-o", metavar="FILE", help="The PDF to write.")],
    paper: Annotated[str, typer.Option(metavar="NAME", help="A4 or Letter.")] = "A4",
    json: Json = False,
) -> None:
    """Write the quick card as a PDF: one page to hang beside the rig, in the language of this command."""
    from core.cli import preparing

    preparing.write_card(paper, out)
    preparing.show_card(out, as_json=json)


@commands.command("import", rich_help_panel=Panel.PREPARE)
def import_(
    folder: Annotated[Path, typer.Argument(metavar="SET", help="The recording set to make, or to add parts to.")],
    camera: Annotated[
        str, typer.Option(metavar="WHERE", help="Views of the camera's target: a folder, or 'FOLDER/PATTERN'.")
    ] = "",
    planes: Annotated[str, typer.Option(metavar="WHERE", help="Poses of the plane target, the fan on.")] = "",
    planes_off: Annotated[
        str,
        typer.Option("--planes-off", metavar="WHERE", help="The same poses, the fan off; else NAME_off beside NAME."),
    ] = "",
    scan: Annotated[str, typer.Option(metavar="WHERE", help="Frames of a scan.")] = "",
    reference: Annotated[
        Path | None, typer.Option(metavar="FILE", help="The scan's picture with the fan alone.")
    ] = None,
    check: Annotated[
        str, typer.Option(metavar="WHERE", help="Poses of the plane target on the day of the scan, the fan on.")
    ] = "",
    check_off: Annotated[
        str,
        typer.Option("--check-off", metavar="WHERE", help="The same poses, the fan off; else NAME_off beside NAME."),
    ] = "",
    known_planes: Annotated[
        str, typer.Option("--known-planes", metavar="WHERE", help="Boards lying beside the part during the scan.")
    ] = "",
    order: Annotated[
        OrderBy, typer.Option(help="name: numbers in names count as numbers. time: when each was taken (EXIF).")
    ] = OrderBy.name,
    rig: Annotated[Path | None, typer.Option(metavar="FILE", help="A rig.toml to copy into the set.")] = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Show what was understood, and write nothing.")] = False,
    json: Json = False,
) -> None:
    """Make a recording set of pictures that lie anywhere: linked, not copied; on and off pictures find each other.

    Put a pattern in quotes: --planes 'shots/laser_*.jpg' --planes-off 'shots/board_*.jpg' pairs what the stars
    stand for. Without patterns, equal names pair, then equal numbers in the names, then the order alone.
    """
    from core.cli import importing

    parts = {
        "camera": camera,
        "planes": planes,
        "planes_off": planes_off,
        "scan": scan,
        "check": check,
        "check_off": check_off,
        "known_planes": known_planes,
    }
    plan = importing.understood(parts, reference, order.value)
    importing.show(plan, folder, rig, dry_run=dry_run, as_json=json)


@commands.command(rich_help_panel=Panel.PREPARE)
def record(
    folder: Annotated[Path, typer.Argument(metavar="SET", help="The recording set, with rig.toml.")],
    step: Annotated[RecordedPart, typer.Argument(metavar="PART", help="camera, planes, scan or check.")],
    source: Annotated[str, typer.Option(metavar="KIND", help="As trisect sources lists them.")],
    device: Annotated[str, typer.Option(metavar="ID", help="Which of that kind; else the first one.")] = "",
    calibrations: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder of camera.json and planes.json, to judge by.")
    ] = None,
    pictures: Annotated[
        int | None, typer.Option(metavar="N", min=1, help="End after N pictures; else when no view or pose is missing.")
    ] = None,
    seconds: Annotated[
        float | None, typer.Option(metavar="S", min=0.1, help="End after S seconds of a scan; else by Ctrl-C.")
    ] = None,
    exposure: Annotated[float | None, typer.Option(metavar="MS", help="Exposure time in ms.")] = None,
    gain: Annotated[float | None, typer.Option(metavar="DB", help="Gain in dB.")] = None,
    rate: Annotated[float | None, typer.Option(metavar="HZ", help="Frames a second.")] = None,
    pgm: Annotated[
        bool, typer.Option("--pgm", help="Frames of a scan as PGM: twice the room, a tenth of the time.")
    ] = False,
    yes: Annotated[
        bool, typer.Option("--yes", help="What you are asked to do counts as done: no key is waited for.")
    ] = False,
    json: Json = False,
) -> None:
    """Record a part of a recording set from a camera; Enter answers or takes a picture, Ctrl-C ends it in order."""
    from core.acquire.settings import SourceSettings
    from core.acquire.source import SourceChoice
    from core.cli import recording

    settings = SourceSettings(exposure_ms=exposure, gain_db=gain, rate_hz=rate)
    wanted = recording.request(
        folder, step.value, SourceChoice(source, device), calibrations, settings, ".pgm" if pgm else ".png"
    )
    with interruptible() as interrupts:
        ended = recording.Recording(step.value, pictures, seconds, by_itself=yes).run(wanted)
    recording.show(ended, as_json=json)
    interrupts.check()


@commands.command(rich_help_panel=Panel.PREPARE)
def sources(json: Json = False) -> None:
    """List the cameras and other sources that can be recorded from."""
    from core.cli import recording

    recording.show_sources(as_json=json)
