"""What the measuring commands do: call the pipeline, then say what came of it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, fields
from functools import partial
from pathlib import Path
from typing import Any

from rich.table import Table

from core.acquire.channel import Channel
from core.checks.artefact_check import ArtefactCheck
from core.cli import output, talk
from core.cli.bar import lines_of, prints_lines
from core.cli.language import current_language, speak_as, text_of, tr
from core.cli.options import ExitCode
from core.code_cache import note_on_cache
from core.compiled import FOLDER, is_complete
from core.errors import InputError
from core.files.folder_lock import alone_in
from core.files.recording.recording_set import RIG, open_set, require_folder
from core.files.recording.rig import read_rig
from core.files.results.artefact_register import artefact_named
from core.files.results.check_file import InterimCheck
from core.files.results.folder_results import read_results
from core.files.results.joint_file import joint_table
from core.files.results.rig_history import RigHistory, history_file
from core.files.step_graph import READJUST
from core.inspect.conformity import Verdict
from core.messages import Message, label, visible
from core.pipeline.batch import measure_set, run_batch
from core.pipeline.compile_ahead import compile_ahead
from core.pipeline.executors import DASK, executor_of
from core.pipeline.run import RunResult, run
from core.pipeline.set_result import SET_COLUMNS, SetResult, set_cells
from core.pipeline.steps.artefact_step import artefact_step
from core.pipeline.steps.camera_step import camera_step
from core.pipeline.steps.check_step import check_step
from core.pipeline.steps.gauge_step import gauge_step
from core.pipeline.steps.join_step import join_step
from core.pipeline.steps.planes_step import planes_step
from core.pipeline.steps.profile_step import profile_step
from core.pipeline.steps.readjust_step import readjust_step, undo_readjustment
from core.pipeline.steps.scan_step import scan_step
from core.pipeline.steps.validity import history_of
from core.pipeline.steps.workspace import Workspace, read_calibration
from core.progress import Progress, silent
from core.report.facts.fact import Reader, named
from core.report.facts.of_camera import camera_facts, parameter_facts
from core.report.facts.of_checks import readjustment_facts
from core.report.facts.of_gauge import pictures_fact, pictures_table
from core.report.facts.of_planes import planes_facts, planes_sentences
from core.report.facts.of_scan import plane_check_facts, plane_tables, scan_facts, sigma_of
from core.second_process import SecondProcess
from core.settings.options import Options, StatedTilt
from core.stage_times import StageTimes
from core.states import SET_STATES


@dataclass(frozen=True, eq=False, slots=True)
class Shown:
    """Output of a command that is done: rows, notes, files and JSON."""

    rows: output.Rows
    values: Mapping[str, Any]
    notes: tuple[Message, ...] = ()
    files: Mapping[str, Path] = field(default_factory=dict)

    def show(self, *, as_json: bool) -> None:
        """Print rows, notes and files of a finished command, or, with `as_json`, one JSON object."""
        if as_json:
            output.print_json(
                {**self.values, "notes": output.notes_json(self.notes), "files": output.files_json(self.files)}
            )
        else:
            output.print_rows(self.rows, self.notes, self.files)


def timed(progress: Progress, wanted: bool) -> Progress:
    """Wrap `progress` so that the time of each stage is recorded, if `wanted`; else return it unchanged."""
    return StageTimes(progress) if wanted else progress


def show_times(progress: Progress) -> None:
    """Print the time of each stage on standard error, if `progress` has recorded it."""
    if isinstance(progress, StageTimes):
        output.print_times(progress.seconds(), progress.wall_s)


def exit_code(verdict: str, good: Sequence[str] = ("conforming",)) -> ExitCode:
    """Return the exit code of a verdict: done if it is among `good` or "" (no verdict), else not proven."""
    return ExitCode.DONE if not verdict or verdict in good else ExitCode.NOT_PROVEN


def print_cache_note() -> None:
    """Print that compiled code will be lost when the program ends, if so; with `--verbose` also where it is."""
    if talk.is_verbose():
        talk.print_line(tr("compiled code: {folder}", folder=FOLDER))
    if (note := note_on_cache()) is not None and not is_complete():
        talk.print_line(tr("note: {note}", note=note))


def run_all(
    folder: Path,
    out: Path,
    chosen: Options,
    progress: Progress,
    beside: SecondProcess | None,
    *,
    over_simulated: bool = False,
) -> RunResult:
    """Run all steps on a recording set and return their results; compile loops first if that was never done.

    `over_simulated`: results of another simulated set in the folder are replaced.
    """
    print_cache_note()
    compile_ahead(progress)
    return run(folder, out, chosen, progress, beside, over_simulated=over_simulated)


def show_run(result: RunResult, *, as_json: bool) -> None:
    """Print the results of all steps of a recording set."""
    gauge, verdict = result.gauge, result.results.verdict
    rows: output.Rows = output.gauge_rows(gauge, verdict) if gauge else [(tr("thickness"), tr("not measured"))]
    calibrated = [(label("camera"), camera_facts(result.camera))]
    if result.fan.fan.lines:
        calibrated.append((label("planes"), planes_facts(result.fan)))
    for of, facts in calibrated:
        rows += output.fact_rows(named(of, facts), reader=Reader.TECHNICIAN)
    scan = scan_facts(result.frames, result.points, result.triangles)
    rows += [*output.fact_rows(scan, reader=Reader.TECHNICIAN), *output.left_out_rows(result.frames)]
    values = {
        **output.gauge_json(gauge, verdict),
        **output.frames_json(result.frames, result.points),
        "triangles": result.triangles,
        "camera": output.camera_json(result.camera),
        **({"planes": output.planes_json(result.fan)} if result.fan.fan.lines else {}),
    }
    Shown(rows, values, result.notes, result.files).show(as_json=as_json)


def run_camera(folder: Path, out: Path, chosen: Options, progress: Progress) -> Shown:
    """Run the camera step on a recording set, and return what is to be printed."""
    with alone_with(folder, out) as work:
        calibration = camera_step(work, chosen.for_camera, progress)
        facts = (*camera_facts(calibration), *parameter_facts(calibration))
        rows = [*output.fact_rows(facts), *output.left_out_rows(calibration.views)]
        values = output.camera_json(calibration)
        return _shown(work, "camera", rows, values, "camera")


def run_planes(folder: Path, out: Path, chosen: Options, progress: Progress) -> Shown:
    """Run the planes step on a recording set, and return what is to be printed."""
    with alone_with(folder, out, channel=chosen.channel) as work:
        calibration = planes_step(work, chosen.for_planes, progress)
        rows = output.fact_rows(planes_facts(calibration))
        rows += output.left_out_rows(calibration.poses)
        rows += [("", text_of(sentence)) for sentence in planes_sentences(calibration)]
        return _shown(work, "planes", rows, output.planes_json(calibration), "planes")


def run_check(
    folder: Path, out: Path, chosen: Options, progress: Progress, celsius: float | None = None
) -> tuple[InterimCheck, Shown]:
    """Run the check step on a recording set; return the check and what is to be printed. `celsius` is the air's."""
    with alone_with(folder, out, channel=chosen.channel) as work:
        check = check_step(work, chosen.plane_stripe, progress, celsius)
        return check, _shown(work, "check", output.check_rows(check), output.check_json(check), "check")


