"""Gauge step: cloud.ply, scan.npz and the calibrations → gauge.json."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from typing import NamedTuple, TypeVar

import numpy as np

from core.errors import InputError, NoThickness
from core.files.recording.rig import GaugeSpec, Rig, part_table
from core.files.results.gauge_file import read_gauge, write_gauge
from core.files.results.ply import read_cloud
from core.files.results.scan_file import ScanFile, read_scan
from core.findings.table import note_of
from core.inspect.causes import CHANGES
from core.inspect.faces import FacePair, OneFace, find_faces
from core.inspect.gauge import Polygons, adjusted, measure_gauge
from core.inspect.plan.temperature import correction_to_reference, temperature_of
from core.inspect.results import GaugeResult
from core.inspect.uncertainty.part import Part
from core.inspect.uncertainty.point_errors import PointErrors
from core.messages import Command, Message, as_json
from core.model.arrays import Array
from core.pipeline.steps.check_step import checked_on_the_day
from core.pipeline.steps.workspace import Workspace, check_calibration
from core.progress import Progress, silent
from core.scan.fan_watch import WARM_UP
from core.scan.features.overexposure import ADVICE, overexposed
from core.scan.features.picture_faults import at_fault
from core.scan.first_cause import Reason, Suspect, cause_first
from core.scan.known_planes.points_on_planes import lying_on
from core.scan.single_change import AS_CALIBRATED
from core.scan.standstill import HOLD_STILL
from core.scan.surface.cloud import FAN, Cloud

Why = TypeVar("Why")

PART = "part"
"""Under this name the settings of a thickness in run.json say what is stated of the part."""

UNSURE = 0.5
"""Share of the sweeps' points that the σ cut leaves out, from which on it is told where faces are not found."""
ENOUGH_OF_FAN = 0.25
"""Share of the fan's own points within the σ cut that shows whether a face is the only one in view. Of a set in order
at a quarter of the usual size 0.55 are, of one with a mosaic and JPEG, where the part's face is lost, 0.04."""
MOST = 0.5
"""Share of what crossings are off too much, from which on a cause explains most of it."""
FEW_FRAMES, USUAL_FRAMES = 20, 30
"""Frames that locate the surface: so few are named where faces are not found, and so many are asked for then."""
MATTERS = 1.1
"""A rig is told to be unchecked if U is so many times what it would be without a change since the calibration."""


def gauge_step(work: Workspace, progress: Progress = silent) -> GaugeResult:
    """Measure the thickness of the part in the scan's cloud and write gauge.json.

    Raises
    ------
    InputError
        If a result is missing, damaged or of another calibration.
    NoThickness
        If there are no two parallel faces.
    """
    with work.step("gauge") as log:
        calibration = work.calibration()
        file = read_cloud(work.path("cloud"))
        check_calibration(work.path("cloud"), file.calibration_id, calibration)
        scan = read_scan(work.path("scan"))
        check_calibration(work.path("scan"), scan.calibration_id, calibration)
        cloud, spec, part = file.cloud, work.recording_set.rig.gauge or GaugeSpec(), work.recording_set.rig.part
        regions: Polygons | FacePair | None = _regions(spec)
        why = partial(reasons_of_no_faces, scan, cloud, calibration.fan.bends)
        with _no_thickness(), cause_first(why, lambda: scan.causes), single_face_as_cause(scan, cloud):
            if regions is None and scan.planes:
                beside = lying_on(cloud.points, cloud.uv, scan.planes)
                regions = find_faces(cloud, nominal_mm=spec.nominal_mm, beside=beside, progress=progress)
            gauge = measure_gauge(
                cloud,
                errors=replace(point_errors(scan), part=part),
                regions=regions,
                nominal_mm=spec.nominal_mm,
                tolerance_mm=spec.tolerance_mm,
                progress=progress,
            )
        gauge = of_part(gauge, part)
        by_planes = scan.plane_check is not None and scan.plane_check.passed
        if not by_planes and not checked_on_the_day(work.recording_set, calibration.fan):
            gauge = replace(gauge, notes=(*gauge.notes, *notes_on_unchecked(gauge)))
        rule = None if gauge.rule is None else as_json(gauge.rule)
        log.settings.update({"nominal_mm": spec.nominal_mm, "tolerance_mm": spec.tolerance_mm, "rule": rule})
        log.settings[PART] = part_table(part)
        log.notes.extend(gauge.notes)
        progress("faces", 1, 1)  # the last moment at which it can be cancelled: nothing is written yet
        write_gauge(log.path("gauge"), gauge, calibration.id)
    return read_gauge(work.path("gauge"), cloud)


