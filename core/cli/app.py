"""`trisect`: what each command takes, and what its exit code says.

0: done, and conforming if a verdict was asked for. 1: measured, but out of tolerance or not proven. 2: bad input, told
in one sentence on standard error. 130: interrupted. Numbers come from the rooms below; here is only talk. Those rooms
are imported by the command that needs them: so `trisect --help` answers at once.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from enum import Enum
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from core import __version__
from core.cli.bars import bars
from core.cli.study_commands import studies
from core.errors import Cancelled, InputError
from core.simulate.scenario import CAMERA_TARGETS, OBJECTS, PLANE_TARGETS, Scenario

BAD_INPUT, INTERRUPTED = 2, 130

SCENARIO = Scenario()
"""The defaults of a simulated recording."""

EPILOG = "Exit code: 0 done, 1 measured but out of tolerance or not proven, 2 bad input, 130 interrupted."


class Method(str, Enum):  # noqa: UP042  (Typer shows the values of a str Enum)
    """How a scan is solved."""

    network = "network"
    three_crossings = "three-crossings"


class Which(str, Enum):  # noqa: UP042
    """One of a rig's two targets."""

    camera = "camera"
    plane = "plane"


Set = Annotated[Path, typer.Argument(metavar="SET", help="The recording set: a folder with rig.toml and pictures.")]
Out = Annotated[Path, typer.Option("--out", "-o", metavar="DIR", help="Folder of the results; made if need be.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object for machines instead of a table.")]
MethodOption = Annotated[
    Method,
    typer.Option(
        help="network: all sweeps adjusted together. three-crossings: each frame from its own crossings with the fan, "
        "the paper's method, for comparison."
    ),
]
SigmaCut = Annotated[
    float, typer.Option("--sigma-cut", metavar="MM", help="Leave out points with a larger standard uncertainty.")
]
NoSkew = Annotated[bool, typer.Option("--no-skew", help="Fix the camera's skew γ to 0.")]
Part = Annotated[str, typer.Option(metavar="NAME", help="Name of the part in the report; else the name of SET.")]
K3 = Annotated[bool, typer.Option("--k3", help="Free the third radial coefficient, for wide lenses.")]


AdjustCamera = Annotated[
    bool,
    typer.Option(
        "--adjust-camera",
        help="Let the poses of the plane target correct the camera, in one adjustment with the fan: for a plane target "
        "of many points, or a camera calibrated from few views.",
    ),
]


StripeWidth = Annotated[
    float,
    typer.Option(
        "--stripe-width", metavar="PX", help="Visible width of the scan's stripes; 0: chosen from the pictures."
    ),
]
Contrast = Annotated[
    float,
    typer.Option("--contrast", metavar="GREY", help="Height of a rather faint stripe above its background; 0: chosen."),
]


Exclude = Annotated[
    list[str] | None,
    typer.Option(
        "--exclude",
        metavar="NAME",
        help="Leave this picture out: camera/view03.png, planes/pose02 or scan/frame0007.png; repeat for more.",
    ),
]


Profile = Annotated[
    bool, typer.Option("--profile", help="Say on standard error what each stage has cost in processor time.")
]


class _Commands(TyperGroup):
    """The commands; Ctrl-C passes through as `Cancelled`, or Typer would leave with the code of "not proven"."""

    def invoke(self, ctx: typer.Context) -> Any:  # type: ignore[override]
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as interrupt:
            raise Cancelled from interrupt


app = typer.Typer(
    name="trisect",
    cls=_Commands,
    help="Measure a part with one camera, a fixed three-line laser and a hand-moved single-line laser.",
    epilog=EPILOG,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
app.add_typer(studies, name="study")


def _say_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"trisect {__version__}")
        raise typer.Exit


@app.callback()
def _trisect(
    version: Annotated[
        bool, typer.Option("--version", callback=_say_version, is_eager=True, help="Print the version and leave.")
    ] = False,
) -> None:
    """Only holds --version; the commands do the rest."""