def run_adjusting(folder: Path, out: Path, chosen: Options, progress: Progress) -> Shown:
    """Re-adjust camera and fan by the pictures of the interim check, and return what is to be printed."""
    with alone_with(folder, out, channel=chosen.channel) as work:
        done = readjust_step(work, chosen.plane_stripe, progress)
        rows, values = output.fact_rows(readjustment_facts(done)), output.readjustment_json(done)
        return _shown(work, READJUST, rows, values, "planes", "calibrated")


def undo_adjusting(folder: Path, out: Path) -> Shown:
    """Restore camera and fan as they were calibrated, and return what is to be printed."""
    with alone_with(folder, out) as work:
        undo_readjustment(work)
        return _shown(work, READJUST, [], {}, "planes")


def run_artefact(
    folder: Path, out: Path, id_: str, celsius: float | None, characteristic: str
) -> tuple[ArtefactCheck, Shown]:
    """Compare a result in `out` with the certificate of the artefact `id_`; return the check and what to print."""
    check = artefact_step(Workspace.open(open_set(folder), out), artefact_named(id_, folder), celsius, characteristic)
    return check, Shown(output.artefact_rows(check), output.artefact_json(check))


def rig_history(folder: Path, out: Path) -> tuple[RigHistory, Shown]:
    """Read the past checks of the rig of a recording set; return them and what is to be printed."""
    rig = read_rig(folder / RIG)
    history = history_of(rig, read_calibration(out, has_fan=rig.has_fan).id)
    values = {
        "rig": history.name,
        "checks": [output.past_check_json(one, history.chart(one)) for one in history.checks],
    }
    file = history_file(history.name)
    return history, Shown(output.history_rows(history), values, files={"history": file} if file.exists() else {})


