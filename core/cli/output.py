"""What the commands print: small calm tables for people, one JSON object for machines."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from core.calibrate.results import (
    CameraCalibration,
    FanCalibration,
    ProposedReadjustment,
)
from core.checks.artefact_check import KINDS, ArtefactCheck
from core.checks.control_chart import ControlChart
from core.cli.language import current_language, text_of, tr
from core.cli.talk import is_verbose
from core.files.json_text import to_json
from core.files.results.check_file import InterimCheck
from core.files.results.gauge_file import gauge_summary
from core.files.results.planes_file import planes_id
from core.files.results.profile_file import PictureStep
from core.files.results.rig_history import PastCheck, RigHistory
from core.findings.table import gravest_first, is_grave
from core.inspect.conformity import Verdict
from core.inspect.results import GaugeResult
from core.messages import Message, as_json, plain, visible
from core.report.facts.fact import Fact, Reader, for_reader, named
from core.report.facts.of_checks import artefact_facts, check_facts, history_fact, history_table
from core.report.facts.of_gauge import gauge_facts
from core.report.facts.of_verdict import verdict_fact
from core.report.facts.pictures import Picture, left_out
from core.report.facts.table import FactTable, tables_for_reader
from core.report.wording import Words
from core.scan.features.frames import NO_REASON
from core.scan.results import FrameRecord
from core.states import VERDICT

Rows = list[tuple[str, str]]
PIPE_WIDTH = 1000
"""Columns in a pipe: lines are not wrapped there."""


def notes_json(notes: Sequence[Message]) -> list[dict[str, Any]]:
    """Convert notes to dicts for `--json` and result files: code, English text and values of each."""
    return [as_json(note) for note in notes]


def print_json(values: Mapping[str, Any]) -> None:
    """Print one JSON object on standard output."""
    sys.stdout.write(to_json(values))


def console() -> Console:
    """Return rich's console for standard output, PIPE_WIDTH columns wide unless that is a terminal."""
    out = Console(highlight=False, markup=False, emoji=False)
    if not out.is_terminal:
        out.width = PIPE_WIDTH
    return out


def print_rows(rows: Rows, notes: Sequence[Message] = (), files: Mapping[str, Path] | None = None) -> None:
    """Print a table of labels and values, then the notes, then where the files were written."""
    out = console()
    table = Table(box=None, show_header=False, padding=(0, 2, 0, 0))
    table.add_column(style="dim", no_wrap=True)
    table.add_column(overflow="fold")
    for label, value in rows:
        table.add_row(label, visible(value))
    if files:
        folder, names = next(iter(files.values())).parent, ", ".join(path.name for path in files.values())
        table.add_row(tr("written"), tr("{name}: {value}", name=folder, value=names))
    if table.rows:
        out.print(table)
    for note in gravest_first(notes):
        style = "red" if is_grave(note) else None
        out.print(visible(tr("note: {note}", note=note)), style=style, soft_wrap=True)


def fact_rows(facts: Iterable[Fact], tables: Iterable[FactTable] = (), reader: Reader = Reader.AUDITOR) -> Rows:
    """Convert facts and tables of a result to rows of label and value for a reader, or, with `--verbose`, for all."""
    reader = Reader.METROLOGIST if is_verbose() else reader
    rows = [(fact.title(words()), fact.text(words())) for fact in for_reader(facts, reader)]
    return rows + [line for table in tables_for_reader(tables, reader) for line in table.lines(words())]


def print_times(seconds: Mapping[str, float], wall_s: float) -> None:
    """Print the processor time and share of each stage, and the whole duration, on standard error."""
    table = Table(tr("stage"), box=None, padding=(0, 2, 0, 0))
    for title in (tr("processor s"), tr("share")):
        table.add_column(title, justify="right")
    total = sum(seconds.values())
    for name, spent in seconds.items():
        table.add_row(text_of(name), current_language().number(spent, ".2f"), f"{spent / total:.0%}")
    busy = tr("{n:.1f} processors busy for {seconds:.1f} s", n=total / wall_s, seconds=wall_s)
    table.add_row(tr("all"), current_language().number(total, ".2f"), busy)
    Console(stderr=True, highlight=False).print(table)


def words() -> Words:
    """Make the words and number formats of the reports in the chosen language."""
    return Words(current_language())


def gauge_rows(gauge: GaugeResult, verdict: Verdict) -> Rows:
    """Make the rows, label and value, of a thickness and of the verdict on the part."""
    return fact_rows((*gauge_facts(gauge), verdict_fact(verdict)))


def check_rows(check: InterimCheck) -> Rows:
    """Make the rows, label and value, of an interim check: verdict, how far off stripes are, error of a step."""
    return [(tr(VERDICT), text_of(check.sentence)), *fact_rows(check_facts(check)), *left_out_rows(check.poses)]


def left_out_rows(pictures: Iterable[Picture]) -> Rows:
    """Make the rows on pictures that were left out, one for each reason."""
    return [("", text_of(one.line())) for one in left_out(pictures)]


def check_json(check: InterimCheck) -> dict[str, Any]:
    """Convert an interim check to a dict for `--json`, without its values stripe by stripe."""
    return {
        "passed": check.passed,
        "p": check.p,
        "offset_px": check.offset_px,
        "offset_mm": check.offset_mm,
        "step_mm": check.step_mm,
        "error_mm": check.error_mm,
        "unseen_mm": check.unseen_mm,
    }