@app.command(epilog=EPILOG)
def run(
    folder: Set,
    out: Out,
    method: MethodOption = Method.network,
    sigma_cut: SigmaCut = 0.05,
    stripe_width: StripeWidth = 0.0,
    contrast: Contrast = 0.0,
    no_skew: NoSkew = False,
    k3: K3 = False,
    adjust_camera: AdjustCamera = False,
    part: Part = "",
    exclude: Exclude = None,
    profile: Profile = False,
    json: Json = False,
) -> None:
    """Measure a recording set: calibrations, cloud, mesh, thickness, report."""
    from core.cli import measuring

    options = measuring.options(
        method.value,
        sigma_cut,
        skew=not no_skew,
        k3=k3,
        part=part,
        stripe_width=stripe_width,
        contrast=contrast,
        adjust_camera=adjust_camera,
    )
    options = measuring.leaving_out(options, folder, exclude)
    with bars() as progress:
        watched = measuring.timed(progress, profile)
        result = measuring.run_all(folder, out, options, watched)
    measuring.show_run(result, as_json=json)
    measuring.show_times(watched)
    raise typer.Exit(measuring.exit_code(result.gauge))


@app.command(epilog=EPILOG)
def batch(
    sets: Annotated[list[Path], typer.Argument(metavar="SETS…", help="Recording sets, all names different.")],
    out: Out,
    executor: Annotated[
        str, typer.Option(metavar="WHO", help="processes, threads, or dask://HOST:PORT for a Dask cluster.")
    ] = "processes",
    workers: Annotated[int | None, typer.Option(metavar="N", help="Sets at a time; else one for each core.")] = None,
    method: MethodOption = Method.network,
    sigma_cut: SigmaCut = 0.05,
    json: Json = False,
) -> None:
    """Measure many recording sets side by side, each into a folder of its name in DIR."""
    from core.cli import batching, measuring

    options = measuring.options(method.value, sigma_cut)
    with bars() as progress:
        results = batching.run_sets(sets, out, executor, workers, options, progress)
    batching.show(results, as_json=json)
    raise typer.Exit(batching.exit_code(results))


@app.command()
def camera(
    folder: Set, out: Out, no_skew: NoSkew = False, k3: K3 = False, exclude: Exclude = None, json: Json = False
) -> None:
    """Calibrate the camera from SET/camera; writes camera.json."""
    from core.cli import measuring

    options = measuring.leaving_out(measuring.options("network", 0.05, skew=not no_skew, k3=k3), folder, exclude)
    with bars() as progress:
        shown = measuring.run_camera(folder, out, options, progress)
    shown.show(as_json=json)


@app.command()
def planes(
    folder: Set, out: Out, adjust_camera: AdjustCamera = False, exclude: Exclude = None, json: Json = False
) -> None:
    """Calibrate the fan's light planes from SET/planes, with camera.json in DIR; writes planes.json."""
    from core.cli import measuring

    chosen = measuring.options("network", 0.05, adjust_camera=adjust_camera)
    options = measuring.leaving_out(chosen, folder, exclude)
    with bars() as progress:
        shown = measuring.run_planes(folder, out, options, progress)
    shown.show(as_json=json)


@app.command()
def scan(
    folder: Set,
    out: Out,
    method: MethodOption = Method.network,
    sigma_cut: SigmaCut = 0.05,
    stripe_width: StripeWidth = 0.0,
    contrast: Contrast = 0.0,
    exclude: Exclude = None,
    profile: Profile = False,
    json: Json = False,
) -> None:
    """Measure the surface from SET/scan, with the calibrations in DIR; writes cloud.ply and mesh.ply."""
    from core.cli import measuring

    options = measuring.options(method.value, sigma_cut, stripe_width=stripe_width, contrast=contrast)
    options = measuring.leaving_out(options, folder, exclude)
    with bars() as progress:
        watched = measuring.timed(progress, profile)
        shown = measuring.run_scan(folder, out, options, watched)
    shown.show(as_json=json)
    measuring.show_times(watched)