def of_part(gauge: GaugeResult, part: Part) -> GaugeResult:
    """Correct a measured thickness to 20 °C, by the part's stated or assumed temperature, and note what is assumed."""
    temperature = temperature_of(part)
    if temperature is not None:
        gauge = adjusted(gauge, *correction_to_reference(gauge.thickness_mm, temperature))
    at_20 = temperature is not None and not temperature.celsius_assumed
    return replace(gauge, notes=(*gauge.notes, *part.assumed), at_20=at_20)


def notes_on_unchecked(gauge: GaugeResult) -> tuple[Message, ...]:
    """Make a note if U is much larger because the rig was not checked on the day of the scan; () if not."""
    change = max((row.u_mm for row in gauge.budget if row.source in CHANGES), default=0.0)
    if MATTERS**2 * (gauge.u_mm**2 - change**2) >= gauge.u_mm**2:
        return ()
    return (note_of("inspection.rig_not_checked", part_mm=gauge.k * change, U_mm=gauge.U_mm),)


@contextmanager
def _no_thickness() -> Iterator[None]:
    """A complaint about faces is not one about what was given."""
    try:
        yield
    except InputError as error:
        raise NoThickness(error.what, where=error.where, todo=error.todo) from error


@contextmanager
def single_face_as_cause(scan: ScanFile, cloud: Cloud) -> Iterator[None]:
    """Let an OneFace error in this block stand if the cloud holds enough fan light, else make it an InputError.

    Only as OneFace it names one face in view as the cause.
    """
    try:
        yield
    except OneFace as error:
        seen = sum(len(piece) for piece in scan.features.fan)
        if np.count_nonzero(cloud.sweep <= FAN) >= ENOUGH_OF_FAN * seen:
            raise
        raise InputError(error.what, where=error.where, todo=error.todo) from error


def reasons_of_no_faces(scan: ScanFile, cloud: Cloud, bends: Array | None) -> Iterator[Reason]:
    """Yield the reasons that may explain why no two parallel faces are found in the `cloud`, one a cause.

    `bends` (N, 3, 3) in 1/mm are those of the fan's lines, None where they are not known.
    """
    yield from _bent(cloud, bends)
    if scan.facts.moved:
        yield Reason(
            Suspect.MOVED,
            lambda reason: Message(
                "gauge.moved_and_no_faces",
                "something moved during the scan; of what is left: {reason}",
                reason=reason,
            ),
            HOLD_STILL,
            of_own=True,
        )
    if scan.facts.drifted:
        yield Reason(
            Suspect.DRIFTED,
            lambda reason: Message(
                "gauge.drifted_and_no_faces",
                "the rig drifted during the scan; of what it measured so: {reason}",
                reason=reason,
            ),
            WARM_UP,
            of_own=True,
        )
    yield from _rig_changed(scan)
    yield from at_fault(scan.features.faults)
    yield from _too_bright(scan)
    yield from _unsure(scan)


def _bent(cloud: Cloud, bends: Array | None) -> Iterator[Reason]:
    """That the fan's lines are no planes of light: crossings disagree by that, too.

    It counts if the light is off its planes by half the largest σ that a point of the cloud has, at most of those that
    the fan measured itself.
    """
    own = cloud.sweep <= FAN
    if bends is None or not own.any():
        return
    points, line = cloud.points[own], FAN - cloud.sweep[own]
    off_mm = float(np.median(np.abs(np.einsum("ni,nij,nj->n", points, bends[line], points))))
    if off_mm < cloud.sigma.max() / 2:
        return
    yield Reason(
        Suspect.BENT_LINES,
        lambda reason: Message(
            "gauge.bent_and_no_faces",
            "by their calibration the fan's lines are no planes of light, but {off_mm:.2g} mm off them; of what is "
            "measured so: {reason}",
            off_mm=off_mm,
            reason=reason,
        ),
        Message(
            "gauge.advice_straight_lines",
            "see what the calibration of the laser planes says of the lines, mend that, and calibrate them again",
        ),
        of_own=True,
    )


