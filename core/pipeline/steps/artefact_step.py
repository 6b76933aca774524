"""Artefact step: the thickness in gauge.json against the certificate of the artefact that was measured."""

from __future__ import annotations

import hashlib

from core.files.recording.recording_set import RecordingSet, require_scan
from core.files.recording.set_listing import taken_at
from core.files.results.gauge_file import read_thickness
from core.files.results.rig_history import PastCheck, keep_check
from core.files.results.scan_file import read_scan
from core.pipeline.steps.validity import history_name
from core.pipeline.steps.workspace import Workspace, check_calibration
from core.study.artefact_check import Artefact, ArtefactCheck


def artefact_step(work: Workspace, artefact: Artefact, celsius: float | None = None) -> ArtefactCheck:
    """Compare the thickness among the results with the certificate, and keep that in the rig's history.

    The thickness is at 20 °C where the part's temperature is stated; `celsius` is that of the air, for the history.

    Raises
    ------
    InputError
        If the set has no scan, no thickness was measured in it, it is of another calibration, or the history cannot be
        written.
    """
    found = work.found
    require_scan(found)
    calibration = work.calibration()
    check_calibration(work.path("scan"), read_scan(work.path("scan")).calibration_id, calibration)
    thickness, when = read_thickness(work.path("gauge")), taken_at(found.frames)
    check = ArtefactCheck(artefact, thickness.value, thickness.u, when.astimezone().date())
    past = PastCheck.of_measured(check, when, (calibration.id, _frames_id(found, work)), celsius)
    keep_check(history_name(found.rig, calibration.id), past)
    return check


def _frames_id(found: RecordingSet, work: Workspace) -> str:
    """Twelve hex digits that name the frames by what was in them when they were measured."""
    inputs = work.record().inputs
    text = "\n".join(inputs.get(found.name_of(path), "") for path in found.frames)
    return hashlib.sha256(text.encode()).hexdigest()[:12]
