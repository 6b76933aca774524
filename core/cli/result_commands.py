"""What is done with results: inspection, mesh, report, exchange with other programs. Light to import."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from core.cli.bar import bar
from core.cli.options import EPILOG, Json, Out, Panel, Part, Set

commands = typer.Typer()


class FrameChoice(StrEnum):
    """Frame in which geometry is exported."""

    PART = "part"
    CAMERA = "camera"


Frame = Annotated[
    FrameChoice,
    typer.Option(
        "--frame",
        help="Frame of clouds, surfaces and geometry: the part's (its part coordinates, else z up from the lower face; "
        "the camera's where neither is known), or the camera's.",
    ),
]
Template = Annotated[
    Path | None, typer.Option("--template", metavar="FILE", help="A company's template of reports (TOML).")
]
Language = Annotated[
    str, typer.Option("--language", metavar="CODE", help="en, de or zh_CN; else the template's, or en.")
]
Serial = Annotated[str, typer.Option("--serial", metavar="TEXT", help="Serial number of the part.")]
Customer = Annotated[str, typer.Option("--customer", metavar="NAME", help="Who it is measured for.")]
Operator = Annotated[str, typer.Option("--operator", metavar="NAME", help="Who measured.")]


@commands.command(epilog=EPILOG, rich_help_panel=Panel.MEASURE)
def inspect(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="SET|DIR|CLOUD",
            help="A recording set (its results with --out), a folder of results, or a cloud.ply.",
        ),
    ],
    plan: Annotated[Path, typer.Option("--plan", "-p", metavar="FILE", help="What is to be inspected: a plan.toml.")],
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", metavar="DIR", help="Folder of the results; inspection.json goes there."),
    ] = None,
    json: Json = False,
) -> None:
    """Measure the features of a plan on a scan; writes inspection.json."""
    from core.cli import results as work

    with bar() as progress:
        inspection, written = work.run_inspect(source, plan, out, progress)
    work.show_inspection(inspection, written, as_json=json)
    raise typer.Exit(work.inspection_exit_code(inspection, written))


@commands.command(rich_help_panel=Panel.RESULTS)
def mesh(
    results: Annotated[Path, typer.Argument(metavar="DIR", help="A folder of results.")],
    formats: Annotated[
        list[str], typer.Option("--format", "-f", metavar="NAMES", help="ply, stl, obj or 3mf; several with commas.")
    ],
    fill_holes: Annotated[
        float, typer.Option("--fill-holes", metavar="MM", help="Fill holes up to this span, marked; 0: none.")
    ] = 0.0,
    triangles: Annotated[int, typer.Option(metavar="N", help="Leave about so many triangles; 0: all.")] = 0,
    error: Annotated[
        float, typer.Option(metavar="MM", help="Leave as few triangles as this largest error allows; 0: all.")
    ] = 0.0,
    to: Annotated[Path | None, typer.Option("--to", metavar="FOLDER", help="Write there instead of into DIR.")] = None,
    frame: Frame = FrameChoice.PART,
    json: Json = False,
) -> None:
    """Make the surface in DIR ready for other programs; writes surface.*, mesh.ply stays as it is."""
    from core.cli import results as work
    from core.pipeline.steps.mesh_step import MeshOptions

    with bar() as progress:
        options = MeshOptions(fill_holes, triangles, error)
        shown = work.run_mesh(results, formats, options, to, progress, in_camera_frame=frame is FrameChoice.CAMERA)
    shown.show(as_json=json)


@commands.command(rich_help_panel=Panel.RESULTS)
def report(
    folder: Set,
    out: Out,
    part: Part = "",
    template: Template = None,
    language: Language = "",
    paper: Annotated[str, typer.Option(metavar="NAME", help="A4 or Letter; else the template's, or A4.")] = "",
    without: Annotated[
        list[str] | None,
        typer.Option("--without", metavar="SECTION", help="Leave this section out, as frame; repeat for more."),
    ] = None,
    serial: Serial = "",
    customer: Customer = "",
    operator: Operator = "",
    study: Annotated[
        list[Path] | None,
        typer.Option(
            "--study", metavar="FILE", help="Print this study as well: a study.json or its folder; repeat for more."
        ),
    ] = None,
    json: Json = False,
) -> None:
    """Put the results of SET in DIR into report.pdf, with inspection.json where there is one."""
    from core.cli import results as work

    chosen = work.ReportOptions(part, template, language, paper, without or (), serial, customer, operator, study or ())
    with bar("make_report") as progress:
        shown = work.run_report(folder, out, chosen, progress)
    shown.show(as_json=json)


@commands.command(rich_help_panel=Panel.RESULTS)
def export(
    results: Annotated[Path, typer.Argument(metavar="DIR", help="A folder of results.")],
    formats: Annotated[
        list[str],
        typer.Option(
            "--format",
            "-f",
            metavar="NAMES",
            help="Of clouds: cloud, e57, csv; of surfaces: mesh, stl, obj, 3mf; of results: table, xlsx, results, dfq, "
            "qif, dcc, dxf, json; of a comparison: compared, compared-csv; of the camera: opencv, opencv-json, ros; "
            "or pdf. Several with commas.",
        ),
    ],
    to: Annotated[Path | None, typer.Option("--to", metavar="FOLDER", help="Write there instead of into DIR.")] = None,
    frame: Frame = FrameChoice.PART,
    part: Part = "",
    template: Template = None,
    serial: Serial = "",
    customer: Customer = "",
    operator: Operator = "",
    json: Json = False,
) -> None:
    """Write the results in DIR in the formats of other programs."""
    from core.cli import results as work

    chosen = work.ReportOptions(part, template, serial=serial, customer=customer, operator=operator)
    with bar() as progress:
        in_camera_frame = frame is FrameChoice.CAMERA
        shown = work.run_export(results, formats, to, chosen, progress, in_camera_frame=in_camera_frame)
    shown.show(as_json=json)


@commands.command("import-camera", rich_help_panel=Panel.CALIBRATE)
def import_camera(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="OpenCV's FileStorage (YAML, JSON, XML) or ROS's YAML.")],
    out: Out,
    json: Json = False,
) -> None:
    """Take a camera calibrated by OpenCV or ROS; writes camera.json."""
    from core.cli import results as work

    work.run_import(file, out).show(as_json=json)
