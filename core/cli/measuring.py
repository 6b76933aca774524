"""What the measuring commands do: call the pipeline, then say what came of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, cast

from core.calibrate.camera_options import CameraOptions
from core.cli import output
from core.errors import InputError
from core.files.exclusion import excluded_names
from core.files.recording_set import open_set
from core.image.stripe import StripeSettings
from core.inspect.results import GaugeResult
from core.pipeline import (
    Options,
    RunResult,
    Workspace,
    camera_step,
    gauge_step,
    planes_step,
    run,
    scan_step,
)
from core.progress import Progress
from core.scan.method import Method
from core.stage_times import StageTimes

PROVEN = ("", "conforming")
"""Verdicts that leave with exit code 0."""


@dataclass(frozen=True, eq=False, slots=True)
class Shown:
    """What a command says when it is done."""

    rows: output.Rows
    values: Mapping[str, Any]
    notes: tuple[str, ...] = ()
    files: Mapping[str, Path] = field(default_factory=dict)

    def show(self, *, as_json: bool) -> None:
        """Print it, for people or for machines."""
        if as_json:
            output.print_json({**self.values, "notes": self.notes, "files": output.files_json(self.files)})
        else:
            output.print_rows(self.rows, self.notes, self.files)


def options(
    method: str,
    sigma_cut: float,
    *,
    skew: bool = True,
    k3: bool = False,
    part: str = "",
    stripe_width: float = 0.0,
    contrast: float = 0.0,
    adjust_camera: bool = False,
) -> Options:
    """The pipeline's options from the command line's; InputError if one is absurd."""
    if (stripe_width > 0) != (contrast > 0) or min(stripe_width, contrast) < 0:
        raise InputError(
            "width and contrast of the stripes belong together, both above 0",
            where="--stripe-width, --contrast",
            todo="give both, or neither to have them chosen from the pictures",
        )
    stripe = StripeSettings(stripe_width, contrast) if stripe_width > 0 else None
    camera = CameraOptions(skew=skew, k3=k3)
    return Options(cast(Method, method), sigma_cut, camera, part, stripe, adjust_camera=adjust_camera)


def leaving_out(chosen: Options, folder: Path, names: Sequence[str] | None) -> Options:
    """The options with the pictures `names` of the set left out; InputError if the set has no such picture."""
    return replace(chosen, excluded=excluded_names(open_set(folder), names)) if names else chosen


def timed(progress: Progress, wanted: bool) -> Progress:
    """The progress, which learns what the stages cost if that is `wanted`."""
    return StageTimes(progress) if wanted else progress


def show_times(progress: Progress) -> None:
    """Say on standard error what the stages have cost, if that was wanted."""
    if isinstance(progress, StageTimes):
        output.print_times(progress.seconds(), progress.wall_s)


def exit_code(gauge: GaugeResult | None) -> int:
    """0, or 1 where a verdict was asked for and is not "conforming"."""
    return 0 if gauge is None or gauge.verdict in PROVEN else 1


def run_all(folder: Path, out: Path, chosen: Options, progress: Progress) -> RunResult:
    """The whole way."""
    return run(folder, out, chosen, progress)


def show_run(result: RunResult, *, as_json: bool) -> None:
    """Say what a whole run measured."""
    rows: output.Rows = output.gauge_rows(result.gauge) if result.gauge else [("thickness", "not measured")]
    rows += [("camera", output.camera_summary(result.camera)), ("fan", output.fan_summary(result.fan))]
    rows += output.frame_rows(result.frames, result.points)
    values = {
        **output.gauge_json(result.gauge),
        **output.frames_json(result.frames, result.points),
        "triangles": result.triangles,
        "camera": output.camera_json(result.camera),
        "fan": output.fan_json(result.fan),
    }
    Shown(rows, values, result.notes, result.files).show(as_json=as_json)


def run_camera(folder: Path, out: Path, chosen: Options, progress: Progress) -> Shown:
    """Camera step."""
    work = _open(folder, out)
    calibration = camera_step(work, chosen, progress)
    rows, values = output.camera_rows(calibration), output.camera_json(calibration)
    return _shown(work, "camera", rows, values, "camera")


def run_planes(folder: Path, out: Path, chosen: Options, progress: Progress) -> Shown:
    """Planes step."""
    work = _open(folder, out)
    calibration = planes_step(work, chosen, progress)
    return _shown(work, "planes", output.fan_rows(calibration), output.fan_json(calibration), "planes")


def run_scan(folder: Path, out: Path, chosen: Options, progress: Progress) -> Shown:
    """Scan step."""
    work = _open(folder, out)
    measured = scan_step(work, chosen, progress)
    frames, points = measured.scan.frames, len(measured.scan.cloud)
    rows, values = output.frame_rows(frames, points), output.frames_json(frames, points)
    return _shown(work, "scan", rows, values, "cloud", "mesh")


def run_gauge(folder: Path, out: Path, progress: Progress) -> tuple[GaugeResult, Shown]:
    """Gauge step."""
    work = _open(folder, out)
    gauge = gauge_step(work, progress)
    return gauge, _shown(work, "gauge", output.gauge_rows(gauge), output.gauge_json(gauge), "gauge")


def _open(folder: Path, out: Path) -> Workspace:
    return Workspace.open(open_set(folder), out)


def _shown(work: Workspace, step: str, rows: output.Rows, values: Mapping[str, Any], *names: str) -> Shown:
    files = work.written()
    notes = tuple(work.record().notes.get(step, ()))
    return Shown(rows, values, notes, {name: files[name] for name in names})