@app.command(epilog=EPILOG)
def gauge(folder: Set, out: Out, json: Json = False) -> None:
    """Measure the thickness of the cloud in DIR as SET/rig.toml asks; writes gauge.json."""
    from core.cli import measuring

    with bars() as progress:
        result, shown = measuring.run_gauge(folder, out, progress)
    shown.show(as_json=json)
    raise typer.Exit(measuring.exit_code(result))


Template = Annotated[
    Path | None, typer.Option("--template", metavar="FILE", help="A company's template of reports (TOML).")
]
Language = Annotated[str, typer.Option("--language", metavar="CODE", help="en or de; else the template's, or en.")]
Serial = Annotated[str, typer.Option("--serial", metavar="TEXT", help="Serial number of the part.")]
Customer = Annotated[str, typer.Option("--customer", metavar="NAME", help="Who it is measured for.")]
Operator = Annotated[str, typer.Option("--operator", metavar="NAME", help="Who measured.")]


@app.command()
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
        typer.Option("--study", metavar="FILE", help="Print this study.json as well; repeat for more."),
    ] = None,
    json: Json = False,
) -> None:
    """Put the results in DIR into report.pdf."""
    from core.cli import reporting

    chosen = reporting.ReportOptions(
        part, template, language, paper, without or (), serial, customer, operator, study or ()
    )
    with bars() as progress:
        shown = reporting.run_report(folder, out, chosen, progress)
    shown.show(as_json=json)


@app.command()
def export(
    results: Annotated[Path, typer.Argument(metavar="DIR", help="A folder of results.")],
    formats: Annotated[
        list[str],
        typer.Option(
            "--format",
            "-f",
            metavar="NAMES",
            help="Of clouds: cloud, e57, csv; of surfaces: mesh, stl, obj, 3mf; of results: table, xlsx, results, dfq, "
            "qif, json; of the camera: opencv, opencv-json, ros; or pdf. Several with commas.",
        ),
    ],
    to: Annotated[Path | None, typer.Option("--to", metavar="FOLDER", help="Write there instead of into DIR.")] = None,
    part: Part = "",
    template: Template = None,
    serial: Serial = "",
    customer: Customer = "",
    operator: Operator = "",
    json: Json = False,
) -> None:
    """Write the results in DIR in the formats of other programs."""
    from core.cli import reporting

    chosen = reporting.ReportOptions(part, template, serial=serial, customer=customer, operator=operator)
    with bars() as progress:
        shown = reporting.run_export(results, formats, to, chosen, progress)
    shown.show(as_json=json)


@app.command(name="import-camera")
def import_camera(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="OpenCV's FileStorage (YAML, JSON, XML) or ROS's YAML.")],
    out: Out,
    json: Json = False,
) -> None:
    """Take a camera calibrated by OpenCV or ROS; writes camera.json."""
    from core.cli import reporting

    reporting.run_import(file, out).show(as_json=json)


@app.command(epilog=EPILOG)
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
    from core.cli import inspecting

    with bars() as progress:
        inspection, written = inspecting.run_inspect(source, plan, out, progress)
    inspecting.show(inspection, written, as_json=json)
    raise typer.Exit(inspecting.exit_code(inspection))


@app.command()
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
    json: Json = False,
) -> None:
    """Make the surface in DIR ready for other programs; writes surface.*, mesh.ply stays as it is."""
    from core.cli import meshing
    from core.pipeline.mesh_step import MeshOptions

    with bars() as progress:
        shown = meshing.run_mesh(results, formats, MeshOptions(fill_holes, triangles, error), to, progress)
    shown.show(as_json=json)


