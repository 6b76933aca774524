"""`trisect simulate` and `trisect demo`: recordings without a rig. Light to import."""

from __future__ import annotations

import shlex
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from core.cli.bar import bar
from core.cli.language import tr
from core.cli.options import EPILOG, Json, Panel
from core.pipeline.taken_over import TAKEN_OVER
from core.progress import Progress
from core.second_process import second_process
from core.simulate.scenario import CAMERA_TARGETS, OBJECTS, PLANE_TARGETS, Scenario

commands = typer.Typer()

SCENARIO = Scenario()
"""The defaults of a simulated recording."""
HELP_VALUES = {
    "objects": ", ".join(OBJECTS),
    "camera_targets": ", ".join(CAMERA_TARGETS),
    "plane_targets": ", ".join(PLANE_TARGETS),
}
"""What stands in the places of this room's help."""
_PART = "gauge block of the embedded sample"
_QUICK_SCALE, _QUICK_FRAMES, _QUICK_CUT_MM = 0.25, 24, 0.3
"""The quick demonstration: share of the paper's resolution, number of frames, and cut on σ in mm, which so coarse
pictures need."""


@commands.command(rich_help_panel=Panel.TRY)
def simulate(
    thing: Annotated[str, typer.Argument(metavar="OBJECT", help="What stands on the table: {objects}.")],
    out: Annotated[Path, typer.Option("--out", "-o", metavar="SET", help="Folder of the new recording set.")],
    height: Annotated[
        float,
        typer.Option("--height", metavar="MM", help="Height of a block or mask, diameter of a sphere or cylinder."),
    ] = SCENARIO.height_mm,
    stl: Annotated[str, typer.Option("--stl", metavar="FILE", help="The file of an stl.")] = SCENARIO.stl_path,
    frames: Annotated[int, typer.Option(metavar="N", help="Frames of the scan.")] = SCENARIO.frames,
    views: Annotated[int, typer.Option(metavar="N", help="Views of the camera target.")] = SCENARIO.camera_views,
    poses: Annotated[int, typer.Option(metavar="N", help="Poses of the plane target.")] = SCENARIO.plane_poses,
    seed: Annotated[int, typer.Option(metavar="N", help="The same seed gives the same pictures.")] = SCENARIO.seed,
    scale: Annotated[float, typer.Option(metavar="SHARE", help="Picture size over 3840 × 2748.")] = SCENARIO.scale,
    noise: Annotated[
        float, typer.Option(metavar="FACTOR", help="Factor on shot and read noise; 0 for none.")
    ] = SCENARIO.noise,
    speckle: Annotated[
        float, typer.Option(metavar="CONTRAST", help="Contrast of the lasers' speckle; 0 for none.")
    ] = SCENARIO.speckle,
    bits: Annotated[int, typer.Option(metavar="N", help="Depth of the pictures, 8 or 16.")] = SCENARIO.bits,
    ambient: Annotated[
        float, typer.Option(metavar="GREY", help="Grey level of a white surface in the room's light.")
    ] = (SCENARIO.ambient_grey),
    texture: Annotated[
        float, typer.Option(metavar="SHARE", help="Relative unevenness of the surfaces.")
    ] = SCENARIO.texture,
    camera_target: Annotated[
        str, typer.Option(metavar="NAME", help="One of {camera_targets}.")
    ] = SCENARIO.camera_target,
    plane_target: Annotated[str, typer.Option(metavar="NAME", help="One of {plane_targets}.")] = SCENARIO.plane_target,
    check_poses: Annotated[int, typer.Option(metavar="N", help="Pictures of an interim check.")] = SCENARIO.check_poses,
    turned: Annotated[
        float, typer.Option(metavar="URAD", help="The laser turned by so much since its calibration.")
    ] = SCENARIO.turned_urad,
    drifted: Annotated[
        float, typer.Option(metavar="PX", help="The picture moved by so much since the camera's calibration.")
    ] = SCENARIO.drifted_px,
    readout: Annotated[
        float, typer.Option(metavar="MS", help="Rows are read out over so long: a rolling shutter.")
    ] = SCENARIO.readout_ms,
    exposure: Annotated[float, typer.Option(metavar="MS", help="Each row is exposed for so long.")] = (
        SCENARIO.exposure_ms
    ),
    hand_speed: Annotated[float, typer.Option(metavar="MM/S", help="Speed of the hand in a picture.")] = (
        SCENARIO.hand_mm_s
    ),
    tremor: Annotated[float, typer.Option(metavar="MM", help="Amplitude of the hand's tremor.")] = SCENARIO.tremor_mm,
    moved_frame: Annotated[
        int, typer.Option(metavar="N", help="From this frame on something has moved:")
    ] = SCENARIO.moved_frame,
    lifted: Annotated[float, typer.Option(metavar="MM", help="… the object up.")] = SCENARIO.lifted_mm,
    pushed: Annotated[float, typer.Option(metavar="MM", help="… the object aside.")] = SCENARIO.pushed_mm,
    table_sunk: Annotated[float, typer.Option(metavar="MM", help="… the table with the object.")] = SCENARIO.table_mm,
    bumped: Annotated[float, typer.Option(metavar="PX", help="… the camera's picture.")] = SCENARIO.bumped_px,
    published_planes: Annotated[
        bool, typer.Option("--published-planes", help="The paper's printed planes instead of an exact 5° pencil.")
    ] = False,
    no_reference: Annotated[bool, typer.Option("--no-reference", help="Leave scan/reference.png out.")] = False,
    fan_lines: Annotated[int, typer.Option(metavar="N", help="Lines of the fan: 3, 1, or 0.")] = SCENARIO.fan_lines,
    no_hand_laser: Annotated[
        bool, typer.Option("--no-hand-laser", help="Frames of the fan alone, for `trisect profile`.")
    ] = False,
    travel: Annotated[
        float, typer.Option(metavar="MM", help="Without the hand-held laser: the object is moved so far each frame.")
    ] = SCENARIO.travel_mm,
    effects: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help=r"A TOML file with tables \[laser], \[lens], \[sensor], \[room], \[plates], \[warming], \[boards]: "
            "what else real rigs do.",
        ),
    ] = None,
    mirror: Annotated[
        float, typer.Option(metavar="SHARE", help="Share of the light that flat sides of the object mirror.")
    ] = SCENARIO.mirror_share,
    unstated: Annotated[
        bool, typer.Option("--unstated", help="rig.toml says nothing of how stable the rig and how true plates are.")
    ] = False,
    json: Json = False,
) -> None:
    """Render a recording set as the paper's rig would record it; its truth is written beside it, never inside."""
    from core.cli import output
    from core.simulate.recording import simulate_set

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
        fan_lines=fan_lines,
        hand_laser=not no_hand_laser,
        travel_mm=travel,
        check_poses=check_poses,
        turned_urad=turned,
        drifted_px=drifted,
        readout_ms=readout,
        exposure_ms=exposure,
        hand_mm_s=hand_speed,
        tremor_mm=tremor,
        moved_frame=moved_frame,
        lifted_mm=lifted,
        pushed_mm=pushed,
        table_mm=table_sunk,
        bumped_px=bumped,
        mirror_share=mirror,
        stated=not unstated,
    )
    if effects is not None:
        scenario = scenario.with_effects_of(Scenario.read(effects))
    with bar() as progress:
        simulate_set(scenario, out, progress)
    if json:
        output.print_json({"set": str(out)})
    else:
        told = tr(
            "recording set in {path}; measure it with: trisect run {typed} --out DIR",
            path=str(out),
            typed=as_typed(out),
        )
        sys.stdout.write(f"{told}\n")