def run_scan(folder: Path, out: Path, chosen: Options, progress: Progress) -> Shown:
    """Run the scan step on a recording set, and return what is to be printed."""
    with alone_with(folder, out, channel=chosen.channel) as work:
        measured = scan_step(work, chosen.for_scan, progress)
        frames, points = measured.scan.frames, len(measured.scan.cloud)
        facts = (
            *scan_facts(frames, points, len(measured.mesh.triangles), sigma_of(measured.scan.cloud.sigma)),
            *plane_check_facts(measured.check),
        )
        tables = plane_tables(measured.scan.planes, measured.check)
        rows = [*output.fact_rows(facts, tables), *output.left_out_rows(frames)]
        values = output.frames_json(frames, points)
        return _shown(work, "scan", rows, values, "cloud", "mesh")


def run_gauge(folder: Path, out: Path, progress: Progress) -> tuple[Verdict, Shown]:
    """Run the gauge step on a recording set; return the verdict on the part and what is to be printed."""
    with alone_with(folder, out) as work:
        gauge, verdict = gauge_step(work, progress), read_results(work.out).verdict
        rows, values = output.gauge_rows(gauge, verdict), output.gauge_json(gauge, verdict)
        return verdict, _shown(work, "gauge", rows, values, "gauge")


def run_join(folder: Path, out: Path, chosen: Options, progress: Progress) -> tuple[Verdict, Shown]:
    """Run the join step on a recording set; return the verdict on the thickness and what is to be printed."""
    with alone_with(folder, out, chosen.part, chosen.channel) as work:
        result = join_step(work, chosen.for_scan, progress)
        gauge, joint = result.thickness, result.joined.joint
        rows = output.gauge_rows(gauge, gauge.verdict)
        rows += [
            (tr("view {name}", name=name), tr("{n} marks of the carrier", n=len(seen)))
            for name, seen in zip(joint.views, joint.seen, strict=True)
        ]
        values = {**output.gauge_json(gauge, gauge.verdict), "views": joint_table(joint)}
        return gauge.verdict, _shown(work, "join", rows, values, "joined", "joint")


def run_profile(
    folder: Path, out: Path, chosen: Options, stage: str, tilt_sd_deg: float, progress: Progress
) -> tuple[Verdict, Shown]:
    """Run the profile step on a recording set; return the verdict on the part and what is to be printed."""
    if not 0 <= tilt_sd_deg < 10:
        raise InputError(
            Message("profile.tilt_sd_range", "{given:g}° is not between 0 and 10", given=tilt_sd_deg),
            where="--tilt-sd",
        )
    tilt = StatedTilt(stage, math.radians(tilt_sd_deg) or None) if stage or tilt_sd_deg else None
    with alone_with(folder, out, chosen.part, chosen.channel) as work:
        measured = profile_step(work, chosen.for_scan, tilt, progress)
        gauge, pictures, verdict = measured.gauge, measured.pictures, read_results(work.out).verdict
        of_pictures = output.fact_rows((pictures_fact(pictures),), (pictures_table(pictures),))
        rows = [*output.gauge_rows(gauge, verdict), *of_pictures, *output.left_out_rows(pictures)]
        values = {**output.gauge_json(gauge, verdict), **output.pictures_json(pictures)}
        return verdict, _shown(work, "profile", rows, values, "profile", "profile_table", "profiles", "gauge")