@app.command()
def target(
    out: Annotated[Path, typer.Option("--out", "-o", metavar="FILE", help="The PDF to write.")],
    kind: Annotated[
        str, typer.Argument(metavar="KIND", help="checkerboard, charuco, circle_grid or black_square.")
    ] = "",
    columns: Annotated[
        int | None, typer.Option(help="Inner corners (checkerboard), squares (charuco) or circles in a row.")
    ] = None,
    rows: Annotated[int | None, typer.Option(help="The same in a column.")] = None,
    size_mm: Annotated[
        float | None, typer.Option("--size-mm", metavar="MM", help="Side of a square, or pitch of the circles.")
    ] = None,
    marker_mm: Annotated[
        float | None, typer.Option("--marker-mm", metavar="MM", help="Side of a ChArUco marker; else 3/4 of a square.")
    ] = None,
    dictionary: Annotated[str, typer.Option(metavar="NAME", help="OpenCV's name of the markers.")] = "DICT_4X4_100",
    asymmetric: Annotated[bool, typer.Option("--asymmetric", help="Every second row of circles moved.")] = False,
    paper: Annotated[str, typer.Option(help="A4, A3, A2, Letter or Tabloid.")] = "A4",
    title: Annotated[str, typer.Option(metavar="NAME", help="A name of yours to print with it.")] = "",
    rig: Annotated[
        Path | None, typer.Option("--rig", metavar="FILE", help="Take the target from this rig.toml instead.")
    ] = None,
    which: Annotated[Which, typer.Option(help="Which of rig.toml's two targets.")] = Which.camera,
    json: Json = False,
) -> None:
    """Write a calibration target as a PDF to scale, to be printed at 100 %."""
    from core.cli import target_sheets

    target_sheets.chosen(kind, rig)
    printed = (
        target_sheets.from_rig(rig, which.value)
        if rig
        else target_sheets.described(kind, columns, rows, size_mm, marker_mm, dictionary, asymmetric=asymmetric)
    )
    target_sheets.write_sheet(printed, paper, title, out)
    target_sheets.show(printed, paper, out, as_json=json)


@app.command()
def plan(
    rig: Annotated[Path, typer.Argument(metavar="RIG", help="A rig.toml, or the recording set that holds it.")],
    out: Annotated[
        Path | None, typer.Option("--out", "-o", metavar="DIR", help="Write plan.json and sigma.png there.")
    ] = None,
    scans: Annotated[int, typer.Option(help="Scans drawn for the prediction.")] = 2,
    no_changes: Annotated[
        bool, typer.Option("--no-changes", help="Do not try which change of the rig helps most: sooner done.")
    ] = False,
    sigma_cut: SigmaCut = 0.05,
    json: Json = False,
) -> None:
    """Predict what a rig will measure, before anything is bolted down: U of a thickness, σ, what helps most."""
    from core.cli import planning

    with bars() as progress:
        shown = planning.run_plan(rig, out, scans=scans, changes=not no_changes, sigma_cut=sigma_cut, progress=progress)
    shown.show(as_json=json)