def as_typed(path: Path) -> str:
    """Quote a path for the command line of this operating system, if it needs quotes."""
    return subprocess.list2cmdline([str(path)]) if sys.platform == "win32" else shlex.quote(str(path))


@commands.command(epilog=EPILOG, rich_help_panel=Panel.TRY)
def demo(
    out: Annotated[Path, typer.Option("--out", "-o", metavar="DIR", help="Folder of the results.")] = Path("out"),
    quick: Annotated[bool, typer.Option("--quick", help="A smaller sample: sooner done, less exact.")] = False,
    json: Json = False,
) -> None:
    """Measure the embedded sample, a 50 mm gauge block; it is rendered on first use and kept in your cache."""
    from core.cli import arguments
    from core.files.atomic import make_folder

    make_folder(out)
    with second_process(TAKEN_OVER) as beside:  # it starts while this one imports
        from core.cli import measuring, output
        from core.report.wording import thickness_line

        options = arguments.options({"sigma_cut": _QUICK_CUT_MM} if quick else {}, _PART)
        with bar("run") as progress, _sample(progress, quick=quick) as folder:
            result = measuring.run_all(folder, out, options, progress, beside, over_simulated=True)
    measuring.show_run(result, as_json=json)
    if result.gauge is not None and not json:
        line = thickness_line(result.gauge, output.words())
        report = str(result.files["report"])
        told = tr("The sample block measures {thickness}; the report is {path}.", thickness=line, path=report)
        sys.stdout.write(f"\n{told}\n")
    raise typer.Exit(measuring.exit_code(result.results.verdict))


@contextmanager
def _sample(progress: Progress, *, quick: bool) -> Iterator[Path]:
    """The embedded sample's folder, rendered on first use; the quick one is smaller and forgotten afterwards."""
    from core.simulate.recording import simulate_set
    from core.simulate.sample import sample_scenario, sample_set

    if not quick:
        yield sample_set(progress)
        return
    scenario = replace(sample_scenario(), scale=_QUICK_SCALE, frames=_QUICK_FRAMES)
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        path = Path(folder) / "sample"
        simulate_set(scenario, path, progress)
        yield path
