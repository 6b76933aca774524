"""How far the scan is, and in sentences what is missing for the next thing to do."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING

from PySide6.QtCore import QCoreApplication

from workbench.step_state import State

if TYPE_CHECKING:
    from workbench.pages.scan_presenter import ScanPresenter


class Stage(StrEnum):
    """How far the scan is."""

    NONE = "none"
    LISTING = "listing"
    EMPTY = "empty"
    LIVE = "live"
    RECORDED = "recorded"
    MEASURING = "measuring"
    FAILED = "failed"
    MEASURED = "measured"
    OUTDATED = "outdated"


def stage_of(p: ScanPresenter) -> Stage:
    """How far it is."""
    work = p.work
    if p.live.running:
        return Stage.LIVE
    if p.run.measuring:
        return Stage.MEASURING
    if p.run.problem:
        return Stage.FAILED
    state = p.state.state
    if state is State.DONE:
        return Stage.MEASURED
    if state is State.OUTDATED:
        return Stage.OUTDATED
    if not p.project.sources.scan:
        return Stage.NONE
    if work.frames is None:
        return Stage.LISTING
    return Stage.RECORDED if work.frames else Stage.EMPTY


def missing(p: ScanPresenter) -> str:
    """What is missing before the next step makes sense, or ""."""
    stage = p.stage
    if stage is Stage.MEASURED:
        return ""
    if stage in (Stage.LIVE, Stage.MEASURING):
        return p.cannot_measure
    if stage is Stage.OUTDATED and not p.changed_since():
        return p.state.sentence
    if p.cannot_measure:
        return p.cannot_measure
    return {
        Stage.FAILED: _tr("The scan could not be measured; look at why, or record another one."),
        Stage.OUTDATED: _tr("The measured scan is out of date; measure it again."),
    }.get(stage, _tr("Measure the scan first."))


def why_not_measure(p: ScanPresenter) -> str:
    """Why the scan cannot be measured now, or ""."""
    accepted, work = p.project.accepted, p.work
    if p.live.running:
        return _tr("Stop the recording first.")
    if p.run.measuring:
        return _tr("The scan is being measured.")
    if not accepted.camera:
        return _tr("Accept a camera calibration first.")
    if not accepted.fan:
        return _tr("Accept the laser planes first.")
    if not p.project.sources.scan:
        return _tr("Record a scan, or choose a recording, first.")
    if work.frames is None:
        return _tr("The frames are being listed.")
    if not work.frames:
        return work.no_frames or _tr("Choose a folder that holds the frames of a scan.")
    if all(name in p.project.options.excluded for name in work.names):
        return _tr("All frames are left out; let some of them count again.")
    return ""


def why_not_record(p: ScanPresenter) -> str:
    """Why no recording can start now, or ""."""
    if p.run.measuring:
        return _tr("The scan is being measured; wait for it, or cancel it.")
    if not p.work.calibrations_read:
        return _tr("The calibrations are being read.")
    return ""


def _tr(text: str) -> str:
    return QCoreApplication.translate("ScanStage", text)
