"""How far the calibration of the laser planes is, and in sentences what is missing for the next thing to do."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING

from PySide6.QtCore import QCoreApplication

from workbench.step_state import State

if TYPE_CHECKING:
    from workbench.pages.planes_presenter import PlanesPresenter


class Stage(StrEnum):
    """How far the calibration of the laser planes is."""

    NO_CAMERA = "no camera"
    NONE = "none"
    EMPTY = "empty"
    FOUND = "found"
    LIVE = "live"
    MEASURING = "measuring"
    SOLVING = "solving"
    FAILED = "failed"
    SOLVED = "solved"
    REJECTED = "rejected"
    ACCEPTED = "accepted"
    OTHER = "other"
    OUTDATED = "outdated"


def stage_of(p: PlanesPresenter) -> Stage:
    """How far it is."""
    work, accepted = p.work, p.project.accepted.fan
    if p.live.running:
        return Stage.LIVE
    if work.searching:
        return Stage.MEASURING
    if work.poses is not None and work.solving:
        return Stage.SOLVING
    done = p.state.state is State.DONE
    if accepted and p.candidate in ("", accepted):
        return Stage.ACCEPTED if done else Stage.OUTDATED
    if p.candidate:
        if accepted and done:
            return Stage.OTHER
        return Stage.REJECTED if p.acceptance.is_rejected(p.candidate) else Stage.SOLVED
    if not p.project.accepted.camera:
        return Stage.NO_CAMERA
    if work.problem:
        return Stage.FAILED
    if not p.project.sources.planes:
        return Stage.NONE
    return Stage.EMPTY if work.pictures == () else Stage.FOUND


def missing(p: PlanesPresenter) -> str:
    """What is missing before the next step makes sense, or ""."""
    outdated = _tr("The accepted laser planes are out of date; calibrate again.")
    return {
        Stage.NO_CAMERA: _tr("Accept a camera calibration first."),
        Stage.NONE: _tr("Record or choose pictures of the plate under the laser first."),
        Stage.EMPTY: _tr("Choose a folder that holds pictures of the plate under the laser."),
        Stage.FOUND: _tr("Calibrate the laser planes from their pictures first."),
        Stage.LIVE: _tr("Stop the live source when there are enough poses."),
        Stage.MEASURING: _tr("The pictures are being measured."),
        Stage.SOLVING: _tr("The laser planes are being solved."),
        Stage.FAILED: _tr("The laser planes could not be calibrated; record more poses or check the plate."),
        Stage.SOLVED: _tr("Accept the laser planes first."),
        Stage.REJECTED: _tr("The laser planes were rejected; accept better ones first."),
        Stage.ACCEPTED: "",
        Stage.OTHER: "",
        Stage.OUTDATED: p.state.sentence if p.candidate else outdated,
    }[stage_of(p)]


def why_not_measure(p: PlanesPresenter) -> str:
    """Why the pictures cannot be measured now, or ""."""
    if p.live.running:
        return _tr("Stop the live source first.")
    if not p.project.accepted.camera:
        return _tr("Accept a camera calibration first.")
    if not p.project.sources.planes:
        return _tr("Choose or record pictures first.")
    return _tr("The pictures are being measured.") if p.work.searching else ""


def why_not_accept(p: PlanesPresenter) -> str:
    """Why nothing can be accepted now, or ""."""
    if p.live.running:
        return _tr("Stop the live source first.")
    if p.work.calibration is None or p.work.solving or p.acceptance.keeping:
        return _tr("There is no calibration yet.")
    if p.candidate == p.project.accepted.fan and p.state.state is State.DONE:
        return _tr("These laser planes are accepted already.")
    return ""


def why_not_reject(p: PlanesPresenter) -> str:
    """Why nothing can be rejected now, or ""."""
    if p.live.running:
        return _tr("Stop the live source first.")
    if not p.candidate or p.work.solving:
        return _tr("There is no calibration yet.")
    if p.acceptance.is_rejected(p.candidate) and p.candidate != p.project.accepted.fan:
        return _tr("This calibration is rejected already.")
    return ""


def _tr(text: str) -> str:
    return QCoreApplication.translate("PlanesStage", text)
