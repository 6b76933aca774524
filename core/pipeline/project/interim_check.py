"""The checks of a project's rig: by pictures of the day, and by known artefacts."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from core.calibrate.results import ProposedReadjustment
from core.checks.artefact_check import KINDS, Artefact, ArtefactCheck, ArtefactKind
from core.errors import InputError
from core.files.atomic import make_folder
from core.files.folder_lock import alone_in
from core.files.project.calibration_store import (
    FOLDER,
    READJUSTED_FROM,
    put_in_place,
    read_stored,
    read_stored_camera,
    read_stored_planes,
    read_stored_poses,
    store_planes,
)
from core.files.project.data import Project
from core.files.project.folder import results_folder, source_folder
from core.files.recording.picture_reader import PictureReader
from core.files.recording.set_listing import scan_frames, taken_at
from core.files.results.check_file import InterimCheck, read_check
from core.files.results.inspection_file import read_inspection
from core.files.results.rig_history import CheckChart, RigHistory
from core.files.step_graph import FILES
from core.messages import Message
from core.pipeline.project.workspace import part_name, project_set, project_workspace
from core.pipeline.steps.artefact_step import artefact_step, lengths_of
from core.pipeline.steps.check_step import check_step
from core.pipeline.steps.readjust_step import propose_readjustment
from core.pipeline.steps.validity import history_of
from core.pipeline.steps.workspace import Calibration, Workspace, staged
from core.progress import Progress, silent

CHECK = "check"
"""The folder in the project that its result goes to: a scan among the results stays as it is."""


def check_rig(folder: Path, project: Project, progress: Progress = silent) -> InterimCheck:
    """Check the accepted calibrations by the project's pictures of an interim check, and write the result.

    The new result takes the place of the old one when all is done; until then, and if it is cancelled, that stays.

    Raises
    ------
    InputError
        If no calibration is accepted, or as `core.pipeline.steps.check_step.check_step`.
    """
    out = make_folder(folder / CHECK)
    with alone_in(out), staged(out, "check", FILES) as beside:
        put_in_place(folder, project.accepted, beside)
        work = Workspace.open(project_set(folder, project), beside, part_name(project), folder / FOLDER)
        air = project.info.air_celsius if project.rig.air.checked is None else None
        return check_step(work, project.options.plane_stripe, progress, air)


def show_check(folder: Path) -> InterimCheck | None:
    """Read the result of the project's last interim check; None if there is none, InputError if it is damaged."""
    path = folder / CHECK / FILES["check"]
    return read_check(path) if path.exists() else None


def check_history(folder: Path, project: Project) -> RigHistory:
    """Read all interim checks of the project's rig known on this computer; InputError if their file is damaged."""
    return history_of(project.rig, _accepted(folder, project).id)


def compare_with_artefact(
    folder: Path, project: Project, artefact: Artefact, characteristic: str = ""
) -> ArtefactCheck:
    """Compare a length measured in the project with the certificate of the artefact that was measured.

    Raises
    ------
    InputError
        As `core.pipeline.steps.artefact_step.artefact_step`.
    """
    return artefact_step(project_workspace(folder, project), artefact, project.info.air_celsius, characteristic)


def comparable_lengths(folder: Path) -> Mapping[ArtefactKind, tuple[str, ...]]:
    """List by name, for each kind of artefact, the lengths measured in the project that its certificate may state.

    Of a block "" is the thickness of the part as a whole, measured or not. InputError if inspection.json is damaged.
    """
    path = results_folder(folder) / FILES["inspection"]
    file = read_inspection(path) if path.exists() else None
    names = {kind: tuple(row.name for row in lengths_of(file, kind)) if file else () for kind in KINDS}
    return {**names, "block": ("", *names["block"])}


def artefact_checks(folder: Path, project: Project) -> tuple[ArtefactCheck, ...]:
    """Read, for each artefact measured with the accepted calibrations, its check nearest in time to the scan.

    Raises
    ------
    InputError
        If no calibration is accepted, or the history is damaged.
    """
    _, frames = scan_frames(source_folder(folder, project.sources.scan))
    calibration = _accepted(folder, project)
    return history_of(project.rig, calibration.id).artefacts(calibration.id, taken_at(frames))


def artefact_charts(folder: Path, project: Project) -> tuple[CheckChart, ...]:
    """Make the control charts of each artefact measured with the accepted calibrations, with their limits.

    Raises
    ------
    InputError
        As `artefact_checks`.
    """
    calibration = _accepted(folder, project)
    return history_of(project.rig, calibration.id).artefact_charts(calibration.id)


def propose_project_readjustment(folder: Path, project: Project, progress: Progress = silent) -> ProposedReadjustment:
    """Compute how the project's interim check would re-adjust the accepted camera and fan; nothing is stored.

    Raises
    ------
    InputError
        As `core.pipeline.steps.readjust_step.propose_readjustment`, or if no calibration is accepted.
    """
    pictures = PictureReader(project_set(folder, project))
    return propose_readjustment(pictures, _accepted(folder, project), project.options.plane_stripe, progress)


def accept_readjustment(
    folder: Path, project: Project, proposed: ProposedReadjustment, progress: Progress = silent
) -> str:
    """Store a re-adjusted fan and the camera that belongs to it; return its id, for the caller to accept.

    Raises
    ------
    InputError
        If another calibration has been accepted since, or nothing can be written.
    """
    progress("keeping the calibration", 0, 1)
    if proposed.record.of != _accepted(folder, project).id:
        raise InputError(
            Message("readjust.of_other_calibration", "another calibration has been accepted since"),
            todo=Message("advice.check_and_readjust", "check again"),
        )
    camera = read_stored_camera(folder, project.accepted.camera)
    before = read_stored(folder, "planes", project.accepted.planes)
    return store_planes(
        folder,
        proposed.fan,
        camera.camera,
        read_stored_poses(folder, project.accepted.planes),
        {**({} if before is None else before.settings), READJUSTED_FROM: project.accepted.planes},
        {**({} if before is None else before.inputs), **proposed.record.hashes},
    )


def _accepted(folder: Path, project: Project) -> Calibration:
    camera = read_stored_camera(folder, project.accepted.camera)
    fan = read_stored_planes(folder, project.accepted.planes, camera.camera)
    return Calibration(fan.camera_used(camera), fan)
