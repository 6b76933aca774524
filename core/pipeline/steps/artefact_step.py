"""Artefact step: a length among the results against the certificate of the artefact that was measured."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from core.checks.artefact_check import KINDS, Artefact, ArtefactCheck, ArtefactKind
from core.errors import InputError
from core.files.recording.recording_set import RecordingSet, require_scan
from core.files.recording.set_listing import taken_at
from core.files.results.gauge_file import read_thickness
from core.files.results.inspection_file import AGAIN, InspectionFile, read_inspection
from core.files.results.rig_history import PastCheck, store_check
from core.files.results.run_file import RunRecord
from core.files.results.scan_file import read_scan
from core.findings.proof import Doubt
from core.inspect.characteristic import Characteristic
from core.messages import Message
from core.pipeline.steps.validity import history_name, history_of
from core.pipeline.steps.workspace import Workspace, check_calibration

_MEASURED_AS: Mapping[ArtefactKind, tuple[str, str]] = {
    "block": ("thickness", "thickness"),
    "sphere": ("sphere", "diameter"),
    "step": ("steps", "height"),
}
"""Of a plan's characteristics: the kind of the feature and of its result."""


def artefact_step(
    work: Workspace, artefact: Artefact, celsius: float | None = None, characteristic: str = ""
) -> ArtefactCheck:
    """Compare the measured length of an artefact with its certificate, and add this check to the rig's history.

    Of a block that is the thickness of the part, of a sphere or a step its diameter or height in inspection.json, and
    `characteristic` says which where there are several. It is at 20 °C where the part's temperature is stated;
    `celsius` is that of the air, for the history, which also says whether the artefact lies where it had it before.

    Raises
    ------
    InputError
        If the set has no scan, no such length was measured in it or it is not said which, it is of another calibration
        or was corrected by a master, or the history cannot be written.
    """
    recording_set = work.recording_set
    require_scan(recording_set)
    calibration = work.calibration()
    check_calibration(work.path("scan"), read_scan(work.path("scan")).calibration_id, calibration)
    if artefact.kind == "block" and not characteristic:
        length = read_thickness(work.path("gauge"))
    else:
        path = work.path("inspection")
        file = read_inspection(path)
        check_calibration(path, file.calibration_id, calibration)
        length = _chosen(lengths_of(file, artefact.kind), artefact, characteristic, path)
        characteristic = length.name
    when = taken_at(recording_set.frames)
    day, doubts = when.astimezone().date(), tuple(Doubt.named(doubt.fact) for doubt in length.doubts)
    check = ArtefactCheck(artefact, length.value, length.u, day, characteristic, doubts=doubts)
    celsius = recording_set.rig.air.scanned if celsius is None else celsius
    ids = (calibration.id, frames_id(recording_set, work.record()))
    outside = history_of(recording_set.rig, calibration.id).beyond(PastCheck.of_measured(check, when, ids, celsius))
    check = replace(check, outside=outside)
    store_check(history_name(recording_set.rig, calibration.id), PastCheck.of_measured(check, when, ids, celsius))
    return check


def lengths_of(file: InspectionFile, kind: ArtefactKind) -> tuple[Characteristic, ...]:
    """List the characteristics in inspection.json that an artefact's certificate of this `kind` can state."""
    feature, result = _MEASURED_AS[kind]
    return tuple(
        row for row in file.characteristics if row.kind == result and file.kinds.get(file.features[row.name]) == feature
    )


def frames_id(recording_set: RecordingSet, record: RunRecord) -> str:
    """Compute an id of 12 hex digits from the hashes that the frames had when they were measured."""
    text = "\n".join(record.inputs.get(recording_set.name_of(path), "") for path in recording_set.frames)
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def _chosen(lengths: tuple[Characteristic, ...], artefact: Artefact, name: str, path: Path) -> Characteristic:
    """The length that is compared: the one of this name, or the only one."""
    length, known = KINDS[artefact.kind], tuple(row.name for row in lengths)
    if not lengths:
        raise InputError(
            Message("artefact.not_measured", "nothing was measured that {id} could be ({length})", id=artefact.id,
                    length=length),
            where=path,
            todo=AGAIN,
        )  # fmt: skip
    if not name and len(lengths) > 1:
        raise InputError(
            Message("artefact.which", "several lengths may be that of {id}: {known}", id=artefact.id, known=known),
            where=path,
            todo=Message("artefact.advice_name_it", "name one with --characteristic"),
        )
    if name and name not in known:
        raise InputError(
            Message(
                "artefact.no_such_length",
                "there is no {name} that could be {id} ({length}), only {known}",
                name=name,
                id=artefact.id,
                length=length,
                known=known,
            ),
            where=path,
            todo=Message("artefact.advice_name_one", "name one of these"),
        )
    one = lengths[known.index(name) if name else 0]
    if one.by_master:
        raise InputError(
            Message("artefact.by_master", "{name} was corrected by a master, so that it checks nothing", name=one.name),
            where=path,
            todo=Message("artefact.advice_without_master", "measure the plan without the master"),
        )
    return one
