"""Live views of the camera's target: found in the picture, judged, and taken when they add something."""

from __future__ import annotations

from dataclasses import dataclass

from core.acquire.source import Frame, Lasers
from core.calibrate.camera.capture import TAKEN, CaptureJudge
from core.errors import InputError
from core.image.sharpness import edge_blur_px
from core.image.targets import Target, detect
from core.image.targets.target_view import OtherBoard, TargetView
from core.messages import Message
from core.model import Camera
from core.model.arrays import Array
from core.pipeline.live.commands import Auto, Capture, Command, Discard, LookFor
from core.pipeline.live.context import LiveContext, as_sentence
from core.pipeline.live.events import CameraDetail


@dataclass(frozen=True, eq=False, slots=True)
class FoundView:
    """Result of looking for the camera target in one frame: the view and its edge blur, or the reason for none.

    `counted` are the columns and rows of a board of another size that is seen instead.
    """

    frame: Frame
    view: TargetView | None
    blur_px: float = float("nan")
    why_not: Message | None = None
    counted: tuple[int, int] | None = None


def find_view(frame: Frame, target: Target, camera: Camera | None) -> FoundView:
    """Find the corners of `target` in a frame and the blur of its edges, or the reason why it is not seen."""
    try:
        view = detect(target, frame.picture, "", camera, thorough=False)
    except InputError as error:
        counted = error.counted if isinstance(error, OtherBoard) else None
        return FoundView(frame, None, why_not=as_sentence(error.what), counted=counted)
    return FoundView(frame, view, edge_blur_px(frame.picture, view.uv))


class LiveCamera:
    """Step of a live recording in which views of the camera target are taken, to calibrate the camera."""

    def __init__(self, context: LiveContext) -> None:
        self._context, self._target = context, context.request.rig.camera_target
        self._auto, self._capture = context.request.auto, False
        self._judge: CaptureJudge | None = None
        self._look: FoundView | None = None
        self._sentence: Message | None = None
        self._missing: tuple[Message, ...] = ()
        self._wanted: Array | None = None
        self._number = 0

    @property
    def show_with_findings(self) -> bool:
        """Whether the target is seen; then the frame is shown with the corners that were found in it."""
        return self._look is not None and self._look.view is not None

    def begin(self) -> None:
        """Switch the lasers off, as views of the target are taken without their light."""
        self._context.switch(Lasers(fan=False, hand=False))

    def frame(self, frame: Frame) -> None:
        """Start to look for the target in a frame, unless an earlier frame is still being looked at."""
        if self._judge is None:
            height, width = frame.picture.shape
            self._judge = CaptureJudge((width, height), self._context.request.camera)
            self._judge.add_earlier(self._context.request.there)
            self._missing, self._wanted = self._judge.missing(), self._judge.next_outline()
        self._context.worker.start(find_view, frame, self._target, self._context.request.camera)

    def poll(self) -> Frame | None:
        """Judge the view found last and take it if it is good; return its frame, None if no search has ended."""
        look = self._context.worker.take()
        if not isinstance(look, FoundView) or self._judge is None:
            return None
        verdict = self._judge.judge(look.view, look.blur_px, look.frame.time_s, look.why_not)
        self._look, self._sentence = look, verdict.sentence
        if look.view is not None and (self._capture or (verdict.take and self._auto)):
            self._take(look.frame, look.view, self._judge)
        elif self._capture:
            why = verdict.sentence if look.why_not is None else look.why_not
            self._context.notice(nothing_taken(why), refused=True)
        elif verdict.of_no_use:
            self._context.release_scene(look.frame)
        elif verdict.take:
            self._sentence = Message("live.press_capture_view", "Press Take picture to take this view.")
        self._capture = False
        return look.frame

    def detail(self, shown: Frame) -> CameraDetail | None:
        """Return what was found in the last frame searched, with corners only if that is `shown`; None before any."""
        if self._look is None or self._judge is None:
            return None
        view = self._look.view
        return CameraDetail(
            index=self._look.frame.index,
            uv=view.uv if view is not None and self._look.frame is shown else None,
            sentence=self._sentence,
            cells=self._judge.cells,
            missing=self._missing,
            views=len(self._judge.views),
            auto=self._auto,
            wanted=self._wanted,
            counted=self._look.counted,
        )

    def rest(self) -> None:
        """Do nothing: no work is put off in this step until a picture has been shown."""

    def handle(self, command: Command) -> None:
        """Follow the commands Capture, Auto, Discard and LookFor; ignore all others."""
        match command:
            case Capture():
                self._capture = True
            case Auto(on):
                self._auto = on
            case LookFor(target):
                self._target = target
            case Discard(name) if self._judge is not None and self._context.put_aside(name):
                self._judge.forget(name)
                self._missing, self._wanted = self._judge.missing(), self._judge.next_outline()
                self._context.recorded -= 1

    def finish(self) -> None:
        """Do nothing: all views taken are on the disk already."""

    def _take(self, frame: Frame, view: TargetView, judge: CaptureJudge) -> None:
        name = f"view{self._number:02d}"
        self._number += 1
        self._context.write(name, frame.picture, frame)
        self._context.recorded += 1
        judge.record_taken(named(view, name), frame.time_s)
        self._sentence, self._missing, self._wanted = TAKEN, judge.missing(), judge.next_outline()
        self._context.took(name, frame.picture)
        self._context.release_scene(frame)


def nothing_taken(why: Message) -> Message:
    """Make the notice that Capture was pressed and no view or pose was taken, because of `why`."""
    return Message("live.nothing_taken", "Nothing was taken. {why}", why=why)


def named(view: TargetView, name: str) -> TargetView:
    """Copy a view of the camera target under another name."""
    return TargetView(view.points, view.uv, view.sigma, name)