def readjustment_json(done: ProposedReadjustment) -> dict[str, Any]:
    """Convert a re-adjustment of camera and fan to a short dict for `--json`."""
    record = done.record
    return {
        "of": record.of,
        "id": planes_id(done.fan.fan),
        "poses": record.poses,
        "change": record.change.tolist(),
        "sd": record.sd.tolist(),
        "p_before": record.p_before,
        "p_after": record.p_after,
        "offset_px": list(done.offset_px),
        "offset_mm": list(done.offset_mm),
        "step_mm": done.step_mm,
        "correction_mm": done.correction_mm,
        "u_mm": done.u_mm,
    }


def artefact_rows(check: ArtefactCheck) -> Rows:
    """Make the rows, label and value, of a measured artefact: its error and its certificate."""
    compared = check.characteristic or tr(KINDS[check.artefact.kind])
    return [
        (tr("compared"), compared),
        *fact_rows(named(check.artefact.id, artefact_facts(check))),
        ("", text_of(check.sentence)),
    ]


def artefact_json(check: ArtefactCheck) -> dict[str, Any]:
    """Convert the check by a known artefact to a dict for `--json`."""
    return {
        "artefact": check.artefact.id,
        "kind": check.artefact.kind,
        "characteristic": check.characteristic,
        "verdict": check.verdict,
        "measured_mm": check.measured_mm,
        "u_mm": check.u_mm,
        "certified_mm": check.artefact.value_mm,
        "error_mm": check.error_mm,
        "e_n": check.e_n,
        "unseen_mm": 2 * check.u_error_mm,
    }


def history_rows(history: RigHistory) -> Rows:
    """Make the rows on a rig's past checks: how many, then each with its date, result, error of a step, and limits."""
    charted = ((one, history.chart(one)) for one in history.checks)
    return fact_rows((history_fact(history.name, len(history.checks)),), (history_table(charted),))


def past_check_json(check: PastCheck, chart: ControlChart) -> dict[str, Any]:
    """Convert a past check of a rig and its control limits to a dict for `--json`."""
    limits = {"lower_mm": chart.lower, "upper_mm": chart.upper, "own": chart.own, "n": chart.n}
    return {**check.values, "limits": limits}


def pictures_json(pictures: Sequence[PictureStep]) -> dict[str, Any]:
    """Convert the step heights of single pictures, or why there is none, to a dict for `--json`."""
    return {
        "pictures": [
            {"name": one.name, "thickness_mm": one.thickness_mm, "own_mm": one.own_mm, **reason_json(one.reason)}
            for one in pictures
        ]
    }


def reason_json(reason: Message | None, name: str = "reason") -> dict[str, Any]:
    """Convert the reason of a failure to a dict for `--json`: English text under the key `name`, code and values.

    All are empty for None.
    """
    told = as_json(reason or plain(""))
    return {name: told["text"], "code": told["code"], "values": told["values"]}


def gauge_json(gauge: GaugeResult | None, verdict: Verdict) -> dict[str, Any]:
    """Convert a thickness and the verdict on the part to a dict for `--json`; None: nothing was measured."""
    if gauge is None:
        return {"thickness_mm": None, "verdict": verdict}
    return {
        **gauge_summary(gauge),
        "verdict": verdict,
        "points_on_faces": dict(zip(("upper", "lower"), gauge.points_used, strict=True)),
    }


def frames_json(frames: Sequence[FrameRecord], points: int) -> dict[str, Any]:
    """Convert the number of points, and frames used and left out, to a dict for `--json`."""
    return {
        "points": points,
        "frames_used": sum(frame.used for frame in frames),
        "frames_left_out": [
            {"name": frame.name, **reason_json(frame.reason or NO_REASON)} for frame in frames if not frame.used
        ],
    }


def camera_json(calibration: CameraCalibration) -> dict[str, Any]:
    """Convert a camera calibration to a short dict for `--json`."""
    return {
        "rms_px": calibration.rms_px,
        "mean_px": calibration.mean_px,
        "matrix": calibration.camera.matrix,
        "distortion": calibration.camera.distortion,
        "views_used": sum(view.used for view in calibration.views),
        "views_left_out": [
            {"name": view.name, **reason_json(view.reason)} for view in calibration.views if not view.used
        ],
    }


def planes_json(calibration: FanCalibration) -> dict[str, Any]:
    """Convert a calibration of the fan to a short dict for `--json`."""
    return {
        "pi": calibration.fan.pis,
        "rms_mm": calibration.rms_mm,
        "cross_validation_mm": calibration.cross_validation_mm,
        "angles_deg": [math.degrees(angle) for angle in calibration.angles],
        "constraint_suits": calibration.constraint_suits,
        "poses_used": sum(pose.used for pose in calibration.poses),
        "poses_left_out": [
            {"name": pose.name, **reason_json(pose.reason)} for pose in calibration.poses if not pose.used
        ],
    }


def files_json(files: Mapping[str, Path]) -> dict[str, str]:
    """Convert the paths of files to text for `--json`, by the same names."""
    return {name: str(path) for name, path in files.items()}