@app.command()
def simulate(
    thing: Annotated[str, typer.Argument(metavar="OBJECT", help=f"What stands on the table: {', '.join(OBJECTS)}.")],
    out: Annotated[Path, typer.Option("--out", "-o", metavar="SET", help="Folder of the new recording set.")],
    height: Annotated[
        float, typer.Option("--height", metavar="MM", help="Height of a block or mask, diameter of a sphere.")
    ] = SCENARIO.height_mm,
    stl: Annotated[str, typer.Option("--stl", metavar="FILE", help="The file of an stl.")] = SCENARIO.stl_path,
    frames: Annotated[int, typer.Option(help="Frames of the scan.")] = SCENARIO.frames,
    views: Annotated[int, typer.Option(help="Views of the camera target.")] = SCENARIO.camera_views,
    poses: Annotated[int, typer.Option(help="Poses of the plane target.")] = SCENARIO.plane_poses,
    seed: Annotated[int, typer.Option(help="The same seed gives the same pictures.")] = SCENARIO.seed,
    scale: Annotated[float, typer.Option(help="Picture size over 3840 × 2748.")] = SCENARIO.scale,
    noise: Annotated[float, typer.Option(help="Factor on shot and read noise; 0 for none.")] = SCENARIO.noise,
    speckle: Annotated[float, typer.Option(help="Contrast of the lasers' speckle; 0 for none.")] = SCENARIO.speckle,
    bits: Annotated[int, typer.Option(help="Depth of the pictures, 8 or 16.")] = SCENARIO.bits,
    ambient: Annotated[float, typer.Option(help="Grey level of a white surface in the room's light.")] = (
        SCENARIO.ambient_grey
    ),
    texture: Annotated[float, typer.Option(help="Relative unevenness of the surfaces.")] = SCENARIO.texture,
    camera_target: Annotated[str, typer.Option(help=f"One of {', '.join(CAMERA_TARGETS)}.")] = SCENARIO.camera_target,
    plane_target: Annotated[str, typer.Option(help=f"One of {', '.join(PLANE_TARGETS)}.")] = SCENARIO.plane_target,
    published_planes: Annotated[
        bool, typer.Option("--published-planes", help="The paper's printed planes instead of an exact 5° pencil.")
    ] = False,
    no_reference: Annotated[bool, typer.Option("--no-reference", help="Leave scan/reference.png out.")] = False,
    json: Json = False,
) -> None:
    """Render a recording set as the paper's rig would record it; its truth is written beside it, never inside."""
    from core.cli import simulating

    scenario = Scenario(
        object=thing,
        stl_path=stl,
        height_mm=height,
        frames=frames,
        camera_views=views,
        plane_poses=poses,
        seed=seed,
        scale=scale,
        noise=noise,
        speckle=speckle,
        bits=bits,
        ambient_grey=ambient,
        texture=texture,
        camera_target=camera_target,
        plane_target=plane_target,
        published_planes=published_planes,
        reference=not no_reference,
    )
    with bars() as progress:
        simulating.render(scenario, out, progress)
    simulating.show(out, as_json=json)


@app.command(epilog=EPILOG)
def demo(
    out: Annotated[Path, typer.Option("--out", "-o", metavar="DIR", help="Folder of the results.")] = Path("out"),
    quick: Annotated[bool, typer.Option("--quick", help="A smaller sample: sooner done, less exact.")] = False,
    json: Json = False,
) -> None:
    """Measure the embedded sample, a 50 mm gauge block; it is rendered on first use and kept in your cache."""
    from core.cli import measuring, simulating

    options = measuring.options("network", simulating.QUICK_CUT_MM if quick else 0.05, part=simulating.PART)
    with bars() as progress, simulating.sample(progress, quick=quick) as folder:
        result = measuring.run_all(folder, out, options, progress)
    measuring.show_run(result, as_json=json)
    if not json:
        simulating.show_demo(result)
    raise typer.Exit(measuring.exit_code(result.gauge))


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and leave with its exit code."""
    import cv2

    # OpenCV mumbles about damaged pictures on standard error; what matters is said in our own sentence.
    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    words = list(sys.argv[1:] if arguments is None else arguments)
    try:
        _run(words)
    except InputError as error:
        _refuse(str(error), as_json="--json" in words)
        sys.exit(BAD_INPUT)
    except Cancelled:
        sys.stderr.write("trisect: interrupted; what was finished before is whole, nothing is half written.\n")
        sys.exit(INTERRUPTED)
    except BrokenPipeError:
        # Whoever read our output has left; Python would complain once more when it closes standard output.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _run(words: list[str]) -> None:
    """Run the commands; they leave by SystemExit with their own code."""
    try:
        app(words, prog_name="trisect")
    finally:
        sys.stdout.flush()  # here, where a closed pipe can still be told apart from a failure


def _refuse(sentence: str, *, as_json: bool) -> None:
    if as_json:
        from core.files.json_text import to_json

        sys.stdout.write(to_json({"error": sentence}))
    sys.stderr.write(f"trisect: {sentence}\n")
