"""Live poses of the plane target: the fan on it, taken with the fan on and off when the target is still and sharp.

An interim check takes the same pictures, but ends by itself when it has enough of them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from core.acquire.source import Ended, Frame, Lasers
from core.calibrate.camera.capture import HOLD_STILL, TAKEN, CaptureJudge, moved_px
from core.calibrate.camera.missing import PLANE_POSES
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.image.targets.target_view import TargetView
from core.messages import Message, label
from core.model.arrays import Array
from core.pipeline.live.camera import named, nothing_taken
from core.pipeline.live.commands import Auto, Capture, Command, Configure, Discard
from core.pipeline.live.context import LiveContext, as_sentence
from core.pipeline.live.events import PlanesDetail
from core.pipeline.live.exposure import ExposureAdviser
from core.pipeline.live.pose import FoundPose, find_pose, is_lit, measure_pair, settings_of

_STILL_LIT_S = 3.0
"""For so long pictures that still show the fan are passed over after it was switched off: they were exposed before."""

_SOON_S = 0.5
"""Pictures of a pose that are no further apart are as close as the camera could take them."""

CHECK_POSES = 3
"""So many poses of an interim check are enough; one will do."""

_ANOTHER_POSE_PX = 10.0
"""A target that has moved so far since it was refused may be tried again."""

_NO_LIGHT = Message("live.no_fan_light", "The fan's light is not seen on the target.")

_FAN_ON, _FAN_OFF = Lasers(fan=True, hand=False), Lasers(fan=False, hand=False)

Stage = Literal["looking", "first picture", "asking", "second picture", "measuring"]


@dataclass(frozen=True, eq=False, slots=True)
class _Pending:
    """A pose being taken: its picture with the fan on, what was seen when it was chosen, and since when it is off."""

    on: Frame
    seen: PoseFeatures
    view: TargetView
    off: Frame | None = None
    off_since_s: float | None = None


class LivePlanes:
    """Step of a live recording in which poses of the plane target are taken, to calibrate or check the fan."""

    def __init__(self, context: LiveContext) -> None:
        self._context, request = context, context.request
        self._target, self._camera, self._lines = request.rig.plane_target, request.camera, request.rig.lines
        self._checks, self._auto, self._capture = request.step == "check", request.auto, False
        self._settings = request.options.plane_stripe
        self._judge: CaptureJudge | None = None
        self._look: FoundPose | None = None
        self._stage: Stage = "looking"
        self._switches = False
        self._pending: _Pending | None = None
        self._refused: tuple[TargetView, Message] | None = None
        self._seen_at: Array | None = None
        self._sentence: Message | None = None
        self._missing: tuple[Message, ...] = ()
        self._wanted: Array | None = None
        self._number = 0
        self._adviser = ExposureAdviser()

    @property
    def show_with_findings(self) -> bool:
        """Whether the target is seen; then the frame is shown with corners and stripes found in it."""
        return self._look is not None and self._look.pose.view is not None

    def begin(self) -> None:
        """Switch the fan on, and drop a pose left unfinished when the source was unplugged."""
        self._context.answered()
        self._pending, self._stage = None, "looking"
        self._switches = self._context.switch(_FAN_ON)
        if not self._switches:
            self._context.notice(
                Message("live.fan_on_hand_off", "Switch the three-line laser on, and the hand-held laser off.")
            )

    def frame(self, frame: Frame) -> None:
        """Start to look for a pose in a frame, or use the frame as the picture with the fan on or off that is due."""
        if self._judge is None:
            height, width = frame.picture.shape
            self._judge = CaptureJudge((width, height), self._camera, series=PLANE_POSES)
            self._judge.add_earlier(self._context.request.there)
            self._missing, self._wanted = self._judge.missing(), self._judge.next_outline()
        if self._stage == "looking":
            known = self._target, self._camera, self._settings, self._lines
            self._context.worker.start(find_pose, frame, *known, self._seen_at)
        elif self._stage == "first picture" and self._pending is not None:
            self._context.switch(_FAN_OFF)
            self._pending, self._stage = replace(self._pending, on=frame, off_since_s=frame.time_s), "second picture"
        elif self._stage == "second picture" and self._pending is not None:
            self._second_picture(self._pending, frame)

    def poll(self) -> Frame | None:
        """Judge the pose found last and take it if it is good; return its frame, None if no search has ended."""
        result = self._context.worker.take()
        if isinstance(result, PoseFeatures) and self._pending is not None and self._judge is not None:
            self._finish_pair(self._pending, result, self._judge)
        elif isinstance(result, FoundPose) and self._stage == "looking" and self._judge is not None:
            self._judged(result, self._judge)
            return result.frame
        return None

    def detail(self, shown: Frame) -> PlanesDetail | None:
        """Return what was found in the last frame searched, with corners and stripes only if that is `shown`.

        None before any.
        """
        look = self._look
        if look is None or self._judge is None:
            return None
        own = look.frame is shown
        return PlanesDetail(
            index=look.frame.index,
            uv=look.pose.view.uv if look.pose.view is not None and own else None,
            stripes=look.stripes if own else (),
            line=look.line if own else (),
            sentence=self._sentence,
            cells=self._judge.cells,
            missing=self._missing,
            poses=len(self._judge.views),
            auto=self._auto,
            wanted=self._wanted,
        )

    def rest(self) -> None:
        """Do nothing: no work is put off in this step until a picture has been shown."""

    def handle(self, command: Command) -> None:
        """Follow the commands Capture, Auto and Discard, and forget exposures on Configure; ignore all others."""
        match command:
            case Configure():
                self._adviser.forget()
            case Capture() if self._stage == "asking":
                self._context.answered()
                self._stage = "second picture"
            case Capture():
                self._capture = True
            case Auto(on):
                self._auto = on
            case Discard(name) if self._judge is not None and self._context.put_aside(name, f"{name}_off"):
                self._judge.forget(name)
                self._missing, self._wanted = self._judge.missing(), self._judge.next_outline()
                self._context.recorded -= 1

    def finish(self) -> None:
        """Do nothing: all poses taken are on the disk already."""

    def _judged(self, look: FoundPose, judge: CaptureJudge) -> None:
        view, pose = look.pose.view, look.pose
        self._advise(look)
        why_not = None if pose.reason is None else as_sentence(pose.reason)
        verdict = judge.judge(view, look.blur_px, look.frame.time_s, why_not)
        self._look, self._sentence = look, verdict.sentence
        self._seen_at = None if view is None else view.uv
        if pose.centrelines and self._settings is None:
            self._settings = settings_of(pose)
        doubt = None if view is None or not verdict.take else self._doubt(look, view)
        self._sentence = doubt or self._sentence
        if view is not None and pose.centrelines and (self._capture or (verdict.take and self._auto and not doubt)):
            self._begin_pair(look, view)
        elif self._capture:
            self._context.notice(nothing_taken(_NO_LIGHT if view is not None else self._sentence), refused=True)
        elif doubt or verdict.of_no_use:
            self._context.release_scene(look.frame)
        elif verdict.take:
            self._sentence = Message("live.press_capture_pose", "Press Take picture to take this pose.")
        self._capture = False

    def _advise(self, look: FoundPose) -> None:
        """Say how the fan's stripes would be exposed better, when that is news."""
        context, full_scale = self._context, float(np.iinfo(look.frame.picture.dtype).max)
        advice = self._adviser.watch(look.pose.centrelines, full_scale, context.settings, context.capabilities)
        if advice is not None:
            context.emit(advice)

    def _doubt(self, look: FoundPose, view: TargetView) -> Message | None:
        """Why a good view of the target is not taken by itself; None if it is."""
        if not look.pose.centrelines:
            return _NO_LIGHT
        if self._camera is not None and len(look.stripes) > self._lines:
            return Message(
                "live.more_stripes_than_lines",
                "More stripes are seen than the fan's {n}: is it on? Press Take picture to take the pose.",
                n=self._lines,
            )
        if self._refused is not None and moved_px(self._refused[0], view) < _ANOTHER_POSE_PX:
            return self._refused[1]
        return None

    def _begin_pair(self, look: FoundPose, view: TargetView) -> None:
        """The pose is chosen; now its pictures."""
        self._pending = _Pending(look.frame, look.pose, view)
        self._sentence = HOLD_STILL
        if not self._context.request.pairs or (self._checks and not self._switches):  # nobody switches it for a check
            self._measure(self._pending)
            return
        if self._switches:  # the one looked at is old by now: another one, and that with the fan off right after it
            self._stage = "first picture"
            return
        self._context.switch(_FAN_OFF)
        self._stage = "asking"
        leave = Message(
            "live.leave_target_fan_off",
            "Leave the target as it is, switch the three-line laser off, then press Continue.",
        )
        self._context.ask(leave, label("Continue"), Capture())

    def _second_picture(self, pending: _Pending, frame: Frame) -> None:
        """Take the first picture that was exposed with the fan off."""
        since_s = frame.time_s if pending.off_since_s is None else pending.off_since_s
        self._pending = replace(pending, off=frame, off_since_s=since_s)
        stripes = pending.seen.centrelines
        if frame.time_s - since_s < _STILL_LIT_S and is_lit(frame.picture, pending.on.picture, stripes):
            return
        self._measure(self._pending)

    def _measure(self, pending: _Pending) -> None:
        name, on, off = self._name(), pending.on.picture, None if pending.off is None else pending.off.picture
        margin_mm = self._context.request.rig.plane_margin_mm
        self._stage = "measuring"
        self._context.worker.start(measure_pair, name, on, off, self._target, self._camera, self._settings, margin_mm)

    def _finish_pair(self, pending: _Pending, features: PoseFeatures, judge: CaptureJudge) -> None:
        """Keep the pose, or say why it is of no use."""
        name, off = self._name(), pending.off
        if features.reason:
            why = self._why_not(features, features.reason, pending)
            self._refused = (pending.view, why)
            self._context.notice(why, refused=True)
        else:
            self._context.write(name, pending.on.picture, pending.on)
            if off is not None:
                self._context.write(f"{name}_off", off.picture, off)
            self._number += 1
            self._context.recorded += 1
            judge.record_taken(named(pending.view, name), pending.on.time_s)
            self._sentence, self._missing, self._wanted = TAKEN, judge.missing(), judge.next_outline()
            self._context.took(name, pending.on.picture)
            if self._checks and self._context.recorded >= CHECK_POSES:
                raise Ended
        self._context.release_scene(pending.on)
        self._pending, self._stage = None, "looking"
        if off is not None and not self._context.switch(_FAN_ON):
            self._context.notice(
                Message(
                    "live.fan_on_another_pose",
                    "Switch the three-line laser on again, and hold the target another way.",
                )
            )

    def _why_not(self, features: PoseFeatures, reason: Message, pending: _Pending) -> Message:
        """The sentence for a pose that was refused: whether the target was moved, or its pictures came late."""
        off = pending.off
        if off is None or not features.target_moved:
            return Message("live.pose_not_taken", "The pose was not taken: {reason}.", reason=reason)
        apart = {"shift_px": features.moved_px, "apart_s": off.time_s - pending.on.time_s}
        if not self._switches:
            return Message(
                "live.pose_moved_by_hand",
                "The pose was not taken: the target moved by {shift_px:.1f} px while the laser was switched off. Let "
                "it lean or stand on something.",
                **apart,
            )
        if apart["apart_s"] <= _SOON_S:
            return Message(
                "live.pose_moved",
                "The pose was not taken: the target moved by {shift_px:.1f} px within {apart_s:.1f} s; hold it still "
                "until it is taken.",
                **apart,
            )
        return Message(
            "live.pose_late",
            "The pose was not taken: its two pictures are {apart_s:.1f} s apart, too late for a hand (the target moved "
            "by {shift_px:.1f} px). Let the target lean on something, or give the computer less to do.",
            **apart,
        )

    def _name(self) -> str:
        return f"pose{self._number:02d}"
