"""What a live scan says of itself beside its points: the checks before it, and how its stripes are exposed."""

from __future__ import annotations

import time
from collections.abc import Sequence
from datetime import datetime

from core.calibrate.sitting import Acquisition, hours_of_sitting
from core.errors import InputError
from core.files.project.calibration_store import READJUSTED_FROM, read_stored, read_stored_planes, read_stored_poses
from core.image.stripes.centreline import Centreline
from core.messages import Message
from core.pipeline.live.boards import LiveBoards
from core.pipeline.live.commands import LiveRequest
from core.pipeline.live.context import LiveContext
from core.pipeline.live.events import LiveChecks
from core.pipeline.live.exposure import ExposureAdviser
from core.pipeline.live.preview import ScanPreviewer
from core.pipeline.live.rig_check import rig_check
from core.scan.changed_section import ChangedSection, Section, changed_section
from core.scan.preview.preflight import FRESH_DAYS, Check, Preflight, stripe_width

CHECK_EVERY_S = 1.0
"""How often it is looked whether the reference still holds, while nothing is recorded."""


class ScanChecks:
    """Checks of a live scan and advice on exposure, sent to the window whenever their results change."""

    def __init__(self, context: LiveContext, previewer: ScanPreviewer, boards: LiveBoards) -> None:
        self._context, self._previewer, self._boards = context, previewer, boards
        self._image_size = (0, 0)
        self._poses = calibrated_poses(context.request)
        self._planes_taken = planes_acquisition(context.request)
        self._stripe_px = stripe_width(piece for pose in self._poses for piece in pose)
        self._section: ChangedSection | Section = Section.SAME
        self._adviser = ExposureAdviser()
        self._told: tuple[Check, ...] = ()
        self._looked_s = 0.0

    @property
    def are_due(self) -> bool:
        """Whether it is time to compare a picture with the reference again."""
        return time.monotonic() - self._looked_s >= CHECK_EVERY_S

    def begin(self, image_size: tuple[int, int]) -> None:
        """Make the first checks, when the first picture, of `image_size` (width, height), has come."""
        self._image_size = image_size
        self._tell(None, None)

    def accepted(self) -> None:
        """Compare the section of a new reference's stripes with the calibration's, and make the checks anew."""
        request = self._context.request
        camera, fan = request.camera, request.fan
        if camera is not None and fan is not None and fan.lines and not _is_readjusted(request):
            stripes = [piece for pieces in self._previewer.fan_lines for piece in pieces]
            self._section = changed_section(self._poses, stripes, camera, fan)
        self.reference()

    def reference(self, departed: Message | None = None) -> None:
        """Make the checks anew, given why the latest picture has `departed` from the reference; None: it agrees."""
        self._looked_s = time.monotonic()
        self._tell(self._previewer.fan_lines, departed)

    def stripes(self, stripes: Sequence[Centreline]) -> None:
        """Advise on the exposure, by the hand-held laser's stripes in one more picture, if the advice has changed."""
        context = self._context
        advice = self._adviser.watch(stripes, self._previewer.full_scale, context.settings, context.capabilities)
        if advice is not None:
            context.emit(advice)

    def configured(self) -> None:
        """Forget the exposures seen so far, as the settings of the source have changed."""
        self._adviser.forget()

    def _tell(self, fan_lines: tuple[tuple[Centreline, ...], ...] | None, departed: Message | None) -> None:
        request = self._context.request
        checks = Preflight(
            lines=request.rig.lines,
            image_size=self._image_size,
            fan_lines=fan_lines,
            full_scale=self._previewer.full_scale,
            departed=departed,
            camera=request.camera,
            fan=request.fan,
            age_s=None if request.calibrated_s is None else max(0.0, time.time() - request.calibrated_s),
            stripe_px=self._stripe_px,
            fresh_days=request.rig.validity.calibration_days or FRESH_DAYS,
            section=self._section,
            boards=self._boards.wanted,
            boards_missing=self._boards.missing,
        ).checks()
        if not request.rig.has_fan:
            self._emit(checks)
            return
        now = datetime.now().astimezone()
        here = Acquisition(self._context.camera, now, now)
        hours = hours_of_sitting(self._planes_taken, here, request.rig.validity.fresh_hours)
        self._emit((*checks, rig_check(request.check, now, hours)))

    def _emit(self, checks: tuple[Check, ...]) -> None:
        if checks != self._told:
            self._told = checks
            self._context.emit(LiveChecks(checks))


def planes_acquisition(request: LiveRequest) -> Acquisition | None:
    """Read by which camera, and when, the fan's calibration was recorded; None if that is not known."""
    if request.kept_planes is None or request.camera is None:
        return None
    try:
        return read_stored_planes(*request.kept_planes, request.camera).taken
    except InputError:
        return None


def calibrated_poses(request: LiveRequest) -> tuple[tuple[Centreline, ...], ...]:
    """Read the centrelines of the fan in each pose of its calibration; () if they are not stored any more."""
    if request.kept_planes is None:
        return ()
    try:
        return tuple(pose.centrelines for pose in read_stored_poses(*request.kept_planes))
    except InputError:
        return ()


def _is_readjusted(request: LiveRequest) -> bool:
    """Whether the fan rests on stripes seen since its poses, or that is not known: then these are not compared."""
    if request.kept_planes is None:
        return False
    folder, id_ = request.kept_planes
    try:
        kept = read_stored(folder, "planes", id_)
    except InputError:
        return True
    return kept is not None and READJUSTED_FROM in kept.settings