@contextmanager
def alone_with(folder: Path, out: Path, part: str = "", channel: Channel | None = None) -> Iterator[Workspace]:
    """Make a context with the workspace of a recording set and its results, locked against other processes."""
    work = Workspace.open(open_set(folder).with_channel(channel), out, part)
    print_cache_note()
    with alone_in(work.out):
        yield work


def _shown(work: Workspace, step: str, rows: output.Rows, values: Mapping[str, Any], *names: str) -> Shown:
    files = work.written()
    notes = tuple(work.record().notes.get(step, ()))
    return Shown(rows, values, notes, {name: files[name] for name in names})


def run_sets(
    sets: Sequence[Path], out: Path, executor: str, workers: int | None, chosen: Options, progress: Progress
) -> tuple[SetResult, ...]:
    """Measure all recording sets in parallel; InputError before the first one if a folder is missing."""
    for folder in sets:
        require_folder(folder)
    print_cache_note()
    aloud = prints_lines() and not executor.startswith(DASK)  # a cluster's workers have nobody who listens
    measure = partial(measure_aloud, current_language().name, talk.loudness()) if aloud else measure_set
    with executor_of(executor, workers) as pool:
        return run_batch(sets, out, pool, chosen, progress, measure=measure)


def measure_aloud(
    name: str,
    loudness: talk.Loudness,
    folder: Path,
    out: Path,
    options: Options,
    stop: Path,
    progress: Progress = silent,
) -> SetResult:
    """Measure one recording set in a process of its own, and print each of its stages in the language `name`."""
    speak_as(name, loudness)
    with lines_of(folder.name) as tell:

        def both(step: str, done: int, total: int) -> None:
            tell(step, done, total)
            progress(step, done, total)

        return measure_set(folder, out, options, stop, both)


def batch_exit_code(results: Sequence[SetResult]) -> ExitCode:
    """Return the worst exit code among the measured sets.

    70 where the program was at fault, 2 where one could not be measured, 3 where one has no thickness, 1 where one is
    not proven to conform, else 0.
    """
    failed = [result for result in results if result.error]
    if any(result.fault for result in failed):
        return ExitCode.FAULT
    if failed:
        return ExitCode.NO_THICKNESS if all(result.no_thickness for result in failed) else ExitCode.BAD_INPUT
    return max((exit_code(result.verdict) for result in results), default=ExitCode.DONE)


def show_sets(results: Sequence[SetResult], *, as_json: bool) -> None:
    """Print the result of each measured set, one a line, or, with `as_json`, as one JSON object."""
    if as_json:
        output.print_json({"sets": [_set_values(result) for result in results]})
        return
    console = output.console()
    table = Table(box=None, padding=(0, 2, 0, 0))
    for name in SET_COLUMNS:
        table.add_column(text_of(name), justify="left" if name in ("set", "verdict") else "right")
    for result in results:
        table.add_row(*map(visible, _set_row(result)))
    console.print(table)
    for result in results:
        if result.error:
            console.print(visible(f"{result.folder.name}: {text_of(result.error)}"), soft_wrap=True)


def _set_values(result: SetResult) -> dict[str, Any]:
    return {
        **{one.name: getattr(result, one.name) for one in fields(result)},
        "folder": str(result.folder),
        "out": str(result.out),
        **output.reason_json(result.error, name="error"),
    }


def _set_row(result: SetResult) -> tuple[str, ...]:
    cells = set_cells(result, output.words())
    thickness, U = (f"{text} mm" if text else "" for text in (cells.thickness, cells.U))
    verdict = cells.verdict or tr(SET_STATES["failed"])
    return result.folder.name, thickness, U, verdict, cells.points, cells.frames, cells.time