def _rig_changed(scan: ScanFile) -> Iterator[Reason]:
    """That camera or laser changed since they were calibrated: plane faces slant by that, and points are unsure.

    It counts if pictures of the day are sure of it, or it explains most of what crossings are off too much.
    """
    share = next((one.share or 0.0 for one in scan.causes if one.suspect == Suspect.RIG_CHANGED), 0.0)
    if not scan.facts.rig_changed and share < MOST:
        return
    yield Reason(
        Suspect.RIG_CHANGED,
        lambda reason: Message(
            "gauge.changed_and_no_faces",
            "camera or laser changed since they were calibrated; of what is measured so: {reason}",
            reason=reason,
        ),
        AS_CALIBRATED,
        of_own=True,
    )


def _too_bright(scan: ScanFile) -> Iterator[Reason]:
    """That stripes are overexposed."""
    sweeps = [piece for frame in scan.features.frames for piece in frame.centrelines]
    too_bright = overexposed(scan.features.fan, sweeps)
    if too_bright is not None:
        yield Reason(
            Suspect.OVEREXPOSED,
            lambda reason: Message(
                "gauge.overexposed_and_no_faces",
                "{bright}; of the rest: {reason}",
                bright=too_bright,
                reason=reason,
            ),
            ADVICE,
        )


def _unsure(scan: ScanFile) -> Iterator[Reason]:
    """That the σ cut left most points out: for few frames, with as many as are usual, the same sweeps have faces."""
    if scan.unsure_share < UNSURE:
        return
    if len(scan.sweep_frames) < FEW_FRAMES:
        yield Reason(
            Suspect.FEW_FRAMES,
            lambda reason: Message(
                "gauge.few_frames_and_no_faces",
                "only {n} frames locate the surface, and {percent:.0f} % of their points are less sure than the σ cut; "
                "of the rest: {reason}",
                n=len(scan.sweep_frames),
                percent=100 * scan.unsure_share,
                reason=reason,
            ),
            Message("gauge.advice_more_frames", "record {n} frames or more", n=USUAL_FRAMES),
        )
    yield Reason(
        Suspect.UNSURE_POINTS,
        lambda reason: Message(
            "gauge.unsure_and_no_faces",
            "{percent:.0f} % of the sweeps' points are less sure than the σ cut, and left out; of the rest: {reason}",
            percent=100 * scan.unsure_share,
            reason=reason,
        ),
        Message(
            "gauge.advice_surer_points",
            "cross more of the fan with each sweep, take sharper or larger pictures, or raise the scan's σ "
            "cut{command}",
            command=Command("--sigma-cut MM"),
        ),
    )


def point_errors(scan: ScanFile) -> PointErrors:
    """Make the model of how the errors of a scan's points hang together, from what scan.npz holds."""
    errors = PointErrors.of_scan(scan.features, scan.covariance, scan.common, scan.speckle, scan.pis.shape[1])
    return replace(errors, facts=scan.facts, light=scan.part_light)


class Thickness(NamedTuple):
    """Result of measuring a thickness: the gauge, or the error that tells why there is none."""

    gauge: GaugeResult | None
    problem: InputError | None = None

    @property
    def note(self) -> Message | None:
        """Note on why there is no thickness; None if one was measured."""
        return None if self.problem is None else note_of("gauge.none_measured", reason=self.problem.message)


def gauge_if_possible(work: Workspace, progress: Progress = silent) -> Thickness:
    """Measure the thickness and write gauge.json or, instead of raising, write into run.json why there is none."""
    try:
        return Thickness(gauge_step(work, progress))
    except InputError as error:
        found = Thickness(None, error)
        with work.step("gauge") as log:
            log.settings[PART] = part_table(work.recording_set.rig.part)
            log.notes.extend(filter(None, [found.note]))
        return found


def missing_thickness(rig: Rig, why_not: Why | None) -> Why | None:
    """Return `why_not`, the reason for no thickness, if the rig asks for one; None if it does not, or there is one."""
    return None if rig.gauge is None else why_not


def _regions(spec: GaugeSpec) -> tuple[Array, Array] | None:
    if spec.upper_polygon_px is None or spec.lower_polygon_px is None:
        return None
    return spec.upper_polygon_px, spec.lower_polygon_px
