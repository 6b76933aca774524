"""How far the calibration of the camera is, and in sentences what is missing for the next thing to do."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING

from PySide6.QtCore import QCoreApplication

from workbench.step_state import State

if TYPE_CHECKING:
    from workbench.pages.camera_presenter import CameraPresenter


class Stage(StrEnum):
    """How far the camera's calibration is."""

    NONE = "none"
    EMPTY = "empty"
    FOUND = "found"
    LIVE = "live"
    SEARCHING = "searching"
    SOLVING = "solving"
    FAILED = "failed"
    SOLVED = "solved"
    REJECTED = "rejected"
    ACCEPTED = "accepted"
    OUTDATED = "outdated"
    OTHER = "other"


def stage_of(p: CameraPresenter) -> Stage:
    """How far it is."""
    work, accepted = p.work, p.project.accepted.camera
    if p.live.running:
        return Stage.LIVE
    if work.searching:
        return Stage.SEARCHING
    if work.seen is not None and work.solving:
        return Stage.SOLVING
    if accepted and p.candidate in ("", accepted):
        if p.candidate == accepted or p.state.state is State.DONE:
            return Stage.ACCEPTED
        return Stage.OUTDATED
    if p.candidate:
        if accepted and p.state.state is State.DONE:
            return Stage.OTHER
        return Stage.REJECTED if p.acceptance.is_rejected(p.candidate) else Stage.SOLVED
    if work.problem:
        return Stage.FAILED
    if not p.project.sources.camera:
        return Stage.NONE
    return Stage.EMPTY if work.pictures == () else Stage.FOUND


def missing(p: CameraPresenter) -> str:
    """What is missing before the next step makes sense, or ""."""
    return {
        Stage.NONE: _tr("Record or choose pictures of the camera's target first."),
        Stage.EMPTY: _tr("Choose a folder that holds pictures of the camera's target."),
        Stage.FOUND: _tr("Calibrate the camera from its pictures first."),
        Stage.LIVE: _tr("Stop the live source when there are enough views."),
        Stage.SEARCHING: _tr("The pictures are being searched for the target."),
        Stage.SOLVING: _tr("The camera is being solved."),
        Stage.FAILED: _tr("The camera could not be calibrated; record more views or check the target."),
        Stage.SOLVED: _tr("Accept a camera calibration first."),
        Stage.REJECTED: _tr("The calibration was rejected; accept a better one first."),
        Stage.ACCEPTED: "",
        Stage.OTHER: "",
        Stage.OUTDATED: _tr("The accepted camera calibration is out of date; calibrate again."),
    }[stage_of(p)]


def why_not_search(p: CameraPresenter) -> str:
    """Why the target cannot be looked for now, or ""."""
    if not p.project.sources.camera:
        return _tr("Choose or record pictures first.")
    if p.live.running:
        return _tr("Stop the live source first.")
    if p.work.searching:
        return _tr("The pictures are being searched.")
    return ""


def why_not_accept(p: CameraPresenter) -> str:
    """Why nothing can be accepted now, or ""."""
    if p.work.calibration is None or p.work.solving or p.acceptance.keeping:
        return _tr("There is no calibration yet.")
    if p.candidate == p.project.accepted.camera:
        return _tr("This calibration is accepted already.")
    return ""


def why_not_reject(p: CameraPresenter) -> str:
    """Why nothing can be rejected now, or ""."""
    if not p.candidate or p.work.solving:
        return _tr("There is no calibration yet.")
    if p.acceptance.is_rejected(p.candidate) and p.candidate != p.project.accepted.camera:
        return _tr("This calibration is rejected already.")
    return ""


def _tr(text: str) -> str:
    return QCoreApplication.translate("CameraStage", text)
